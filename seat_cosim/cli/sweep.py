"""``seat-cosim sweep``: many runs of a study, on the cores of this machine or on a cluster."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import RunError, SetupError
from cosim.fmi.interrupts import Ended
from seat_cosim.cli.console import command_line, console, progress_shown, stderr
from seat_cosim.cli.outcome import OutputOptions, output_options

if TYPE_CHECKING:  # takes long to load
    from cosim.sweep.study import Study
    from cosim.sweep.sweep import Estimate, Progress, SweepResult


@click.command()
@click.argument("study_file", metavar="STUDY.toml|NAME")
@click.option("--dry-run", is_flag=True, help="Print the number of runs and the time they take, measured on a few.")
@click.option("--processes", type=click.IntRange(min=1), metavar="N", help="[default: one for each core]")
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Of a Dask cluster on this machine, instead.")
@click.option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster whose workers run the study, instead.")
@output_options
@click.option("--figure/--no-figure", "with_figure", default=True, show_default=True, help="Draw the study's figure.")
@click.option("--force", is_flag=True, help="Remove what another study has left in the folder.")
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/sweep/NAME].")
def sweep(
    study_file: str,
    dry_run: bool,
    processes: int | None,
    workers: int | None,
    scheduler: str | None,
    quiet: bool,
    as_json: bool,
    with_figure: bool,
    force: bool,
    output: Path | None,
) -> None:
    """Run a study: all its runs, each a row of one table, runs.parquet; the same bytes whatever the workers.

    The same command goes on where an interrupted one has stopped. A run that fails is a row with its reason.

    \b
    Studies of the package: driver_masses, actuator_tolerance, seat_mismatch, prototype_imperfections, comfort_stroke.
    Examples:
      seat-cosim sweep driver_masses --dry-run
      seat-cosim sweep driver_masses
      seat-cosim sweep STUDY.toml --processes 4 --output results/mine
      seat-cosim sweep STUDY.toml --scheduler tcp://head:8786
    """
    from cosim.sweep.sweep import estimate
    from cosim.sweep.sweep import sweep as run
    from seat_cosim.study import read

    if len([each for each in (processes, workers, scheduler) if each is not None]) > 1:
        raise SetupError("--processes, --workers, --scheduler: expected one of them, got several")
    study = read(study_file)
    count = processes or workers or os.cpu_count() or 1
    printed = OutputOptions(quiet, as_json)
    if dry_run:
        with progress_shown("measuring a few runs"):
            found = estimate(study)
        _print_estimate(study, found, count, printed)
        return
    folder = output.expanduser() if output is not None else Path("results", "sweep", study.name)
    with _resumable(), progress_shown(f"sweep {study.name}") as report:
        result = run(
            study,
            folder,
            processes=count,
            scheduler=scheduler,
            workers=workers,
            force=force,
            command=command_line(),
            progress=lambda progress: report(_words(progress)),
        )
        if result.failed == result.runs:
            index, reason = result.failures[0]
            raise RunError(f"{result.path}: expected runs that end, got none; run {index}: {reason}")
        files = [result.path]
        answer = ""
        if study.figure is not None:
            from seat_cosim.study.figures import FIGURES

            report("figure")
            files += FIGURES[study.figure].draw(result.columns(), folder) if with_figure else []
            answer = FIGURES[study.figure].answer(result.columns())
    _print_failures(result)
    _print(study, result, answer, files, printed)


@contextmanager
def _resumable() -> Iterator[None]:
    """Say how to go on after an interrupt."""
    try:
        yield
    except (KeyboardInterrupt, Ended):
        stderr.print("note: finished batches are kept; the same command runs the rest", soft_wrap=True)
        raise


def _words(progress: Progress) -> str:
    """Return progress as words."""
    failed = f", {progress.failed} failed" if progress.failed else ""
    left = "" if progress.left is None else f", {duration(progress.left)} left"
    return f"{progress.done} of {progress.runs} runs{failed}{left}"


def duration(seconds: float) -> str:
    """Return a time as words.

    Parameters
    ----------
    seconds
        In s.

    Examples
    --------
    >>> duration(7.31), duration(130.0), duration(8000.0)
    ('7.3 s', '2 min 10 s', '2 h 13 min')
    """
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def _print_estimate(study: Study, found: Estimate, workers: int, printed: OutputOptions) -> None:
    total = found.total(workers)
    if printed.as_json:
        numbers = {"runs": found.runs, "measured": found.measured, "seconds_per_run": found.seconds}
        click.echo(json.dumps({**numbers, "workers": workers, "seconds": total, "failed": len(found.failures)}))
        return
    for index, reason in found.failures:
        stderr.print(f"warning: run {index} failed: {reason}", soft_wrap=True)
    console.print(f"{study.name}: {found.runs} runs of {', '.join(study.design.variables) or 'no variable'}")
    console.print(
        f"{1e3 * found.seconds:.1f} ms for each run, of which metrics {1e3 * found.metrics:.1f} ms, "
        f"measured on {found.measured}",
        soft_wrap=True,
    )
    console.print(f"about {duration(total)} on {workers} {'worker' if workers == 1 else 'workers'}")


def _print_failures(result: SweepResult) -> None:
    """Print the first failed runs with their reasons, each reason once."""
    reasons: dict[str, list[int]] = {}
    for index, reason in result.failures:
        reasons.setdefault(reason, []).append(index)
    for reason, indices in list(reasons.items())[:5]:
        more = f" and {len(indices) - 1} more" if len(indices) > 1 else ""
        stderr.print(f"warning: run {indices[0]}{more} failed: {reason}", soft_wrap=True)
    if result.failed > len(result.failures):
        stderr.print(f"warning: {result.failed} runs failed in all, see the column error", soft_wrap=True)


def _print(study: Study, result: SweepResult, answer: str, files: list[Path], printed: OutputOptions) -> None:
    if printed.as_json:
        numbers: dict[str, Any] = {name: getattr(result, name) for name in ("runs", "resumed", "failed", "elapsed")}
        click.echo(json.dumps({**numbers, "table": str(result.path), "answer": answer}, ensure_ascii=False))
    if not printed.prints_text:
        return
    table = Table("metric", title=study.question or study.name, title_justify="left", box=SIMPLE)
    for name in ("smallest", "median", "largest", "unit"):
        table.add_column(name, justify="right" if name != "unit" else "left")
    for name, unit, values in _metrics(result):
        low, middle, high = (f"{value:.4g}" for value in np.quantile(values, [0.0, 0.5, 1.0]))
        table.add_row(name, low, middle, high, unit)
    console.print(table)
    if answer:
        console.print(answer, soft_wrap=True)
    rate = f", {(result.runs - result.resumed) / result.elapsed:.0f} a second" if result.elapsed else ""
    resumed = f", {result.resumed} of them before" if result.resumed else ""
    console.print(f"{result.runs} runs{resumed}, {result.failed} failed{rate}", soft_wrap=True)
    console.print(f"{', '.join(path.name for path in files)} in {result.folder}", soft_wrap=True)


def _metrics(result: SweepResult) -> Iterator[tuple[str, str, Any]]:
    """Yield the metrics of the table: name, unit, the numbers of the runs that have it."""
    for column in result.metric_columns:
        values = result.columns([column.name])[column.name]
        known = values[np.isfinite(values)]
        if known.size:
            yield column.name, column.unit or "", known
