"""Report of an assessment: an HTML page that needs no other file, tables as CSV, JSON, and figures."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim.errors import writing_to
from cosim.manifest import sha256
from cosim.results.csv_file import format_header, format_rows
from seat_cosim.assessment import DATA
from seat_cosim.assessment.figures import RIDE, SPECTRA, SUFFIXES, TRANSMISSIBILITY, draw_figures
from seat_cosim.assessment.numbers import Assessment
from seat_cosim.assessment.tables import EXPOSURE, METRICS, numbers, shown_channels, summary, table_rows
from seat_cosim.html_page import embedded, render

PAGE, TABLE, LINES = "assessment.html", "assessment.csv", "spectra.csv"
"""Names of the files, beside :data:`seat_cosim.assessment.DATA`."""

WEIGHTING_NOTE = (
    "Vertical direction only, weighted with Wk of ISO 2631-1 on floor and seat; the directive takes the worst of three."
)
EXPOSURE_NOTE = "Of {hours:g} h a day of such rides, by Directive 2002/44/EC; a member state uses A(8) or VDV."
COHERENCE_NOTE = (
    "Where the coherence is low, the transmissibility says little: the floor hardly moves, or the seat is not linear."
)


class _Table(NamedTuple):
    title: str
    channels: list[str]
    rows: list[tuple[str, str, list[str]]]
    note: str = ""


class _Figure(NamedTuple):
    title: str
    image: str
    note: str = ""


def write_report(
    folder: Path, assessment: Assessment, command: Sequence[str], *, with_figures: bool = True
) -> list[Path]:
    """Write page, tables, data and figures; the same recording gives the same bytes on the same machine.

    Parameters
    ----------
    folder
        Folder of the files; it is made if it does not exist.
    assessment
        The assessment.
    command
        Words of the command line.
    with_figures
        Whether figures are drawn.

    Returns
    -------
    list of Path
        The files, the page first.

    Raises
    ------
    SetupError
        If the folder cannot be written to.
    """
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for name in (RIDE, SPECTRA, TRANSMISSIBILITY):  # of an earlier assessment, which may have had more
            for suffix in SUFFIXES:
                (folder / f"{name}{suffix}").unlink(missing_ok=True)
        _write_table(folder / TABLE, assessment)
        _write_lines(folder / LINES, assessment)
        figures = draw_figures(folder, assessment) if with_figures else {}
        text = json.dumps({"command": list(command), **as_data(assessment)}, indent=2, ensure_ascii=False)
        (folder / DATA).write_text(text + "\n", encoding="utf-8")
        page = _page(assessment, {name: files[0] for name, files in figures.items()}, command)
        (folder / PAGE).write_text(page, encoding="utf-8")
    drawn = [file for files in figures.values() for file in files]
    return [folder / PAGE, folder / TABLE, folder / LINES, folder / DATA, *drawn]


def as_data(assessment: Assessment) -> dict[str, Any]:
    """Return the assessment for JSON: numbers of the seat, or of the floor without a seat, and those of each channel.

    Parameters
    ----------
    assessment
        The assessment.

    Returns
    -------
    dict
        SI units, hours for daily durations; None for what is not known or infinite.
    """
    recording, factor = assessment.recording, assessment.seat_factor
    return {
        "file": str(recording.path),
        "sha256": sha256(recording.path),
        "rate": recording.rate,
        "duration": recording.duration,
        "parts": len(recording.parts),
        "judged": assessment.main,
        **numbers(assessment, assessment.main),
        "hours": assessment.channels[assessment.main].exposure.hours,
        "seat": None if factor is None else factor.rms,
        "seat_vdv": None if factor is None else factor.vdv,
        "comfort": assessment.channels[assessment.main].comfort,
        "channels": {
            key: {
                "column": recording.channels[key].column,
                "unit": recording.channels[key].unit,
                "rate": recording.channels[key].rate,
                **numbers(assessment, key),
            }
            for key in shown_channels(assessment)
        },
        "notes": list(assessment.notes),
    }


def _write_table(path: Path, assessment: Assessment) -> None:
    """Write all numbers as CSV; floats read back exactly, what is infinite or not known is empty."""
    shown = shown_channels(assessment)
    values = {key: numbers(assessment, key) for key in shown}
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        rows.writerow(["quantity", "unit", *shown])
        for row in (*METRICS, *EXPOSURE):
            found = (values[key][row.key] for key in shown)
            rows.writerow([row.key, row.unit, *("" if value is None else value for value in found)])
        if (factor := assessment.seat_factor) is not None:
            rows.writerow(["seat", "1", "", factor.rms])
            rows.writerow(["seat_vdv", "1", "", factor.vdv])


def _write_lines(path: Path, assessment: Assessment) -> None:
    """Write the lines of spectra and transmissibility as CSV, without that at 0 Hz."""
    spectra, shown = assessment.spectra, shown_channels(assessment)
    names = ["frequency (Hz)", *(f"{key} PSD ((m/s2)2/Hz)" for key in shown)]
    columns = [spectra.densities[shown[0]].frequency[1:], *(spectra.densities[key].density[1:] for key in shown)]
    if (ratio := spectra.transmissibility) is not None:
        names += ["gain", "phase (rad)", "coherence", "relative standard error of the gain"]
        columns += [ratio.gain, np.angle(ratio.ratio), ratio.coherence, ratio.error]
    path.write_text(format_header(names) + format_rows(np.column_stack(columns)), encoding="utf-8", newline="")


def _page(assessment: Assessment, images: dict[str, Path], command: Sequence[str]) -> str:
    recording, shown = assessment.recording, shown_channels(assessment)
    hours = assessment.channels[assessment.main].exposure.hours
    return render(
        "assessment/report.html.jinja",
        title=f"Measured ride: {recording.path.name}",
        summary=summary(assessment),
        tables=[
            _Table("Vibration", shown, _vibration(assessment), WEIGHTING_NOTE),
            _Table(
                "Daily exposure",
                [assessment.main],
                list(table_rows(assessment, EXPOSURE, [assessment.main])),
                EXPOSURE_NOTE.format(hours=hours),
            ),
        ],
        figures=list(_figures(assessment, images)),
        notes=assessment.notes,
        facts=_facts(assessment, command),
    )


def _vibration(assessment: Assessment) -> list[tuple[str, str, list[str]]]:
    rows = list(table_rows(assessment, METRICS, shown_channels(assessment)))
    if (factor := assessment.seat_factor) is not None:
        rows += [("SEAT by a_w", "", ["", f"{factor.rms:.3f}"]), ("SEAT by VDV", "", ["", f"{factor.vdv:.3f}"])]
    return rows


def _figures(assessment: Assessment, images: dict[str, Path]) -> Iterator[_Figure]:
    spectrum = assessment.spectra.densities[assessment.main]
    lines = f"Lines {spectrum.resolution:.3g} Hz apart, the mean of {spectrum.averages:.3g} independent segments."
    texts = {
        RIDE: ("Over time", ""),
        SPECTRA: ("Spectra", lines),
        TRANSMISSIBILITY: ("Transmissibility", COHERENCE_NOTE),
    }
    for name, image in images.items():
        title, note = texts[name]
        yield _Figure(title, embedded(image), note)


def _facts(assessment: Assessment, command: Sequence[str]) -> dict[str, str]:
    """List how the assessment was made, by name."""
    recording = assessment.recording
    parts = "" if len(recording.parts) == 1 else f" in {len(recording.parts)} parts"
    facts = {"file": str(recording.path), "sha256": sha256(recording.path)}
    for key in shown_channels(assessment):
        info = recording.channels[key]
        facts[key] = f"{info.column}, {info.unit or 'm/s2, as no unit is declared'}, {info.rate:.6g} Hz"
    facts |= {
        "duration": f"{recording.duration:.6g} s{parts}, at {recording.rate:.6g} Hz",
        "command": " ".join(command),
        "versions": ", ".join(f"{name} {version(name)}" for name in ("seat-cosim", "numpy", "scipy")),
    }
    return facts
