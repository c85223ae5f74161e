"""HTML pages that need no other file: templates of this package, with embedded figures."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined


def render(template: str, **values: Any) -> str:
    """Render a template of this package that extends ``page.html.jinja``.

    Parameters
    ----------
    template
        Path of its file in the package.
    values
        Values of the names in the template; texts are escaped.

    Returns
    -------
    str
        The page.

    Raises
    ------
    jinja2.UndefinedError
        If the template has a name without a value.
    """
    environment = Environment(
        loader=PackageLoader("seat_cosim", "."), autoescape=True, trim_blocks=True, undefined=StrictUndefined
    )
    return environment.get_template(template).render(values)


def embedded(figure: Path) -> str:
    """Return an SVG file as a data URL, under which a page embeds it."""
    return "data:image/svg+xml;base64," + base64.b64encode(figure.read_bytes()).decode("ascii")
