"""A group of commands whose modules are loaded when a command runs; a list of commands loads none."""

from __future__ import annotations

import ast
import os
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from types import FrameType
from typing import Any

import click

from cosim.errors import did_you_mean


@contextmanager
def _leaving_at_once() -> Iterator[None]:
    """End the process at Ctrl-C while modules are loaded: nothing has begun, and imports may swallow the exception."""
    in_main_thread = threading.current_thread() is threading.main_thread()
    before = signal.getsignal(signal.SIGINT)
    if not in_main_thread or before is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _leave(number: int, frame: FrameType | None) -> None:
    os.write(2, b"seat-cosim: error: interrupted\n")
    os._exit(1)


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
        with _leaving_at_once():
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
