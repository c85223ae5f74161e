"""A group of commands whose modules are loaded when a command runs; a list of commands loads none."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from cosim.errors import did_you_mean
from seat_cosim.cli.loading import leaving_at_once


class LazyGroup(click.Group):
    """Group of commands that are loaded when they are used.

    Parameters
    ----------
    *arguments, **options
        As of :class:`click.Group`.
    modules
        Name of a command to its module and the name of its function there.
    """

    def __init__(self, *arguments: Any, modules: Mapping[str, tuple[str, str]], **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._modules = modules

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands, sorted."""
        return sorted(self._modules)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Load a command; None where there is none of the name.

        Parameters
        ----------
        ctx
            Context of the group.
        cmd_name
            Name of the command.

        Returns
        -------
        click.Command or None
            The command, with its module loaded.
        """
        if cmd_name not in self._modules:
            return None
        module, function = self._modules[cmd_name]
        with leaving_at_once():
            command = getattr(import_module(module), function)
        assert isinstance(command, click.Command)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command that the words name; ``help`` is the option of that name.

        Parameters
        ----------
        ctx
            Context of the group.
        args
            The words.

        Returns
        -------
        tuple
            Name, command and further words.

        Raises
        ------
        click.UsageError
            If there is no such command; names the nearest one.
        """
        name = args[0]
        if name == "help":
            click.echo(ctx.get_help())
            ctx.exit()
        if name not in self._modules and not name.startswith("-"):
            near = did_you_mean(name, self._modules)
            raise click.UsageError(f"expected a command, got {name}{near}; seat-cosim --help lists them")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands, with the first sentence of each one's help as its source has it.

        Parameters
        ----------
        ctx
            Context of the group.
        formatter
            Formatter of the help text.
        """
        names = self.list_commands(ctx)
        limit = formatter.width - 6 - max(map(len, names))
        rows = [(name, click.Command(name, help=self._help(name)).get_short_help_str(limit)) for name in names]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def _help(self, name: str) -> str | None:
        """Read a command's help from the source of its module, which is not executed."""
        module, function = self._modules[name]
        source = Path(__file__).parent / f"{module.rpartition('.')[2]}.py"
        tree = ast.parse(source.read_text(encoding="utf-8"))
        found = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == function)
        return next((ast.get_docstring(node) for node in found), None)
