"""Folders of results: a run overwrites one of another kind only with ``--force``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import click

from cosim.errors import SetupError, writing_to
from cosim.results.folder_lock import locked_folder
from seat_cosim.assessment import DATA

RUN = "run.json"
EVALUATION = "evaluation.json"

force_option = click.option("--force", is_flag=True, help="Overwrite results of another kind.")

_WITHOUT_EFFECT = {"--debug", "--force", "--quiet", "--json"}
"""Words of a command line that do not change its results."""


def choose_folder(
    output: Path | None, default: Path, command: Sequence[str], *, force: bool = False, marker: str = RUN
) -> Path:
    """Choose the folder of a run's results, and lock it until the command ends.

    Parameters
    ----------
    output
        Folder that the user asked for; ``~`` is expanded.
    default
        Folder where None; a number is added where it holds the results of another command line.
    command
        Words of the command line.
    force
        Whether results of another kind in ``output`` may be overwritten.
    marker
        File with the command line of earlier results, from the folder.

    Returns
    -------
    Path
        A folder that is new, or holds results of the same command line, or of the same kind where it was asked for.

    Raises
    ------
    SetupError
        If ``output`` holds results of another kind, or another run writes to the folder.
    """
    folder = _choose_folder(output, default, command, force, marker)
    lock(folder)
    if (now := _choose_folder(output, default, command, force, marker)) != folder:  # another run was faster
        folder = now
        lock(folder)
    return folder


def lock(folder: Path) -> None:
    """Lock a folder until the command ends, where one runs.

    Parameters
    ----------
    folder
        The folder.

    Raises
    ------
    SetupError
        If another run writes to it.
    """
    if context := click.get_current_context(silent=True):
        context.with_resource(locked_folder(folder))


def _choose_folder(output: Path | None, default: Path, command: Sequence[str], force: bool, marker: str) -> Path:
    """Choose a folder, see :func:`choose_folder`."""
    if output is None:
        number, folder = 1, default
        while _command(folder, marker) not in (None, _effective(command)):
            number += 1
            folder = default.with_name(f"{default.name}-{number}")
        return folder
    folder = output.expanduser()
    for name in {RUN, EVALUATION, DATA, marker}:
        earlier = _command(folder, name)
        if earlier is not None and _kind(earlier) != _kind(_effective(command)) and not force:
            before = " ".join(["seat-cosim", *_kind(earlier)]) if earlier else "another program"
            raise SetupError(
                f"--output {folder}: expected no results of another kind, got those of {before}; --force overwrites"
            )
    return folder


def write_command(path: Path, command: Sequence[str]) -> None:
    """Write the command line of results that no run.json describes.

    Parameters
    ----------
    path
        The file.
    command
        Words of the command line.

    Raises
    ------
    SetupError
        If it cannot be written.
    """
    with writing_to(path.parent):
        path.write_text(json.dumps({"command": list(command)}, indent=2) + "\n", encoding="utf-8")


def _command(folder: Path, marker: str) -> list[str] | None:
    """Return the command line of earlier results; None where there are no rows, an empty one where it is not known."""
    try:
        data = json.loads((folder / marker).read_text(encoding="utf-8"))
        if data.get("complete") is False and not data.get("rows", 1):
            return None  # a run that has left no row
        return _effective(data["command"])
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError, KeyError, TypeError):
        return []


def _effective(command: Sequence[str]) -> list[str]:
    return [word for word in command[1:] if word not in _WITHOUT_EFFECT]


def _kind(words: Sequence[str]) -> list[str]:
    """Return the subcommand and its first argument."""
    return [words[0], *(word for word in words[1:2] if not word.startswith("-"))] if words else []
