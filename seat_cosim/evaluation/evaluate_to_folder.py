"""Evaluation of a system whose report, table, figure and system file are written to a folder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from cosim.errors import writing_to
from seat_cosim.evaluation.protocol import Protocol
from seat_cosim.evaluation.report import write
from seat_cosim.evaluation.results import Evaluation
from seat_cosim.evaluation.runner import check, evaluate
from seat_cosim.evaluation.system import EvaluatedSystem


def evaluate_to_folder(
    systems: Sequence[EvaluatedSystem],
    protocol: Protocol,
    folder: Path,
    *,
    processes: int = 1,
    progress: Callable[[str], None] = lambda text: None,
    command: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> tuple[list[Evaluation], list[Path]]:
    """Evaluate systems and write the report.

    Parameters
    ----------
    systems
        The system that the report is about, then those that it is compared with.
    protocol
        Classes, drivers and seeds.
    folder
        Folder of the files; it is made if it does not exist, after all checks.
    processes
        Number of processes, see :func:`seat_cosim.evaluation.runner.evaluate`.
    progress
        Called with a description of the progress.
    command
        Words of the command line, for the report.
    notes
        Sentences that a reader of the report must know.

    Returns
    -------
    list of Evaluation
        In the order of the systems.
    list of Path
        The files.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before a run; no folder is made then, unless it cannot be written to.
    RunError
        If an FMU failed.
    """
    for evaluated in systems:
        check(evaluated, protocol)
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
    evaluations = evaluate(systems, protocol, processes, lambda done, total: progress(f"{done} of {total} classes"))
    progress("page")
    return evaluations, write(folder, evaluations, protocol, command, notes)
