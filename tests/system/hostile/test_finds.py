"""What the fuzzing has found, each as a case of its own."""

from __future__ import annotations

import io
import json
import math
import struct
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.engine.run_options import RunOptions
from cosim.fmi.archive import open_archive
from cosim.fmi.description import ModelDescription
from cosim.manifest import Manifest
from cosim.results import formats
from fmus.component import Component, ParameterError, state_fields
from plant_models.recording import read
from plant_models.seat.seat import SEAT_PLANT
from plant_models.truck.truck import TRUCK_CAB
from seat_blocks.semi_active_seat import SEMI_ACTIVE_SEAT
from seat_controller_fmu.controller import SEAT_CONTROLLER
from seat_controller_fmu.design import gains
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import edited
from tests.helpers.shell import Shell
from tests.system.hostile.caller import DISCARD, ERROR, OK, Caller
from tests.system.hostile.extracted_fmus import FLAVOURS, Settable, Twin, extracted_fmu
from tests.system.hostile.fmu_properties import Checked, checksummed, saved_states

HUGE = 1.7976931348623157e308


class Bench:
    """Makes instances of FMUs, of any flavour, in this process."""

    def __init__(self, built: Path, folder: Path) -> None:
        self._built, self._folder = built, folder
        self._made: list[Checked] = []

    def __call__(self, flavour: str, name: str) -> Checked:
        found = extracted_fmu(self._built / flavour / f"{name}.fmu", flavour, self._folder)
        self._made.append(Checked(Caller(found.library, self._folder / "calls"), found))
        return self._made[-1]

    def free(self) -> None:
        for checked in self._made:
            checked.free()


@pytest.fixture
def bench(native: Path, fmus: Path, tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(native, tmp_path)
    yield bench
    bench.free()


def variable(checked: Checked, name: str) -> Settable:
    return next(v for v in checked.fmu.settable if v.name == name)


each_flavour = pytest.mark.parametrize("flavour", FLAVOURS)
each_native = pytest.mark.parametrize("flavour", FLAVOURS[:2])

# ---- values and calls ------------------------------------------------------------------------------------------------


@each_flavour
@pytest.mark.parametrize(
    ("model", "name", "output"),
    [("SeatPlant", "floor_displacement", "seat_acceleration"), ("Shaker", "bump.height", "floor_velocity")],
)
def test_outputs_at_the_start_are_numbers(bench: Bench, flavour: str, model: str, name: str, output: str):
    checked = bench(flavour, model)
    checked.set(variable(checked, name), HUGE)
    checked.enter()
    answer = checked.caller.exit()
    assert output in answer.text, answer
    checked.twin.phase = "initialising"
    checked.expect_values()
    checked.set(variable(checked, name), 0.1)  # and can still be corrected
    assert checked.exit()


@each_flavour
def test_time_has_an_end(bench: Bench, flavour: str):
    checked = bench(flavour, "Shaker")
    if checked.fmu.library.version == 2:
        checked.setup(1e9)
    checked.enter(1e9)
    checked.exit()
    answer = checked.caller.step(1e9, 0.002)
    assert answer.status == (DISCARD if flavour == "python" else ERROR)
    assert "expected a step that ends within 1" in answer.text


def test_python_instances_refuse_calls_out_of_order(bench: Bench):
    checked = bench("python", "SeatController")
    assert "expected a call while stepping, got one while instantiated" in checked.caller.terminate().text
    assert "expected a call while initializing, got one while instantiated" in checked.caller.exit().text


def test_the_start_time_makes_the_outputs_anew(bench: Bench):
    checked = bench("python", "Shaker")
    checked.expect_values()
    checked.setup(0.4)  # the middle of the bump
    found = checked.caller.get("Real", checked.fmu.outputs["Real"])
    assert found.value[0] == pytest.approx(0.07)


def test_a_python_state_from_before_the_start_time_is_taken(bench: Bench):
    checked = bench("python", "SeatController")
    checked.expect_values()
    checked.setup(-5.0)
    number = checked.caller.get_state().value
    assert checked.caller.set_state(number).text == ""
    checked.begin()
    assert checked.step(-5.0, 0.002)


@each_flavour
def test_nothing_is_set_after_the_end(bench: Bench, flavour: str):
    checked = bench(flavour, "SeatController")
    checked.begin()
    checked.terminate()
    assert not checked.set(variable(checked, "seat_acceleration"), 0.1)


# ---- states ----------------------------------------------------------------------------------------------------------


def spoiled(data: bytes, number: int, value: float) -> bytes:
    """Put a number in its place among those of a state, with the checksum that belongs to it."""
    begin = 64 + 8 * number
    return checksummed(data[:begin] + struct.pack("<d", value) + data[begin + 8 :])


FLAGS = 4
"""Numbers before the variables in a state: three flags and the stop time."""


def _states(component: Component, values: Mapping[str, Sequence[float]]) -> list[tuple[int, float]]:
    """Return the number of fields in a model's state, counted from its first, with values."""
    numbers = [field.path for field in state_fields(component.state) for _ in range(field.length or 1)]
    return [(numbers.index(path), value) for path, found in values.items() for value in found]


IMPOSSIBLE = {
    "SeatPlant": _states(
        SEAT_PLANT,
        {
            "actuator.line_length": (1.0, 2.5, 258.0, -2.0, 1e300, math.nan),
            "masses.seat_displacement": (math.inf,),
        },
    ),
    "SeatController": _states(
        SEAT_CONTROLLER,
        {
            "next_sample": (-1e12, 1e12, math.nan),
            "robust.place": (1.0, -1.0, 0.5, 1e300),
            "robust.line_length": (2.0, -2.0, 1e300),
            "robust.faults.fault": (0.0, 2.5, 11.0),
        },
    ),
    "TruckCab": _states(
        TRUCK_CAB,
        {
            "start": (1e12, -1e12, math.nan),
            "front.cell": (1e12, -2.0, math.nan),
            "rear.cell": (1e12, 3e4),
            "displacements": (math.inf,),
        },
    ),
    "SemiActiveSeat": _states(SEMI_ACTIVE_SEAT, {"law.next_sample": (1e12, math.nan), "damping": (-1.0, math.nan)}),
}
"""What no instance can have: the seat's line_length, which was an index; the controller's next sample, which was the
begin of a loop, its place in a delay line, and its fault; the truck's cells, which are the end of a loop."""


@each_native
@pytest.mark.parametrize(
    ("model", "number", "value"), [(model, *case) for model, cases in IMPOSSIBLE.items() for case in cases]
)
def test_a_true_checksum_does_not_make_a_state(bench: Bench, flavour: str, model: str, number: int, value: float):
    checked = bench(flavour, model)
    stepping = saved_states(checked)[2]
    first = FLAGS + 1 + max(v.reference for v in checked.fmu.settable)
    answer = checked.caller.from_bytes(spoiled(stepping, first + number, value))
    assert (answer.status, answer.value) == (ERROR, None)
    assert "expected a state of" in answer.text
    (before,) = struct.unpack_from("<d", stepping, 64 + 8 * (first + number))
    assert checked.caller.from_bytes(spoiled(stepping, first + number, before)).status == OK


@each_native
def test_the_noise_of_a_state_is_near_its_time(bench: Bench, flavour: str):
    checked = bench(flavour, "Shaker")
    checked.set(variable(checked, "profile"), 4)
    checked.begin()
    data = checked.saved()
    first = FLAGS + 1 + max(v.reference for v in checked.fmu.settable)
    assert checked.caller.from_bytes(spoiled(data, first, 400.0)).status == OK
    assert checked.caller.from_bytes(spoiled(data, first, -1e12)).status == ERROR  # 1e12 ticks to the next step


@each_native
@pytest.mark.parametrize(("flag", "value"), [(0, 0.5), (0, 4.0), (1, 0.5), (2, -1.0), (2, math.nan)])
def test_flags_of_a_state_are_flags(bench: Bench, flavour: str, flag: int, value: float):
    checked = bench(flavour, "SeatController")
    assert checked.caller.from_bytes(spoiled(checked.saved(), flag, value)).status == ERROR


@each_native
def test_texts_of_a_state_end(bench: Bench, flavour: str):
    checked = bench(flavour, "Shaker")
    data = checked.saved()
    begin = data.index(variable(checked, "file.path").start.encode())
    endless = data[:begin] + b"x" * (len(data) - begin)
    assert checked.caller.from_bytes(checksummed(endless)).status == ERROR


@each_native
def test_a_state_that_cannot_be_restored_leaves_the_instance_as_it_was(bench: Bench, flavour: str, tmp_path: Path):
    checked = bench(flavour, "Shaker")
    path = tmp_path / "floor.csv"
    path.write_text("\n".join(["time,displacement", *(f"{0.01 * k:g},0" for k in range(12))]))
    checked.set(variable(checked, "profile"), 5)
    checked.set(variable(checked, "file.path"), str(path).encode())
    checked.begin()
    number = checked.caller.get_state().value
    checked.caller.reset()
    checked.twin = Twin(checked.fmu)
    checked.begin()
    checked.step(0.0, 0.1)
    path.unlink()
    checked.refused(lambda: checked.caller.set_state(number), "floor.csv")
    assert checked.step(0.1, 0.1)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda state: state.clear(),
        lambda state: state.pop("phase"),
        lambda state: state.update(state=[]),
        lambda state: state.update(state=None, phase="stepping"),
        lambda state: state.update(values=[]),
        lambda state: state.update(time=1e300),
        lambda state: state.update(faults=[]),
        lambda state: state["values"].__setitem__(9, 1e9),
        lambda state: state["state"].__setitem__(0, -1e12),
    ],
)
def test_python_states_may_be_anything(bench: Bench, spoil):
    checked = bench("python", "SeatController")
    checked.begin()
    state = json.loads(checked.saved())
    spoil(state)
    number = checked.caller.from_bytes(json.dumps(state).encode()).value
    answer = checked.caller.set_state(number)
    assert answer.status == OK  # which pythonfmu says; the next step does not
    assert "state: expected one of SeatController" in answer.text
    assert checked.caller.step(0.0, 0.002).status == DISCARD
    assert checked.caller.step(0.0, 0.002).status == OK


@each_native
def test_refused_states_leave_no_memory_behind(bench: Bench, flavour: str):
    checked = bench(flavour, "SeatPlant")
    data = checked.saved()
    calls = [("from_bytes", data[:-1]), ("from_bytes", data + b"x"), ("from_bytes", spoiled(data, 0, math.nan))]
    checked.caller.repeat(100, calls)
    before = checked.caller.memory().value
    checked.caller.repeat(300, calls)
    assert checked.caller.memory().value - before < 100 * len(data)  # a leak would be 900 times that


# ---- descriptions and systems ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('name="random" value="4"', 'value="4"'),
        ('name="random" value="4"', 'name="random" value="four"'),
        ('name="random" value="4"', 'name="random"'),
        ('min="1e-09"', 'min="little"'),
        ('min="1e-09"', 'min="nan"'),
        ('stepSize="0.002"', 'stepSize="short"'),
        ('modelIdentifier="Shaker"', 'modelIdentifier="../Shaker"'),
        ('modelIdentifier="Shaker"', 'modelIdentifier="/lib/Shaker"'),
        ("<fmiModelDescription", '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><fmiModelDescription'),
    ],
)
def test_what_a_description_says_is_looked_at_as_it_is_read(native: Path, tmp_path: Path, old: str, new: str):
    with pytest.raises(SetupError, match=r"it\.fmu.*: expected"):
        ModelDescription.read(edited(native / "fmi2" / "Shaker.fmu", tmp_path / "it.fmu", (old, new)))


@pytest.mark.parametrize(
    "read_it", [ModelDescription.read, System.load, lambda p: formats.read_table(p.with_suffix(".csv"))]
)
def test_a_name_that_no_file_can_have_is_that_of_none(read_it, tmp_path: Path):
    with pytest.raises(SetupError, match="got no such file"):
        read_it(tmp_path / ("x" * 300))


def test_archives_whose_members_share_their_bytes_are_seen_through(tmp_path: Path):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a", bytes(5 * 2**20))
    data = packed.getvalue()
    begin = data.index(b"PK\x01\x02")
    end = data.index(b"PK\x05\x06")
    entry = data[begin:end]
    entries = b"".join(entry[:46] + bytes([name]) + entry[47:] for name in range(97, 123))
    tail = struct.pack("<4sHHHHIIH", b"PK\x05\x06", 0, 0, 26, 26, len(entries), begin, 0)
    path = tmp_path / "shared.zip"
    path.write_bytes(data[:begin] + entries + tail)
    with pytest.raises(SetupError, match="expected at most 200 times the packed size"):
        open_archive(path, path)


def test_a_system_names_its_file_in_each_problem(tmp_path: Path):
    space = "http://ssp-standard.org/SSP1/SystemStructureDescription"
    ssd = f'<SystemStructureDescription xmlns="{space}" version="1.0" name="s">'
    ssd += '<System name="s"><Elements><Component name="c" source="nowhere.fmu"/></Elements></System>'
    (tmp_path / "it.ssd").write_text(f"{ssd}</SystemStructureDescription>")
    with pytest.raises(SetupError, match=r"it\.ssd: .*nowhere\.fmu: expected an FMU"):
        System.load(tmp_path / "it.ssd")


# ---- tables, gains, manifests ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["t", "time", "time\n\n", "time,#\n1,2\n"])
@pytest.mark.filterwarnings("error")
def test_tables_without_rows_are_read_in_silence(tmp_path: Path, text: str):
    (tmp_path / "result.csv").write_text(text)
    try:
        formats.read_table(tmp_path / "result.csv")
    except SetupError as error:
        assert "result.csv" in str(error)  # noqa: PT017


def test_nothing_is_a_comment_in_a_table(tmp_path: Path):
    (tmp_path / "result.csv").write_text("time,x\n1,2#3\n")
    with pytest.raises(SetupError, match="expected a CSV table of numbers"):
        formats.read_table(tmp_path / "result.csv")


def test_recordings_have_steps_that_can_be_divided_by(tmp_path: Path):
    path = tmp_path / "floor.csv"
    path.write_text("\n".join(["time,displacement", *(f"{k}e-300,{k % 2}" for k in range(12))]))
    with pytest.raises(ParameterError, match=r"line 3: expected a step of at least 1e-06 s, got 1e-300 s"):
        read(str(path))


@pytest.mark.parametrize("value", ["[" * 100_000, f"[{'9' * 400}, 0]", "[NaN, 0]", "[1e999, 0]", '{"a": 1, "b": 2}'])
def test_gains_are_finite_numbers(tmp_path: Path, value: str):
    content = json.loads(gains.preset("published").to_json())
    path = tmp_path / "gains.json"
    path.write_text(json.dumps({**content, "K1": "here"}).replace('"here"', value))
    with pytest.raises(gains.GainsError, match=r"gains\.json: expected"):
        gains.load(str(path))


@pytest.mark.parametrize("name", [".", "x" * 300, "a\0b"])
def test_gains_come_from_a_file(name: str):
    with pytest.raises(gains.GainsError, match="or a file, got"):
        gains.load(name)


def test_problems_of_a_run_name_its_manifest(native: Path, shell: Shell, tmp_path: Path):
    manifest = Manifest.of(seat_suspension(native / "fmi2"), RunOptions(1.0, parameters={"seat.driver_mass": 70.0}))
    manifest.write(tmp_path)
    changes = {
        "shaker.floor_velocity": "floor_velocity",
        '"stop_time": 1.0': f'"stop_time": {10**400}',
        '"seat.driver_mass": 70.0': f'"seat.driver_mass": {10**400}',
        f'"{native}/fmi2/SeatPlant.fmu"': f'"{"x" * 300}"',
    }
    path = tmp_path / "run.json"
    sound = path.read_text()
    for old, new in changes.items():
        assert old in sound
        path.write_text(sound.replace(old, new))
        code, out, err = shell("rerun", str(path))
        assert (code, out, len(err.splitlines())) == (2, "", 1)
        assert str(path) in err
