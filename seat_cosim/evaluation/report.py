"""Evaluation report: an HTML page that needs no other file, a table, a figure, and the evaluated system."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import writing_to
from cosim.manifest import Manifest, sha256
from seat_cosim.evaluation.protocol import Protocol, seat_limit
from seat_cosim.evaluation.results import METRICS, Evaluation
from seat_cosim.evaluation.verdict import exceeds_limit, verdict
from seat_cosim.heat_map import HeatMap, draw_heat_maps
from seat_cosim.html_page import embedded, render

PAGE, TABLE, SYSTEM, FIGURE = "evaluation.html", "evaluation.csv", "system.ssp", "seat"
"""Names of the files; the figure's without suffix."""


def write(
    folder: Path,
    evaluations: Sequence[Evaluation],
    protocol: Protocol,
    command: Sequence[str],
    notes: Sequence[str],
) -> list[Path]:
    """Write report, table, figure and system; the same evaluation gives the same bytes on the same machine.

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
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        evaluated.system.save(folder / SYSTEM)
        write_table(folder / TABLE, evaluations)
        figures = [folder / f"{FIGURE}{suffix}" for suffix in (".svg", ".png")]
        draw_heat_maps(figures, [heat_map(each, protocol) for each in evaluations])
        options = RunOptions(protocol.stop_time, record=evaluated.signals.outputs)
        manifest = Manifest.of(evaluated.system, options, command)
        facts = {
            "How it was made": _conditions(evaluations[0], protocol, manifest),
            "What was evaluated": _identity(manifest, sha256(folder / SYSTEM)),
        }
        (folder / PAGE).write_text(_page(evaluations, facts, figures[0], notes), encoding="utf-8")
    return [folder / PAGE, folder / TABLE, *figures, folder / SYSTEM]


def write_table(path: Path, evaluations: Iterable[Evaluation]) -> None:
    """Write all results as CSV; floats read back exactly, and a metric that a system does not have is empty.

    Parameters
    ----------
    path
        The file.
    evaluations
        One after the other, a row for each class and driver.
    """
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        names = [f"{metric.key} ({metric.unit_shown})" if metric.unit_shown else metric.key for metric in METRICS]
        rows.writerow(["system", "class", "driver_mass (kg)", "seat_limit", "runs", *names])
        for evaluation in evaluations:
            title = evaluation.evaluated.title
            for (excitation_class, mass), result in evaluation.results.items():
                known = [title, excitation_class, mass, seat_limit(excitation_class), len(result.rides)]
                numbers = (metric.number(result) for metric in METRICS)
                rows.writerow(["" if value is None else value for value in (*known, *numbers)])


def heat_map(evaluation: Evaluation, protocol: Protocol) -> HeatMap:
    """Return the SEAT of all drivers (rows) on all classes (columns) as a heat map.

    Parameters
    ----------
    evaluation
        Of one system.
    protocol
        Its protocol.
    """
    rows = [[(name, evaluation.results[name, mass]) for name in protocol.classes] for mass in protocol.masses]
    return HeatMap(
        f"SEAT, {evaluation.evaluated.title} (framed: above the limit)",
        [f"{mass:g} kg" for mass in protocol.masses],
        protocol.classes,
        np.array([[result.seat for _, result in row] for row in rows]),
        np.array([[exceeds_limit(name, result) for name, result in row] for row in rows]),
    )


@dataclass(frozen=True)
class _Table:
    """Table of the page: name and unit of each column, and rows with a flag for a SEAT above the limit."""

    title: str
    warnings: Sequence[str]
    heads: Sequence[tuple[str, str]]
    rows: Sequence[tuple[bool, Sequence[str]]]


def _table(evaluation: Evaluation, first: Evaluation) -> _Table:
    """Make the table of an evaluation; one that is compared with shows the change of a_w from it to the first."""
    compared = evaluation is not first
    heads = [("class", ""), ("driver", "kg"), ("limit", "")]
    heads += [(metric.title, metric.unit_shown) for metric in METRICS]
    heads += [("a_w above", "changed by")] if compared else []
    rows = []
    for (excitation_class, mass), result in evaluation.results.items():
        limit = seat_limit(excitation_class)
        row = [excitation_class, f"{mass:g}", "–" if limit is None else f"{limit:.1f}"]
        row += [metric.text(result) for metric in METRICS]
        if compared:
            change = first.results[excitation_class, mass].a_w / result.a_w - 1.0
            row.append(f"{change:+.0%}".replace("-", "−"))
        rows.append((exceeds_limit(excitation_class, result), row))
    return _Table(evaluation.evaluated.title, evaluation.warnings, heads, rows)


def _page(
    evaluations: Sequence[Evaluation], facts: Mapping[str, Mapping[str, str]], figure: Path, notes: Sequence[str]
) -> str:
    first = evaluations[0]
    return render(
        "evaluation/report.html.jinja",
        title=f"Vibration isolation: {first.evaluated.title}",
        verdict=verdict(first),
        notes=notes,
        image=embedded(figure),
        tables=[_table(each, first) for each in evaluations],
        facts=facts,
    )


def _end_stops(travel: float, height: float) -> str:
    """Return where the end stops are met, in words; travel and height in m."""
    if not height:
        return f"at {1e3 * travel:g} mm"
    return f"at {1e3 * (travel - height):g} mm above and {1e3 * (travel + height):g} mm below static equilibrium"


def _conditions(evaluation: Evaluation, protocol: Protocol, manifest: Manifest) -> dict[str, str]:
    """List the conditions of an evaluation, by name."""
    signals = evaluation.evaluated.signals
    travel, height = evaluation.evaluated.end_stop_travel, evaluation.evaluated.end_stop_height
    return {
        "excitation": f"{', '.join(protocol.classes)} (ISO 7096), seeds {', '.join(map(str, protocol.seeds))}",
        "duration": f"{protocol.duration:g} s each, after a warm-up of {protocol.warm_up:g} s",
        "weighting": "Wk of ISO 2631-1, on the floor and where the driver sits",
        "floor": signals.floor_acceleration,
        "driver": signals.seat_acceleration,
        "driver's mass": ", ".join(signals.driver_mass),
        "deflection": signals.suspension_deflection or "none",
        "end stops": "none" if travel is None else _end_stops(travel, height),
        "force": signals.actuator_force or "none",
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
