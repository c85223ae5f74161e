"""``seat-cosim assess``: numbers of a measured ride by ISO 2631-1, without any FMU."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import SetupError
from seat_cosim.assessment import DATA
from seat_cosim.cli.console import command_line, console, print_notes, progress_shown
from seat_cosim.cli.folders import choose_folder, force_option
from seat_cosim.cli.outcome import OutputOptions, output_options
from seat_cosim.cli.reading_options import ReadingOptions, reading_options

if TYPE_CHECKING:  # the metrics take long to load
    from seat_cosim.assessment.numbers import Assessment


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE")
@click.option("--floor", metavar="NAME", help="Acceleration of the floor, by the name of its column.")
@click.option("--seat", metavar="NAME", help="Acceleration on the seat, by the name of its column.")
@click.option("--floor-unit", metavar="UNIT", help="Of the floor's values [default: --unit].")
@click.option("--seat-unit", metavar="UNIT", help="Of the seat's values [default: --unit].")
@reading_options
@click.option(
    "--gaps",
    type=click.Choice(["error", "split"]),
    default="error",
    show_default=True,
    help="Refuse gaps, or assess what is between them.",
)
@click.option("--hours", type=float, default=8.0, show_default=True, metavar="H", help="Such rides in a day.")
@click.option("--resolution", type=float, metavar="HZ", help="Of spectra [default: 0.25, coarser for short rides].")
@click.option("--figures/--no-figures", default=True, show_default=True, help="Draw figures.")
@output_options
@force_option
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/assess/FILE].")
def assess(
    file: Path,
    floor: str | None,
    seat: str | None,
    floor_unit: str | None,
    seat_unit: str | None,
    reading: ReadingOptions,
    gaps: str,
    hours: float,
    resolution: float | None,
    figures: bool,
    quiet: bool,
    as_json: bool,
    force: bool,
    output: Path | None,
) -> None:
    """Assess a measured ride: a_w, VDV, MTVV, SEAT, daily exposure, spectra, transmissibility.

    FILE is text (CSV and its relatives), MDF4, MAT up to version 7, or Parquet. Separator, decimal sign, encoding,
    header, units and kind of times are found. Gravity and offsets are subtracted; uneven times are resampled; notes say
    what was done. Writes a page (assessment.html), tables (assessment.csv, spectra.csv), assessment.json and figures.

    \b
    Examples:
      seat-cosim assess ride.csv --time "time [s]" --floor acc_floor --seat acc_seat
      seat-cosim assess ride.mf4 --seat SeatPad_Z --unit g --gaps split --hours 6
      seat-cosim assess logger.txt --rate 512 --seat "#3" --decimal comma
    """
    from seat_cosim.assessment.numbers import assess as compute
    from seat_cosim.assessment.report import PAGE, as_data, write_report
    from seat_cosim.measured import read_ride

    named = {"floor": (floor, floor_unit), "seat": (seat, seat_unit)}
    for key, (name, unit) in named.items():
        if unit is not None and name is None:
            raise SetupError(f"--{key}-unit {unit}: expected with --{key} NAME, got without")
    wanted = {key: (name, unit or reading.unit) for key, (name, unit) in named.items() if name is not None}
    if not wanted:
        raise SetupError(f"{file}: expected --seat NAME, --floor NAME or both; #2 is the second column")
    file = file.expanduser()
    with progress_shown(f"assessing {file.name}") as report:
        report("reading")
        recording = read_ride(file, wanted, reading.read_options(gaps))
        report("numbers")
        assessment = compute(recording, hours, resolution)
        default = Path("results", "assess", file.stem)
        folder = choose_folder(output, default, command_line(), force=force, marker=DATA)
        report("page")
        files = write_report(folder, assessment, command_line(), with_figures=figures)
    if not quiet:
        print_notes(assessment.notes)
    if as_json:
        click.echo(json.dumps({"folder": str(folder), **as_data(assessment)}, indent=2))
    if OutputOptions(quiet, as_json).prints_text:
        _print(assessment)
        others = ", ".join(path.name for path in files if path.name != PAGE)
        console.print(f"{PAGE} and {others} in {folder}", soft_wrap=True)


def _print(assessment: Assessment) -> None:
    """Print the numbers and the main result."""
    from seat_cosim.assessment.report import EXPOSURE_NOTE, WEIGHTING_NOTE
    from seat_cosim.assessment.tables import EXPOSURE, METRICS, shown_channels, summary, table_rows

    shown = shown_channels(assessment)
    for heading, rows, channels in (("", METRICS, shown), ("daily exposure", EXPOSURE, [assessment.main])):
        table = Table(heading, box=SIMPLE)
        for key in channels:
            table.add_column(key, justify="right")
        table.add_column("")
        for title, unit, texts in table_rows(assessment, rows, channels):
            table.add_row(title, *texts, unit)
        console.print(table)
    console.print(f"{summary(assessment)}.")
    console.print(f"- {WEIGHTING_NOTE}")
    console.print(f"- {EXPOSURE_NOTE.format(hours=assessment.channels[assessment.main].exposure.hours)}")
