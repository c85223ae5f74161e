"""Evaluation report: an HTML page that needs no other file, tables, a figure, and the evaluated system."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import writing_to
from cosim.manifest import Manifest, sha256
from seat_cosim.evaluation.criteria import Judgement, Outcome
from seat_cosim.evaluation.input_figure import draw_inputs
from seat_cosim.evaluation.inputs import INPUTS
from seat_cosim.evaluation.protocol import EDITIONS, Protocol
from seat_cosim.evaluation.results import METRICS, Evaluation
from seat_cosim.evaluation.tables import criteria_table, exposure_table, input_table, inputs, numbers_table
from seat_cosim.evaluation.verdict import SeatVerdict, judge_all
from seat_cosim.heat_map import HeatMap, draw_heat_maps
from seat_cosim.html_page import embedded, render

PAGE, TABLE, DATA, SYSTEM = "evaluation.html", "evaluation.csv", "evaluation.json", "system.ssp"
"""Names of the files."""

FIGURE, INPUT_FIGURE = "seat", "inputs.svg"
"""Names of the figures; the first without suffix."""


def write(
    folder: Path,
    evaluations: Sequence[Evaluation],
    protocol: Protocol,
    command: Sequence[str],
    notes: Sequence[str],
) -> list[Path]:
    """Write report, tables, figures and system; the same evaluation gives the same bytes on the same machine.

    Parameters
    ----------
    folder
        Folder of the files; it is made if it does not exist.
    evaluations
        The evaluation that the report is about, then those that it is compared with.
    protocol
        Protocol of all of them.
    command
        Words of the command line.
    notes
        Sentences that a reader must know.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    SetupError
        If the folder cannot be written to.
    """
    evaluated = evaluations[0].evaluated
    verdicts = judge_all(evaluations, protocol)
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        evaluated.system.save(folder / SYSTEM)
        write_table(folder / TABLE, evaluations, verdicts)
        data = summary(evaluations, verdicts, protocol, notes)
        (folder / DATA).write_text(_json({"command": list(command), **data}), encoding="utf-8")
        figures = [folder / f"{FIGURE}{suffix}" for suffix in (".svg", ".png")]
        maps = [heat_map(each, verdict, protocol) for each, verdict in zip(evaluations, verdicts, strict=True)]
        draw_heat_maps(figures, maps)
        spectra = _draw_inputs(folder / INPUT_FIGURE, evaluations[0], protocol)
        options = RunOptions(protocol.stop_time, record=evaluated.signals.outputs)
        manifest = Manifest.of(evaluated.system, options, command)
        facts = {
            "How it was made": _conditions(evaluations[0], protocol, manifest),
            "What was evaluated": _identity(manifest, sha256(folder / SYSTEM)),
        }
        pictures = (embedded(figures[0]), embedded(spectra[0]) if spectra else None)
        page = _page(evaluations, verdicts, protocol, facts, pictures, notes)
        (folder / PAGE).write_text(page, encoding="utf-8")
    return [folder / PAGE, folder / TABLE, folder / DATA, *figures, *spectra, folder / SYSTEM]


def _draw_inputs(path: Path, evaluation: Evaluation, protocol: Protocol) -> list[Path]:
    """Draw the inputs whose spectra are known; returns the file, if there are any."""
    found = {
        name: [ride.conformity for ride in inputs(evaluation, protocol, name).values() if ride.conformity is not None]
        for name in protocol.classes
    }
    known = {name: each for name, each in found.items() if each}
    if known:
        draw_inputs([path], known)
    return [path] if known else []


def write_table(path: Path, evaluations: Sequence[Evaluation], verdicts: Sequence[SeatVerdict]) -> None:
    """Write all results as CSV; floats read back exactly, and a metric that a system does not have is empty.

    Parameters
    ----------
    path
        The file.
    evaluations
        One after the other, a row for each class and driver.
    verdicts
        Verdict on each of them.
    """
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        names = [f"{metric.key} ({metric.unit_shown})" if metric.unit_shown else metric.key for metric in METRICS]
        fixed = ["system", "class", "driver_mass (kg)", "verdict", "deciding_criterion", "failed", "not_judged"]
        rows.writerow([*fixed, "seat_limit", "runs", *names])
        for evaluation, verdict in zip(evaluations, verdicts, strict=True):
            title = evaluation.evaluated.title
            for (excitation_class, mass), result in evaluation.results.items():
                cell = verdict.cells[excitation_class, mass]
                lists = (" ".join(_keys(cell.having(each))) for each in (Outcome.FAIL, Outcome.NOT_JUDGED))
                known: list[object] = [title, excitation_class, mass, str(cell.outcome), cell.deciding.criterion.key]
                limit = INPUTS[excitation_class].seat_limit if excitation_class in INPUTS else None
                known += [*lists, limit, len(result.rides)]
                numbers = (metric.number(result) for metric in METRICS)
                rows.writerow(["" if value is None else value for value in (*known, *numbers)])


def _keys(judgements: Sequence[Judgement]) -> list[str]:
    return [each.criterion.key for each in judgements]


def summary(
    evaluations: Sequence[Evaluation],
    verdicts: Sequence[SeatVerdict],
    protocol: Protocol,
    notes: Sequence[str],
) -> dict[str, Any]:
    """Return verdicts, criteria and all results for JSON.

    Parameters
    ----------
    evaluations
        The evaluation that the report is about, then those that it is compared with.
    verdicts
        Verdict on each of them.
    protocol
        Their protocol.
    notes
        Sentences that a reader must know.
    """
    systems = [_system(each, verdict) for each, verdict in zip(evaluations, verdicts, strict=True)]
    return {
        "verdict": systems[0]["verdict"],
        "deciding_criterion": systems[0]["deciding_criterion"],
        "sentence": verdicts[0].sentence,
        "protocol": {
            "name": protocol.name,
            "edition": EDITIONS[protocol.name],
            "classes": list(protocol.classes),
            "driver_masses": list(protocol.masses),
            "seeds": {name: [run.seed for run in protocol.runs(name)] for name in protocol.classes},
            "duration": protocol.duration,
            "warm_up": protocol.warm_up,
        },
        "travel_m": evaluations[0].evaluated.end_stop_travel,
        "systems": systems,
        "notes": list(notes),
    }


def _json(data: dict[str, Any]) -> str:
    return json.dumps(_finite(data), indent=2, ensure_ascii=False) + "\n"


def _finite(value: Any) -> Any:
    """Replace numbers that JSON does not have by None."""
    if isinstance(value, dict):
        return {name: _finite(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _system(evaluation: Evaluation, verdict: SeatVerdict) -> dict[str, Any]:
    """Return the results of a system for :func:`summary`."""
    rows = []
    for (excitation_class, mass), result in evaluation.results.items():
        cell = verdict.cells[excitation_class, mass]
        rows.append(
            {
                "class": excitation_class,
                "driver_mass": mass,
                "verdict": str(cell.outcome),
                "deciding_criterion": cell.deciding.criterion.key,
                "criteria": [_judgement(each) for each in cell.judgements],
                "metrics": {metric.key: metric.number(result) for metric in METRICS},
            }
        )
    damping = evaluation.damping
    return {
        "system": evaluation.evaluated.title,
        "verdict": str(verdict.outcome),
        "deciding_criterion": verdict.deciding.criterion.key,
        "criteria": [
            {
                **_judgement(each.worst),
                "words": each.criterion.words,
                "limit_from": each.criterion.source,
                "class": each.where[0],
                "driver_mass": each.where[1],
                "failed": each.counts[Outcome.FAIL],
                "not_judged": each.counts[Outcome.NOT_JUDGED],
            }
            for each in verdict.criteria
        ],
        "damping_test": damping and {"frequency": damping.frequency, "transmissibility": damping.transmissibility},
        "units": {metric.key: metric.unit for metric in METRICS},
        "results": rows,
    }


def _judgement(judgement: Judgement) -> dict[str, Any]:
    return {
        "criterion": judgement.criterion.key,
        "value": judgement.value,
        "limit": judgement.limit,
        "verdict": str(judgement.outcome),
        "detail": judgement.detail,
    }


def heat_map(evaluation: Evaluation, verdict: SeatVerdict, protocol: Protocol) -> HeatMap:
    """Return the SEAT of all drivers (rows) on all classes (columns) as a heat map.

    Parameters
    ----------
    evaluation
        Of one system.
    verdict
        Verdict on it; combinations that fail are framed.
    protocol
        Its protocol.
    """
    rows = [[(name, mass) for name in protocol.classes] for mass in protocol.masses]
    return HeatMap(
        f"SEAT, {evaluation.evaluated.title} (framed: fails a criterion)",
        [f"{mass:g} kg" for mass in protocol.masses],
        protocol.classes,
        np.array([[evaluation.results[key].seat for key in row] for row in rows]),
        np.array([[verdict.cells[key].outcome is Outcome.FAIL for key in row] for row in rows]),
    )


def _page(
    evaluations: Sequence[Evaluation],
    verdicts: Sequence[SeatVerdict],
    protocol: Protocol,
    facts: Mapping[str, Mapping[str, str]],
    pictures: tuple[str, str | None],
    notes: Sequence[str],
) -> str:
    first = evaluations[0]
    pairs = list(zip(evaluations, verdicts, strict=True))
    return render(
        "evaluation/report.html.jinja",
        title=f"Vibration isolation: {first.evaluated.title}",
        verdict=verdicts[0].sentence,
        outcome=str(verdicts[0].outcome).replace(" ", "-"),
        notes=notes,
        image=pictures[0],
        input_image=pictures[1],
        criteria=[
            criteria_table(each.evaluated.title, verdict, with_sentence=each is not first) for each, verdict in pairs
        ],
        tables=[
            *(numbers_table(each, verdict, first) for each, verdict in pairs),
            *(exposure_table(each, protocol) for each in evaluations),
            input_table(first, protocol),
        ],
        facts=facts,
    )


def _end_stops(travel: float, height: float) -> str:
    """Return where the end stops are met, in words; travel and height in m."""
    if not height:
        return f"{1e3 * travel:g} mm each way"
    return f"{1e3 * (travel - height):g} mm above and {1e3 * (travel + height):g} mm below static equilibrium"


def _conditions(evaluation: Evaluation, protocol: Protocol, manifest: Manifest) -> dict[str, str]:
    """List the conditions of an evaluation, by name."""
    signals = evaluation.evaluated.signals
    travel, height = evaluation.evaluated.end_stop_travel, evaluation.evaluated.end_stop_height
    standards = ", ".join(dict.fromkeys(INPUTS[name].standard for name in protocol.classes if name in INPUTS))
    repeated = f"each {protocol.repetitions} times" if protocol.repetitions > 1 else "each once"
    damping = evaluation.damping
    classes = f"{', '.join(protocol.classes)} ({standards or 'no standard known'})"
    return {
        "protocol": f"{protocol.name}: {EDITIONS[protocol.name]}",
        "excitation": f"{classes}, seeds in the table, {repeated}",
        "duration": f"{protocol.duration:g} s each, after a warm-up of {protocol.warm_up:g} s",
        "weighting": "Wk of ISO 2631-1, on the floor and where the driver sits",
        "floor": signals.floor_acceleration,
        "driver": signals.seat_acceleration,
        "driver's mass": ", ".join(signals.driver_mass),
        "deflection": signals.suspension_deflection or "none",
        "travel": "unlimited, no end stops" if travel is None else _end_stops(travel, height),
        "force": signals.actuator_force or "none",
        "damping test": "none"
        if damping is None
        else f"75 kg of inert mass, sines of {1e3 * damping.amplitude:g} mm from 0.5 to 2 Hz: transmissibility "
        f"{damping.transmissibility:.2f} at the resonance, {damping.frequency:g} Hz",
        "step": f"{1e3 * manifest.step_size:g} ms, {manifest.algorithm}, in the order {', '.join(manifest.order)}",
        "command": " ".join(manifest.command),
        "versions": ", ".join(f"{name} {version}" for name, version in manifest.versions.items()),
    }


def _identity(manifest: Manifest, digest: str) -> dict[str, str]:
    """List what identifies the system: hashes of its file and its FMUs, and its parameters."""
    rows = {f"{SYSTEM}, sha256": digest}
    for name, component in manifest.components.items():
        rows[name] = f"{component.model}, FMI {component.fmi}, GUID {component.guid}, sha256 {component.sha256}"
    given = ", ".join(f"{name} = {value}" for name, value in manifest.parameters.items())
    return {**rows, "parameters given": given or "none; all others are as the FMUs start"}
