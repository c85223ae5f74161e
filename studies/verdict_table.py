"""Verdicts on the controllers of this project: the table of docs/explanation/evaluation.md.

python -m studies.verdict_table                    nine classes, protocol iso7096: some ten minutes of CPU
python -m studies.verdict_table --classes EM1,EM6  fewer classes
python -m studies.verdict_table --no-baselines     without the skyhook, LQG and PID scripts, which are slow Python FMUs
python -m studies.verdict_table --travel none      without end stops
python -m studies.verdict_table --output DIR       where verdicts.csv with every class and driver goes

All seats stand in the installation of the test, end stops at 40 mm each way. ``ideal`` has perfect sensors and an
actuator without lag; ``prototype`` is the parameter set of that name. The mode robust gets actuator and travel.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from cosim.fmi.values import Value
from seat_cosim.evaluation.criteria import Outcome
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.protocol import CLASSES, iso7096
from seat_cosim.evaluation.report import write_table
from seat_cosim.evaluation.results import Evaluation
from seat_cosim.evaluation.runner import evaluate
from seat_cosim.evaluation.seat import installed, passive_seat, seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.evaluation.verdict import SeatVerdict, judge_all
from seat_cosim.scenarios import gains, mode, read_parameter_sets, seat_suspension
from studies.robust_table import print_table
from studies.tune_baselines import BASELINES, ROOT, build

HEADS = ("verdict", "pass", "decided by", "SEAT", "by VDV", "hits", "impacts add", "mean, mm", "at limit")


class Controller(NamedTuple):
    """A controller: its parameters, the FMU that replaces ours, and whether its mode is robust."""

    parameters: Mapping[str, Value]
    fmu: Path | None = None
    is_robust: bool = False


def controllers(folder: Path | None) -> dict[str, Controller]:
    """Return the controllers by name.

    Parameters
    ----------
    folder
        Folder of the baselines' FMUs; None to leave them out.
    """
    ours = {
        "published": Controller({}),
        "published, anti_windup": Controller({"controller.anti_windup": True}),
        "recommended": Controller(gains("recommended")),
        "robust": Controller({}, is_robust=True),
    }
    others = {} if folder is None else {name: Controller({}, folder / f"{name}.fmu") for name in BASELINES}
    return ours | others


def seats(known: Mapping[str, Controller], installation: Installation, fmus: Path) -> list[EvaluatedSystem]:
    """Return all seats in one installation, the passive one last.

    Parameters
    ----------
    known
        Controllers by name.
    installation
        Travel and end stops.
    fmus
        Folder of the FMUs.
    """
    found = []
    for name, controller in known.items():
        for world in ("ideal", "prototype"):
            title = name if world == "ideal" else f"{name}, {world}"
            system = seat_suspension(fmus)
            if controller.fmu is not None:
                system.replace("controller", controller.fmu)
            parameters = installed(system, installation)
            parameters |= read_parameter_sets(["prototype"], system) if world == "prototype" else {}
            parameters |= controller.parameters
            if controller.is_robust:
                parameters = mode("robust", parameters) | parameters
            system.parameters |= parameters
            signals = seat_signals().for_system(system, {})
            found.append(EvaluatedSystem(title, system, signals, installation.travel))
    reference = seat_suspension(fmus)
    fixture = installed(reference, installation)
    return [*found, passive_seat(reference, read_parameter_sets(["passive"], reference), fixture)]


def cells(evaluation: Evaluation, verdict: SeatVerdict) -> list[str]:
    """Return the row of a seat: its verdict, and the worst of its numbers."""
    results = evaluation.results.values()
    decides = verdict.deciding
    hits = [each.end_stop_hits for each in results if each.end_stop_hits is not None]
    added = [each.seat_vdv_of_impacts for each in results if each.seat_vdv_of_impacts is not None]
    limits = [each.saturated_share for each in results if each.saturated_share is not None]
    mean = max((each.mean_deflection or 0.0 for each in results), key=abs)
    return [
        f"**{verdict.outcome}**",
        f"{verdict.count(Outcome.PASS)} of {len(verdict.cells)}",
        f"{decides.criterion.key.replace('_', ' ')} ({verdict.where[0]}, {verdict.where[1]:g} kg)",
        f"{max(each.seat for each in results):.2f}",
        f"{max(each.seat_vdv for each in results):.2f}",
        f"{sum(hits)}" if hits else "–",
        f"{max(added):.2f}" if added else "–",
        f"{1e3 * mean:.1f}".replace("-", "−"),
        f"{max(limits):.1%}" if limits else "–",
    ]


def failures(verdicts: Mapping[str, SeatVerdict]) -> dict[str, list[str]]:
    """Return the number of failures of each criterion, as rows of a table."""
    keys = list(dict.fromkeys(each.criterion.key for verdict in verdicts.values() for each in verdict.criteria))
    rows = {"": [key.replace("_", " ") for key in keys]}
    for name, verdict in verdicts.items():
        found = {each.criterion.key: each for each in verdict.criteria}
        rows[name] = [str(found[key].counts[Outcome.FAIL]) if key in found else "–" for key in keys]
    return rows


def main() -> None:
    """Evaluate all seats and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--classes", default=",".join(CLASSES), help="names with commas between")
    parser.add_argument("--no-baselines", action="store_true", help="without the skyhook, LQG and PID scripts")
    parser.add_argument("--travel", default="40", help="mm each way, or none")
    parser.add_argument("--processes", type=int, default=1, help="number of processes")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "verdicts", help="folder of verdicts.csv")
    arguments = parser.parse_args()
    protocol = iso7096(classes=tuple(arguments.classes.split(",")))

    def progress(done: int, of: int) -> None:
        print(f"{done} of {of}", end="\r", file=sys.stderr, flush=True)

    with tempfile.TemporaryDirectory() as folder:
        if not arguments.no_baselines:
            build(Path(folder))
        known = controllers(None if arguments.no_baselines else Path(folder))
        systems = seats(known, Installation.of(arguments.travel), ROOT / "fmus" / "fmi2")
        evaluations = evaluate(systems, protocol, arguments.processes, progress)
    verdicts = judge_all(evaluations, protocol)
    arguments.output.mkdir(parents=True, exist_ok=True)
    write_table(arguments.output / "verdicts.csv", evaluations, verdicts)
    pairs = list(zip(evaluations, verdicts, strict=True))
    print(f"protocol {protocol.name}, {arguments.classes}, drivers {protocol.masses} kg, travel {arguments.travel} mm")
    print_table(HEADS, {each.evaluated.title: cells(each, verdict) for each, verdict in pairs})
    print("\nnumber of combinations that fail each criterion")
    rows = failures({each.evaluated.title: verdict for each, verdict in pairs})
    print_table(rows.pop(""), rows)
    for each, verdict in pairs:
        damping = each.damping
        resonance = f"; damping {damping.transmissibility:.2f} at {damping.frequency:g} Hz" if damping else ""
        print(f"\n{each.evaluated.title}: {verdict.sentence}{resonance}")


if __name__ == "__main__":
    main()
