"""Options of commands that read measurement files: columns, units and form of the file."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from cosim.engine.structure import Structure
from cosim.errors import SetupError, listed
from cosim.fmi.values import Value
from cosim.recordings.requests import ClockRequest, ReadOptions, TextOptions
from seat_cosim.cli.effect import is_given, spelling
from seat_cosim.scenarios import FMUS, components_of

if TYPE_CHECKING:
    from seat_cosim.measured import FloorRecording

Command = TypeVar("Command", bound=Callable[..., Any])

RECORDING = "recording.csv"
"""Name of the file that the shaker reads, beside the results."""

_SEPARATORS = {"semicolon": ";", "comma": ",", "tab": "\t", "stroke": "|", "blank": " "}

_OPTIONS = (
    click.option("--unit", metavar="UNIT", help="Of the values, such as g or m/s2; wins [default: the file's]."),
    click.option("--time", "time_name", metavar="NAME", help="Column of times [default: the one that is named so]."),
    click.option("--time-unit", metavar="UNIT", help="Of the times, such as ms; wins [default: the file's]."),
    click.option("--rate", type=float, metavar="HZ", help="Sampling rate of a file without times."),
    click.option("--from", "start", type=float, metavar="S", help="Use the recording from here [default: its begin]."),
    click.option("--to", "stop", type=float, metavar="S", help="Use the recording up to here [default: its end]."),
    click.option(
        "--separator", type=click.Choice(list(_SEPARATORS)), help="Between columns of text [default: found in it]."
    ),
    click.option("--decimal", type=click.Choice(["point", "comma"]), help="In text [default: found in it]."),
    click.option("--encoding", metavar="NAME", help="Of text, such as latin-1 [default: found in it]."),
)


@dataclass(frozen=True)
class ReadingOptions:
    """What a command line says about a measurement file; None where it says nothing.

    Attributes
    ----------
    unit
        Unit of the values.
    time_name, time_unit, rate
        Column and unit of the times, or the sampling rate in Hz.
    start, stop
        Time from the first sample from which, and to which, samples are used, in s.
    separator, decimal, encoding
        Form of a text file, in the words of the options.
    """

    unit: str | None = None
    time_name: str | None = None
    time_unit: str | None = None
    rate: float | None = None
    start: float | None = None
    stop: float | None = None
    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None

    def read_options(self, gaps: str = "error") -> ReadOptions:
        """Return the options of the reader.

        Parameters
        ----------
        gaps
            ``error`` or ``split``.
        """
        decimal = {None: None, "point": ".", "comma": ","}[self.decimal]
        separator = None if self.separator is None else _SEPARATORS[self.separator]
        return ReadOptions(
            ClockRequest(self.time_name, self.time_unit, self.rate),
            TextOptions(separator, decimal, self.encoding),
            "split" if gaps == "split" else "error",
            self.start,
            self.stop,
        )


def reading_options(command: Command) -> Command:
    """Give a command the options of measurement files, as one argument ``reading``, a :class:`ReadingOptions`."""

    @functools.wraps(command)
    def with_reading(**arguments: Any) -> Any:
        given = {field.name: arguments.pop(field.name) for field in fields(ReadingOptions)}
        return command(reading=ReadingOptions(**given), **arguments)

    decorated: Any = with_reading
    for option in reversed(_OPTIONS):
        decorated = option(decorated)
    return decorated  # type: ignore[no-any-return]


_RECORDING_OPTIONS = (
    click.option(
        "--recording",
        "recording_file",
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="Measured motion of the floor: text, MDF4, MAT or Parquet of a logger; see also the options below.",
    ),
    click.option("--channel", metavar="NAME", help="Its acceleration or displacement, by the name of the column."),
)


def recording_options(command: Command) -> Command:
    """Give a command ``--recording``, ``--channel`` and the options of measurement files.

    It gets ``recording_file``, ``channel`` and ``reading``.
    """
    decorated: Any = reading_options(command)
    for option in reversed(_RECORDING_OPTIONS):
        decorated = option(decorated)
    return decorated  # type: ignore[no-any-return]


def read_recording(recording_file: Path | None, channel: str | None, reading: ReadingOptions) -> FloorRecording | None:
    """Read the recording of the floor that the options name.

    Parameters
    ----------
    recording_file, channel, reading
        The options.

    Returns
    -------
    FloorRecording or None
        None without ``--recording``.

    Raises
    ------
    SetupError
        If an option is given without what it needs, or the file cannot be used.
    """
    if recording_file is None:
        names = ["channel", *(field.name for field in fields(ReadingOptions))]
        given = [spelling(name) for name in names if is_given(name)]
        if given:
            raise SetupError(*(f"{option}: expected with --recording FILE, got without" for option in given))
        return None
    if channel is None:
        raise SetupError(f"--recording {recording_file}: expected --channel NAME beside it; #2 is the second column")
    from seat_cosim.measured import read_floor  # takes long to load

    return read_floor(recording_file.expanduser(), channel, reading.unit, reading.read_options())


def read_scenario(
    scenario: str, recording_file: Path | None, channel: str | None, reading: ReadingOptions
) -> FloorRecording | None:
    """Read the recording of the scenario ``file``.

    Parameters
    ----------
    scenario
        Name of the scenario.
    recording_file, channel, reading
        The options.

    Returns
    -------
    FloorRecording or None
        None without ``--recording``.

    Raises
    ------
    SetupError
        As :func:`read_recording`, and if it is another scenario.
    """
    if recording_file is not None and scenario != "file":
        raise SetupError(f"--recording {recording_file}: expected with the scenario file, got {scenario}")
    return read_recording(recording_file, channel, reading)


def shaker_of(system: Structure) -> str:
    """Return the name of the component that plays a recording.

    Parameters
    ----------
    system
        The system.

    Raises
    ------
    SetupError
        If it has no Shaker, or several.
    """
    found = components_of(system, FMUS["shaker"])
    if len(found) != 1:
        got = f"{len(found)}, {listed(found)}" if found else "none"
        raise SetupError(f"--recording: expected a system with one Shaker, which plays it, got {got}")
    return found[0]


def play(shaker: str, path: Path, parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Return the parameters of a shaker that plays a recording.

    Parameters
    ----------
    shaker
        Name of the component.
    path
        The file that it reads.
    parameters
        Parameters that are given otherwise.

    Returns
    -------
    dict
        ``component.variable`` to value.

    Raises
    ------
    SetupError
        If they name another recording.
    """
    name = f"{shaker}.file.path"
    if name in parameters:
        raise SetupError(f"{name} with --recording: expected one of them, got both")
    return {f"{shaker}.profile": "file", name: str(path.resolve())}
