"""What has to hold of a reader whatever it reads: a result, or the house's one error that names the file."""

from __future__ import annotations

import io
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import astuple, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from cosim import System
from cosim.engine.run_options import RunOptions
from cosim.errors import SetupError, reading
from cosim.fmi.description import ModelDescription
from cosim.manifest import Manifest
from cosim.results import formats
from cosim.results.result import Result
from cosim.ssp import read_parameters
from fmus.component import ParameterError
from plant_models.parameter_sets import path as parameter_set
from plant_models.shaker import replay
from plant_models.shaker.example_recording import example
from seat_controller_fmu.design import gains
from seat_cosim.cli import main as cli
from seat_cosim.scenarios import seat_suspension
from tests.system.hostile import spoiling

ROOT = Path(__file__).parents[3]

TIME_LIMIT = 20
"""How long a file may take to read, in s."""

CORNER, FADE = 0.3, 0.5
"""How recordings are read: corner frequency of the high-pass in Hz, fade in s."""


@dataclass(frozen=True)
class Reader:
    """Something that reads files.

    Attributes
    ----------
    file
        What a file is called.
    valid
        Contents that can be read.
    spoiled
        Draws the contents.
    read
        Takes the file; what it returns does not matter.
    refusals
        What it may raise.
    words
        A command line that takes the file, where there is one: ``FILE`` stands for it.
    """

    file: str
    valid: tuple[bytes, ...]
    spoiled: st.SearchStrategy[bytes]
    read: Callable[[Path], Any]
    refusals: tuple[type[Exception], ...] = (SetupError,)
    words: tuple[str, ...] = ()


def _xml_in(archive: bytes, member: str) -> st.SearchStrategy[bytes]:
    return spoiling.spoiled_archives(archive, {member: spoiling.spoiled_xml})


def load_and_check(path: Path) -> None:
    """Read a system and make all checks that need no FMU loaded; what they refuse is no longer the file's business."""
    system = System.load(path)
    system.notes()
    with suppress(SetupError):
        system.validate(stop_time=1.0, step_size=0.002)


def read_and_use(path: Path) -> None:
    """Read an FMU, and ask all that a system asks of one that it holds."""
    model = ModelDescription.read(path)
    system = System()
    system.add("it", model)
    system.clock(1.0)
    system.notes()
    for name, variable in model.variables.items():
        system.unit(f"it.{name}")
        try:
            system.validate(1.0, parameters={f"it.{name}": variable.start or "1"})
        except SetupError:
            continue
    with tempfile.TemporaryDirectory() as folder:
        model.extract(Path(folder, "extracted"))
        assert [*Path(folder).iterdir()] in ([], [Path(folder, "extracted")])


def rebuild(path: Path) -> None:
    """Read a run.json and build its system again."""
    found = Manifest.read(path)
    with reading(path):
        found.system().validate(record=found.record)


def readers(built: Path, folder: Path) -> dict[str, Reader]:
    """Name all readers.

    Parameters
    ----------
    built
        Holds the FMUs and the systems of them.
    folder
        Where files that belong to the spoiled ones can be put.
    """
    fmu, ssp = built / "fmi3" / "Shaker.fmu", built / "SeatSuspension.ssp"
    with zipfile.ZipFile(ssp) as archive:
        structure = archive.read("SystemStructure.ssd")
        archive.extractall(folder)
    older = built / "fmi2" / "SeatPlant.fmu"
    system = seat_suspension(built / "fmi2")
    manifest = folder / "run.json"
    description = Manifest.of(system, RunOptions(1.0, parameters={"seat.driver_mass": 70.0}))
    description.write(folder)
    set_of_parameters = parameter_set("passive").read_bytes()
    archives = tuple(_small(path) for path in (fmu, older))
    rows = ["time,seat.driver_acceleration,controller.force", *(f"{0.002 * k},{0.1 * k},{-k}.5" for k in range(8))]
    table = "\n".join(rows).encode()
    preset = gains.preset("published").to_json().encode()
    return {
        "ssp": Reader(
            "system.ssp",
            (_small(ssp),),
            _xml_in(_small(ssp), "SystemStructure.ssd"),
            load_and_check,
            words=("simulate", "FILE", "--stop-time", "0.01"),
        ),
        "ssd": Reader(
            "system.ssd",
            (structure,),
            spoiling.spoiled_xml(structure),
            load_and_check,
            words=("simulate", "FILE"),
        ),
        "ssv": Reader(
            "values.ssv",
            (set_of_parameters,),
            spoiling.spoiled_xml(set_of_parameters),
            partial(read_parameters, structure=system),
            words=("run", "bump", "--fmus", str(built), "--parameters", "FILE"),
        ),
        "fmu": Reader(
            "it.fmu",
            archives,
            st.one_of(*(_xml_in(archive, "modelDescription.xml") for archive in archives)),
            read_and_use,
            words=("simulate", str(ssp), "--replace", "seat=FILE"),
        ),
        "gains": Reader(
            "gains.json",
            (preset,),
            spoiling.spoiled_json(preset),
            gains.load,
            (gains.GainsError,),
            words=("run", "bump", "--fmus", str(built), "--gains", "FILE"),
        ),
        "manifest": Reader(
            "run.json",
            (manifest.read_bytes(),),
            spoiling.spoiled_json(manifest.read_bytes()),
            rebuild,
            words=("rerun", "FILE"),
        ),
        "result": Reader("result.csv", (table,), spoiling.spoiled_csv(table), formats.read_table),
        **{name: _table_reader(name, folder) for name in ("parquet", "mdf4")},
        "recording": Reader(
            "floor.csv",
            tuple(recordings()),
            st.one_of(*(spoiling.spoiled_csv(data) for data in recordings())),
            Replayed(folder).compare,
        ),
    }


def _table_reader(name: str, folder: Path) -> Reader:
    """Name the reader of a format whose files a package reads."""
    time = np.linspace(0.0, 0.1, 8)
    written = Result(time, {"seat.x": time**2, "controller.y": -time}, {"seat.x": "m", "controller.y": None})
    with tempfile.TemporaryDirectory(dir=folder) as own:
        path = written.save(Path(own), [name]).with_suffix(formats.FORMATS[name].suffix)
        valid = path.read_bytes()
    return Reader(path.name, (valid,), spoiling.spoiled_bytes(valid), formats.read_table)


def _small(path: Path) -> bytes:
    """Copy an archive without what no reader looks into."""
    found = io.BytesIO()
    with zipfile.ZipFile(path) as archive, zipfile.ZipFile(found, "w") as copy:
        for name in archive.namelist():
            if name.endswith((".xml", ".ssd", ".ssv", ".so", ".fmu")):
                copy.writestr(name, archive.read(name) if not name.endswith(".so") else b"\x7fELF")
    return found.getvalue()


def recordings() -> list[bytes]:
    """Make recordings that can be read, of either quantity."""
    short = "\n".join(example().decode().splitlines()[:120])
    moved = "\n".join(["time,x,displacement", *(f"{0.01 * k:g},0,{0.001 * k * k:g}" for k in range(15))])
    return [short.encode(), moved.encode()]


class Replayed:
    """The two readers of recordings: in C, as the native FMUs have it, and in Python."""

    def __init__(self, folder: Path) -> None:
        sources = [
            "plant_models/recording.c",
            "plant_models/smooth_step.c",
            *(f"plant_models/shaker/{name}.c" for name in ("replay", "profiles")),
        ]
        options = ["-std=c99", "-O1", "-ffp-contract=off", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
        program = folder / "recordings"
        command = [
            "gcc",
            *options,
            "-Iplant_models",
            "-Iplant_models/shaker",
            "-Ifmus",
            "tests/native/recordings.c",
            *sources,
            "-o",
            str(program),
            "-lm",
        ]
        subprocess.run(command, cwd=ROOT, check=True)
        words = [str(program), repr(CORNER), repr(FADE)]
        self._running = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def compare(self, path: Path) -> None:
        """Read in both languages; the same motion to the bit, or the same words."""
        assert self._running.stdin is not None
        assert self._running.stdout is not None
        self._running.stdin.write(f"{path}\n".encode())
        self._running.stdin.flush()
        in_c = self._running.stdout.readline().decode().removesuffix("\n")
        assert in_c, "the program has ended"
        curve, problem = None, ""
        try:
            curve = replay.load(str(path), CORNER, FADE)
        except ParameterError as error:
            problem = str(error)
        if curve is None:
            assert in_c == problem
            raise SetupError(problem)
        numbers = [float.fromhex(word) for word in in_c.split()] if "0x" in in_c else []
        times = _times()
        in_python = [number for time in times for number in astuple(replay.motion(curve, time))]
        assert numbers == in_python, (in_c[:200], in_python[:3])
        assert all(abs(number) < float("inf") for number in in_python)


def _times() -> list[float]:
    """The times at which the C program evaluates a motion."""
    found = [-0.5]
    while found[-1] + 0.0371 < 3.0:
        found.append(found[-1] + 0.0371)
    return found


@contextmanager
def _limited() -> Iterator[None]:
    signal.alarm(TIME_LIMIT)
    try:
        yield
    finally:
        signal.alarm(0)


def reads_or_refuses(reader: Reader, data: bytes, folder: Path, *, with_command: bool = True) -> bool:
    """Have a file read, and refused by its command too if there is one; returns whether it was read.

    Raises
    ------
    AssertionError
        If something is left behind, or the message does not name the file.
    Exception
        Whatever else the reader raises.
    """
    path = folder / reader.file
    path.write_bytes(data)
    before, refusal = _found(folder), None
    try:
        with _limited():
            reader.read(path)
    except reader.refusals as error:
        refusal = str(error)
    assert _found(folder) == before
    if refusal is not None:
        assert reader.file in refusal
        if reader.words and with_command:
            assert _shell(*(word.replace("FILE", str(path)) for word in reader.words)) == (2, 1), refusal
            assert _found(folder) == before
    return refusal is None


def _found(folder: Path) -> set[Path]:
    return {*folder.rglob("*"), *Path(tempfile.gettempdir()).iterdir(), *folder.parent.iterdir()}


def _shell(*words: str) -> tuple[int, int]:
    """Run the command line; returns the exit code and how many lines of errors it printed."""
    printed = io.StringIO()
    stdout, stderr, argv = sys.stdout, sys.stderr, sys.argv
    sys.stdout, sys.stderr, sys.argv = io.StringIO(), printed, ["seat-cosim", *words]
    try:
        with _limited():
            cli.main()
    except SystemExit as end:
        return int(end.code or 0), len(printed.getvalue().splitlines())
    finally:
        sys.stdout, sys.stderr, sys.argv = stdout, stderr, argv
    return -1, 0
