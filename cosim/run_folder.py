"""A run that writes a folder: its table, row by row while it goes on, and a ``run.json`` that describes it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from cosim.engine.run_options import RunOptions
from cosim.engine.session import Session
from cosim.errors import CosimError, RunError, writing_to
from cosim.manifest import Manifest
from cosim.results.file_sink import FileSink
from cosim.results.formats import create_sinks
from cosim.results.result import MANIFEST, Result, prepare_folder
from cosim.system import System


def run_to_folder(
    system: System,
    folder: Path,
    options: RunOptions | None = None,
    *,
    command: Sequence[str] = (),
    session: Session | None = None,
) -> Result:
    """Run a system and write result and ``run.json`` to a folder; those of an earlier run there are removed.

    The rows of ``result.partial.csv`` are on disk as they come, and ``run.json`` says ``"complete": false``, until the
    run has reached its stop time: whatever ends the process before, its rows are there. Prints nothing.

    Parameters
    ----------
    system
        What to run.
    folder
        Where to write; made if need be, and not touched if the run is not possible at all.
    options
        Of the run.
    command
        The user's command line, for ``run.json``.
    session
        An open session of the system, whose isolation and time limit hold; otherwise its FMUs are loaded for this run.

    Returns
    -------
    Result
        An incomplete one has an ``error`` that also says how many rows there are and where.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before the run, be it a package or a folder.
    RunError
        If an FMU failed during loading or initialization.
    """
    options = options or RunOptions()
    if session is not None:
        options = replace(options, isolate=session.isolated, time_limit=session.time_limit)
    checked = options.check(system)
    files = create_sinks(folder, options.formats)
    manifest = Manifest.of(system, options, command, checked)
    options = replace(options, sinks=(*files, *options.sinks))
    with writing_to(folder):
        prepare_folder(folder)
        manifest.write(folder)
    try:
        with nullcontext(session) if session else _open(system, options) as loaded:
            result = loaded.execute(options, checked)
    except CosimError as error:
        _finish(manifest.ended(False, error, [], files), folder)
        raise
    _finish(manifest.ended(result.complete, result.error, result.warnings, files), folder)
    if result.error is None:
        return result
    return replace(result, error=_with_rows(result.error, files[0], manifest.stop_time))


def _open(system: System, options: RunOptions) -> Session:
    return system.open(options.isolate, options.time_limit, options.capture_stdout)


def _finish(manifest: Manifest, folder: Path) -> None:
    try:
        manifest.write(folder)
    except OSError as error:
        raise RunError(f"{folder / MANIFEST}: expected to write it, got: {error.strerror}") from error


def _with_rows(error: Exception, file: FileSink, stop_time: float) -> RunError:
    """Add to an error how many rows of the result there are, and where."""
    reached = f"{file.rows} rows up to t = {file.reached:g} s" if file.rows else "no rows"
    extended = RunError(f"{error} ({reached} of {stop_time:g} s in {file.path})")
    extended.__cause__ = error
    return extended
