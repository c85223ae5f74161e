"""Documentation pages that are generated from the code; ``python -m seat_cosim.reference`` writes them."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import click

_COMMANDS_HEAD = """# Command line

Generated from the commands' help by `python -m seat_cosim.reference`. `seat-cosim COMMAND --help` prints the same.

An error is one line on standard error: what, where, expected, got. The exit code is 0, 2 for an error that is detected
before an FMU is instantiated, and 1 for a later failure.
"""

_WIDE = """---
hide: [toc]
---

"""
"""Head of a page of wide tables: the site shows no table of contents beside them."""

_EXAMPLES = re.compile(r"^(Examples?:)$", re.MULTILINE)
_ITEMS = re.compile(r"^(?=\w+: )", re.MULTILINE)


def variables_page() -> str:
    """Write the page of all variables of all components."""
    from fmus.export import variables_table
    from seat_cosim.components import COMPONENTS

    return _WIDE + variables_table.page(COMPONENTS)


def rules_page() -> str:
    """Write the page of the rules of the conformance suite."""
    from cosim.conformance import rule_docs

    return rule_docs.page()


def commands_page() -> str:
    """Write the page of the command line."""
    from seat_cosim.cli.main import app

    context = click.Context(app, info_name="seat-cosim")
    parts = [_COMMANDS_HEAD, "Options of all commands:\n", *_options(app, context)]
    for name in app.list_commands(context):
        command = app.get_command(context, name)
        assert command is not None
        parts += _command(command, click.Context(command, parent=context, info_name=name))
    return "\n".join(parts)


def _command(command: click.Command, context: click.Context) -> Iterator[str]:
    """Write a command's section: usage, help, options."""
    yield f"## {context.command_path}\n"
    yield f"```text\n{' '.join([context.command_path, *command.collect_usage_pieces(context)])}\n```\n"
    for paragraph in inspect.cleandoc(command.help or "").split("\n\n"):
        if paragraph.startswith("\b\n"):  # click's mark of lines that stay as they are
            yield from _verbatim(paragraph.removeprefix("\b\n"))
        else:
            yield f"{_escaped(' '.join(paragraph.split()))}\n"
    yield from _options(command, context)


def _verbatim(text: str) -> Iterator[str]:
    """Write lines of help that stay as they are: items of the form ``Name: text``, and a block of examples."""
    before, heading, examples = (*_EXAMPLES.split(text, maxsplit=1), "", "")[:3]
    for item in filter(str.strip, _ITEMS.split(before)):
        yield f"{_escaped(' '.join(item.split()))}\n"
    if heading:
        yield f"{heading}\n\n```sh\n{inspect.cleandoc(examples)}\n```\n"


def _options(command: click.Command, context: click.Context) -> Iterator[str]:
    """Write a list of a command's options; its arguments stand in the usage."""
    options = [each for each in command.params if isinstance(each, click.Option)]
    records = [record for each in options if (record := each.get_help_record(context))]
    yield "".join(f"- `{option}`: {_escaped(' '.join(text.split()))}\n" for option, text in records)


def _escaped(text: str) -> str:
    """Protect what Markdown would read as markup."""
    return re.sub(r"(?<!`)([*<>_])", r"\\\1", text)


PAGES: dict[str, Callable[[], str]] = {
    "docs/reference/command-line.md": commands_page,
    "docs/reference/validate.md": rules_page,
    "docs/reference/variables.md": variables_page,
}
"""Path in the repository to the function that returns the page."""


def main() -> None:
    """Write all pages; the working directory must be the repository's root."""
    for path, page in PAGES.items():
        Path(path).write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
