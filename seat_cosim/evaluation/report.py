"""What is left of an evaluation: a page that opens anywhere, a table, a figure, and the system itself."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import writing_to
from cosim.manifest import Manifest, sha256
from seat_cosim.evaluation.evaluation import COLUMNS, SEAT_LIMITS, SPREAD, Cell, Column, Evaluation, Protocol
from seat_cosim.heat_map import HeatMap, draw_heat_maps
from seat_cosim.html_page import embedded, render

PAGE, TABLE, SYSTEM, FIGURE = "evaluation.html", "evaluation.csv", "system.ssp", "seat"
"""Names of the files; the figure's without suffix."""


def limit(kind: str) -> float | None:
    """Return the largest SEAT that ISO 7096 allows in a class, as recalled; None for a class of another name."""
    return SEAT_LIMITS.get(kind)


def too_high(kind: str, cell: Cell) -> bool:
    """Whether a SEAT is above its limit."""
    bound = limit(kind)
    return bound is not None and cell.seat > bound


def verdict(evaluation: Evaluation) -> str:
    """Say in one line how many rides stay within the limits, and how many runs do not repeat."""
    cells = evaluation.cells
    within = sum(not too_high(kind, cell) for (kind, _), cell in cells.items() if limit(kind) is not None)
    judged = sum(limit(kind) is not None for kind, _ in cells)
    text = f"SEAT within the limit in {within} of {judged} combinations of class and driver"
    loose = [f"{kind} {mass:g} kg" for (kind, mass), cell in cells.items() if not cell.repeats]
    if not loose:
        return f"{text}; all runs within {SPREAD:.0%} of their mean"
    few = min(len(cell.runs) for cell in cells.values()) < 3
    why = "fewer than the three runs of ISO 10326-1" if few else f"runs more than {SPREAD:.0%} from their mean"
    return f"{text}; {why} in {', '.join(loose) if len(loose) <= 6 else f'{len(loose)} of {len(cells)}'}"


def write(
    folder: Path,
    evaluations: Sequence[Evaluation],
    protocol: Protocol,
    command: Sequence[str],
    notes: Sequence[str],
) -> list[Path]:
    """Write all there is to keep; the same evaluation gives the same bytes on the same machine.

    Parameters
    ----------
    folder
        Where to; made if need be.
    evaluations
        First what it is about, then what it is compared with.
    protocol
        How it was made.
    command
        What was typed.
    notes
        What a reader has to know, a sentence each.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    SetupError
        If the folder cannot be written to.
    """
    about = evaluations[0].subject
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        about.system.save(folder / SYSTEM)
        write_table(folder / TABLE, evaluations)
        figures = [folder / f"{FIGURE}{suffix}" for suffix in (".svg", ".png")]
        draw_heat_maps(figures, [heat_map(each, protocol) for each in evaluations])
        manifest = Manifest.of(
            about.system,
            RunOptions(protocol.settle + protocol.duration, record=about.ports.signals),
            command,
        )
        words = {
            "How it was made": _conditions(evaluations[0], protocol, manifest),
            "What was evaluated": _identity(manifest, sha256(folder / SYSTEM)),
        }
        (folder / PAGE).write_text(_page(evaluations, words, figures[0], notes), encoding="utf-8")
    return [folder / PAGE, folder / TABLE, *figures, folder / SYSTEM]


def write_table(path: Path, evaluations: Iterable[Evaluation]) -> None:
    """Write every number of every subject; empty where there is none. Floats read back exactly."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        units = [f"{column.key} ({column.unit})" if column.unit != "1" else column.key for column in COLUMNS]
        rows.writerow(["system", "class", "driver_mass (kg)", "seat_limit", "runs", *units])
        for evaluation in evaluations:
            for (kind, mass), cell in evaluation.cells.items():
                numbers = (column.number(cell) for column in COLUMNS)
                known = [evaluation.subject.title, kind, mass, limit(kind), len(cell.runs)]
                rows.writerow(["" if value is None else value for value in (*known, *numbers)])


def heat_map(evaluation: Evaluation, protocol: Protocol) -> HeatMap:
    """Arrange the SEAT of all rides, drivers below each other."""
    cells = [[(kind, evaluation.cells[kind, mass]) for kind in protocol.classes] for mass in protocol.masses]
    return HeatMap(
        f"SEAT, {evaluation.subject.title} (framed: above the limit)",
        [f"{mass:g} kg" for mass in protocol.masses],
        protocol.classes,
        np.array([[cell.seat for _, cell in row] for row in cells]),
        np.array([[too_high(kind, cell) for kind, cell in row] for row in cells]),
    )


def shown(column: Column, cell: Cell) -> str:
    """Write a number as the tables do."""
    number = column.number(cell)
    return "–" if number is None else f"{number:.{column.digits}f}"


@dataclass(frozen=True)
class _Table:
    """Numbers as the page shows them: names and units of columns, rows that are marked where a SEAT is too high."""

    title: str
    warnings: Sequence[str]
    heads: Sequence[tuple[str, str]]
    rows: Sequence[tuple[bool, Sequence[str]]]


def _table(evaluation: Evaluation, first: Evaluation) -> _Table:
    """Write a row for each ride; what is compared with says how far the first one's a_w is from its own."""
    compared = evaluation is not first
    heads = [("class", ""), ("driver", "kg"), ("limit", "")]
    heads += [(column.title, "" if column.unit == "1" else column.unit) for column in COLUMNS]
    heads += [("a_w above", "changed by")] if compared else []
    rows = []
    for (kind, mass), cell in evaluation.cells.items():
        bound = limit(kind)
        row = [kind, f"{mass:g}", "–" if bound is None else f"{bound:.1f}"]
        row += [shown(column, cell) for column in COLUMNS]
        if compared:
            row.append(f"{first.cells[kind, mass].a_w / cell.a_w - 1.0:+.0%}".replace("-", "−"))
        rows.append((too_high(kind, cell), row))
    return _Table(evaluation.subject.title, evaluation.warnings, heads, rows)


def _page(
    evaluations: Sequence[Evaluation], words: Mapping[str, Mapping[str, str]], figure: Path, notes: Sequence[str]
) -> str:
    first = evaluations[0]
    return render(
        "evaluation/report.html.jinja",
        title=f"Vibration isolation: {first.subject.title}",
        verdict=verdict(first),
        notes=notes,
        image=embedded(figure),
        tables=[_table(each, first) for each in evaluations],
        words=words,
    )


def _conditions(evaluation: Evaluation, protocol: Protocol, manifest: Manifest) -> dict[str, str]:
    ports = evaluation.subject.ports
    travel = evaluation.subject.travel
    return {
        "excitation": f"{', '.join(protocol.classes)} (ISO 7096), seeds {', '.join(map(str, protocol.seeds))}",
        "duration": f"{protocol.duration:g} s each, after {protocol.settle:g} s to settle",
        "weighting": "Wk of ISO 2631-1, on the floor and where the driver sits",
        "floor": ports.floor,
        "driver": ports.seat,
        "driver's mass": ", ".join(ports.driver_mass),
        "deflection": ports.deflection or "none",
        "end stops": "none" if travel is None else f"at {1e3 * travel:g} mm",
        "force": ports.force or "none",
        "step": f"{1e3 * manifest.step_size:g} ms, {manifest.algorithm}, in the order {', '.join(manifest.order)}",
        "command": " ".join(manifest.command),
        "versions": ", ".join(f"{name} {version}" for name, version in manifest.versions.items()),
    }


def _identity(manifest: Manifest, digest: str) -> dict[str, str]:
    rows = {f"{SYSTEM}, sha256": digest}
    for name, component in manifest.components.items():
        rows[name] = f"{component.model}, FMI {component.fmi}, GUID {component.guid}, sha256 {component.sha256}"
    given = ", ".join(f"{name} = {value}" for name, value in manifest.parameters.items())
    return {**rows, "parameters given": given or "none; all others are as the FMUs start"}
