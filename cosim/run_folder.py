"""A run that writes a folder: its table, row by row while it goes on, and a ``run.json`` that describes it.

The folder is locked for the run. Each file gets its final name in one step, ``run.json`` with the hashes of the others
last: what it calls complete is complete.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from time import monotonic

from cosim.engine.run_options import RunOptions
from cosim.engine.session import Session
from cosim.errors import CosimError, RunError, writing_to
from cosim.fmi.interrupts import Ended, deferring_signals
from cosim.manifest import Manifest
from cosim.results.file_sink import FileSink, Rows
from cosim.results.folder_lock import locked_folder
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
    run has reached its stop time: whatever ends the process before, its rows are there. An exception of a sink or of
    the progress callback, an interrupt, and a signal that ends the process leave a ``run.json`` with rows, time reached
    and reason; of a killed process it is that of the last seconds. Prints nothing.

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
        If something is wrong that can be seen before the run, be it a package, or a folder that another run writes to.
    RunError
        If an FMU failed during loading or initialization.
    """
    options = options or RunOptions()
    if session is not None:
        options = replace(options, isolate=session.isolated, time_limit=session.time_limit)
    checked = options.check(system)
    files = create_sinks(folder, options.formats)
    manifest = Manifest.of(system, options, command, checked)
    options = replace(options, sinks=(*files, *options.sinks, _Progress(manifest, folder, files[0])))
    with deferring_signals(), locked_folder(folder):
        with writing_to(folder):
            prepare_folder(folder)
            replace(manifest, error=UNFINISHED).write(folder)
        try:
            with nullcontext(session) if session else _open(system, options) as loaded:
                result = loaded.execute(options, checked)
        except BaseException as error:
            _finish(manifest.ended(False, _reason(error), [], files), folder)
            raise
        reason = None if result.error is None else str(result.error)
        _finish(manifest.ended(result.complete, reason, result.warnings, files), folder)
    if result.error is None:
        return result
    return replace(result, error=_with_rows(result.error, files[0], manifest.stop_time))


UNFINISHED = "has not ended: it goes on, or its process was killed"
"""The ``error`` of a ``run.json`` until the run has ended."""

_INTERVAL = 2.0
"""Time between two states of ``run.json`` while a run goes on, in s."""


class _Progress:
    """A sink that keeps ``run.json`` up to date while the run goes on.

    Parameters
    ----------
    manifest
        Of the run, before its end.
    folder
        Where to write it.
    file
        The sink that counts the rows.
    """

    def __init__(self, manifest: Manifest, folder: Path, file: FileSink) -> None:
        self._manifest, self._folder, self._file = replace(manifest, error=UNFINISHED), folder, file
        self._last = monotonic()

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Do nothing."""

    def write(self, rows: Rows) -> None:
        """Write ``run.json``, if the last time was long ago."""
        if monotonic() - self._last > _INTERVAL:
            _finish(self._manifest.reaching(self._file), self._folder)
            self._last = monotonic()

    def end(self, complete: bool) -> None:
        """Do nothing: the end of the run is described when all files are closed."""


def _reason(error: BaseException) -> str:
    """Describe what ended a run."""
    if isinstance(error, CosimError | Ended):
        return str(error)
    if isinstance(error, KeyboardInterrupt):
        return "interrupted"
    return f"{type(error).__name__}: {error}"


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
