"""Report of the reproduction: an HTML page that needs no other file, and the files of each figure and table."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from cosim.results.csv_file import format_header, format_rows
from seat_cosim.html_page import embedded, render
from seat_cosim.paper.contents import CONTENTS, Entry
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.plotting import draw

PAGE = "index.html"

_WIDTH = 4.8
"""Width of the figures in inches: letters are legible on a phone, and no larger than the text on a desktop."""

_TITLE = "An active seat suspension, figure by figure"
_PREFACE = (
    "Every figure and table with numbers of “Disturbance observer based Takagi-Sugeno fuzzy control for an active seat "
    "suspension” (Ning, Sun, Zhang, Du, Li, Zhang), reproduced with components for co-simulation: shaker, seat and "
    "controller are FMUs, run by a master at 500 Hz. No result is computed from the models in any other way.",
    "The paper's figures are not reprinted; its numbers stand beside ours, with one sentence on each difference. Ours "
    "are of four kinds:",
)
_MEANINGS = {
    Kind.GIVEN: "an input, not a result.",
    Kind.SIMULATED: "the paper's own equations and parameters; nothing is fitted.",
    Kind.FITTED: "what nobody published (passive seat, excitation, the prototype's imperfections) was chosen so that "
    "this number fits: agreement proves nothing.",
    Kind.PREDICTED: "of the same choices, where they were not fitted: this is the test.",
}


def write(folder: Path, findings: Sequence[Finding], progress: Callable[[str], None] = lambda text: None) -> Path:
    """Write the page, and a CSV file for each entry, with PNG and SVG for each figure.

    Parameters
    ----------
    folder
        Folder of the files; it exists.
    findings
        From :func:`seat_cosim.paper.experiments.findings`.
    progress
        Called with a description of the progress.

    Returns
    -------
    Path
        The page.
    """
    items = _items(findings)
    images = {}
    for entry, finding in items:
        if finding.panels:
            progress(f"drawing {entry.number}")
            images[entry.key] = _draw(folder, entry, finding)
        _write_csv(folder / f"{entry.key}.csv", finding)
    page = folder / PAGE
    page.write_text(_page(items, images), encoding="utf-8")
    return page


def write_entry(folder: Path, entry: Entry, finding: Finding) -> list[Path]:
    """Write the CSV file of one entry, with PNG and SVG of a figure.

    Parameters
    ----------
    folder
        Folder of the files; it exists.
    entry, finding
        The entry and what was found.

    Returns
    -------
    list of Path
        The files.
    """
    table = folder / f"{entry.key}.csv"
    _write_csv(table, finding)
    if not finding.panels:
        return [table]
    _draw(folder, entry, finding)
    return [table, table.with_suffix(".png"), table.with_suffix(".svg")]


def _draw(folder: Path, entry: Entry, finding: Finding) -> str:
    """Draw a figure as SVG and PNG; returns the address under which the page embeds it."""
    vector = folder / f"{entry.key}.svg"
    title = f"As the paper's {entry.number}: {entry.title}" if entry.in_paper else entry.title
    draw(vector, title, finding.panels, finding.x_label, width=_WIDTH, copies=[vector.with_suffix(".png")])
    return embedded(vector)


def _page(items: Sequence[tuple[Entry, Finding]], images: dict[str, str]) -> str:
    return render(
        "paper/report.html.jinja",
        title=_TITLE,
        preface=_PREFACE,
        meanings=_MEANINGS,
        kinds=list(Kind),
        items=items,
        images=images,
        summary=summary([finding for _, finding in items]),
    )


def _items(findings: Sequence[Finding]) -> list[tuple[Entry, Finding]]:
    entries = {entry.key: entry for entry in CONTENTS}
    return [(entries[finding.key], finding) for finding in findings]


def summary(findings: Sequence[Finding]) -> list[tuple[Kind, list[tuple[Entry, Row]]]]:
    """Return the rows for which the paper prints a number, by kind; inputs are left out.

    Parameters
    ----------
    findings
        From :func:`seat_cosim.paper.experiments.findings`.

    Returns
    -------
    list
        Pairs of a kind and its rows, each with its entry.
    """
    groups = []
    for kind in (Kind.SIMULATED, Kind.FITTED, Kind.PREDICTED):
        rows = [
            (entry, row)
            for entry, finding in _items(findings)
            for row in finding.rows
            if row.kind is kind and any(letter.isdigit() for letter in row.paper)
        ]
        groups.append((kind, rows))
    return groups


def _write_csv(path: Path, finding: Finding) -> None:
    """Write the curves of a figure, or the rows of a table."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        if not finding.panels:
            table = csv.writer(stream, lineterminator="\n")
            table.writerow(["quantity", "unit", "paper", "ours", "kind", "remark"])
            table.writerows([r.quantity, r.unit, r.paper, r.ours, r.kind.value, r.remark] for r in finding.rows)
            return
        columns = _columns(finding)
        stream.write(format_header(list(columns)))
        stream.write(format_rows(np.column_stack(list(columns.values()))))


def _columns(finding: Finding) -> dict[str, np.ndarray]:
    """Return the columns of a figure by name: each axis once, then the curves over it."""
    columns: dict[str, np.ndarray] = {}
    for panel in finding.panels:
        x_label = panel.x_label or finding.x_label
        label = panel.label.replace("\n", " ")
        for curve in panel.curves:
            if curve.x is not None:
                columns[f"{x_label}, {curve.name}"] = curve.x
            else:
                columns[x_label] = panel.x
            columns[f"{label}, {curve.name}"] = curve.values
    return columns
