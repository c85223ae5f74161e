"""A run that leaves a folder: its table, row by row while it goes on, and a ``run.json`` that tells how it was made."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from cosim.engine.session import Session
from cosim.engine.structure import Algorithm
from cosim.errors import CosimError, RunError, writing_to
from cosim.fmi.description import Value
from cosim.fmi.isolated import TIME_LIMIT
from cosim.manifest import Manifest
from cosim.results.formats import FileSink, sinks
from cosim.results.result import MANIFEST, Result, clear
from cosim.system import System


def run_to_folder(
    system: System,
    folder: Path,
    *,
    stop_time: float | None = None,
    step_size: float | None = None,
    parameters: Mapping[str, Value] | None = None,
    record: Iterable[str] | None = None,
    record_every: int = 1,
    formats: Iterable[str] = (),
    progress: Callable[[float], None] | None = None,
    command: Sequence[str] = (),
    session: Session | None = None,
    algorithm: Algorithm | None = None,
    real_time: bool = False,
    keep: bool = True,
    isolate: Iterable[str] = (),
    time_limit: float = TIME_LIMIT,
) -> Result:
    """Run a system and leave result and ``run.json`` in a folder; what an earlier run left there goes.

    The rows of ``result.partial.csv`` are on disk as they come, and ``run.json`` says ``"complete": false``, until the
    run has reached its stop time: whatever ends the process before, its rows are there. Prints nothing.

    Parameters
    ----------
    system
        What to run.
    folder
        Where to; made if need be, and left alone if the run is not possible at all.
    stop_time, step_size, parameters, record, record_every, progress, algorithm, real_time
        As of :meth:`cosim.engine.session.Session.run`.
    formats
        Beside CSV: ``parquet``, ``mdf4``.
    command
        What the user typed, for ``run.json``.
    session
        An open session of the system; otherwise its FMUs are loaded for this run.
    keep
        Whether the result is wanted in memory as well; otherwise the one returned has no rows.
    isolate, time_limit
        As of :class:`cosim.engine.session.Session`; where one is given, its own count.

    Returns
    -------
    Result
        An incomplete one has an ``error`` that also says what there is and where.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before the run, be it a package or a folder.
    RunError
        If an FMU failed while loading or initialising.
    """
    record, formats = None if record is None else list(record), list(formats)
    isolate, time_limit = (session.isolated, session.time_limit) if session else (list(isolate), time_limit)
    system.validate(
        stop_time, step_size, parameters, record, algorithm, record_every, isolate=isolate, time_limit=time_limit
    )
    files = sinks(folder, formats)
    manifest = Manifest.of(
        system,
        stop_time=stop_time,
        step_size=step_size,
        parameters=parameters,
        record=record,
        record_every=record_every,
        formats=formats,
        command=command,
        algorithm=algorithm,
        real_time=real_time,
        isolate=isolate,
        time_limit=time_limit,
    )
    with writing_to(folder):
        clear(folder)
        manifest.write(folder)
    try:
        with nullcontext(session) if session else system.open(isolate, time_limit) as opened:
            result = opened.run(
                stop_time,
                step_size,
                parameters,
                record,
                progress,
                algorithm=algorithm,
                record_every=record_every,
                sinks=files,
                keep=keep,
                real_time=real_time,
            )
    except CosimError as error:
        _finish(manifest.ended(False, error, [], files), folder)
        raise
    _finish(manifest.ended(result.complete, result.error, result.warnings, files), folder)
    if result.error is None:
        return result
    return replace(result, error=_with_what_is_left(result.error, files[0], manifest.stop_time))


def _finish(manifest: Manifest, folder: Path) -> None:
    try:
        manifest.write(folder)
    except OSError as error:
        raise RunError(f"{folder / MANIFEST}: expected to write it, got: {error.strerror}") from error


def _with_what_is_left(error: Exception, file: FileSink, stop_time: float) -> RunError:
    """Add to an error what there is of the result, and where."""
    reached = f"{file.rows} rows up to t = {file.reached:g} s" if file.rows else "no rows"
    told = RunError(f"{error} ({reached} of {stop_time:g} s in {file.path})")
    told.__cause__ = error
    return told
