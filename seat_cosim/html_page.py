"""Pages for a browser that need nothing beside them: a template of the package, figures embedded."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined


def render(template: str, **values: Any) -> str:
    """Fill a template of this package, which extends ``page.html.jinja``; an unknown name in it is an error.

    Parameters
    ----------
    template
        Its file's name.
    values
        What it shows; texts are escaped.
    """
    environment = Environment(
        loader=PackageLoader("seat_cosim", "."), autoescape=True, trim_blocks=True, undefined=StrictUndefined
    )
    return environment.get_template(template).render(values)


def embedded(figure: Path) -> str:
    """Return an SVG file as an address that a page can show by itself."""
    return "data:image/svg+xml;base64," + base64.b64encode(figure.read_bytes()).decode("ascii")
