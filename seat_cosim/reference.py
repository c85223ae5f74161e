"""Documentation pages that are generated from the code; ``python -m seat_cosim.reference`` writes them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from cosim.conformance import rule_docs
from fmus.export import variables_table
from seat_cosim.components import COMPONENTS

PAGES: dict[str, Callable[[], str]] = {
    "docs/variables.md": lambda: variables_table.page(COMPONENTS),
    "docs/validate.md": rule_docs.page,
}
"""Path in the repository to the function that returns the page."""


def main() -> None:
    """Write all pages; the working directory must be the repository's root."""
    for path, page in PAGES.items():
        Path(path).write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
