"""Recorded motion: what comes out of a file, what is wrong with one, the same in Python, in C and through the FMUs."""

from __future__ import annotations

import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cosim import RunError, System
from fmus.component import Component, ParameterError
from fmus.export.native_fmu import STANDARDS, source_files
from plant_models.recording import MAX_LINE_SIZE, MAX_ROWS, MIN_ROWS, read
from plant_models.shaker.example_recording import acceleration, example
from plant_models.shaker.interface import Outputs
from plant_models.shaker.profiles import bump
from plant_models.shaker.replay import Spline, load, motion
from plant_models.shaker.shaker import SHAKER
from plant_models.truck.example_road import example as example_road
from plant_models.truck.truck import TRUCK_CAB
from tests.helpers.paths import NATIVE, ROOT

H = 0.002
CORNER, FADE = 0.1, 0.5


def written(path: Path, quantity: str, t: np.ndarray, x: np.ndarray) -> str:
    rows = "".join(f"{a!r},{b!r}\n" for a, b in zip(t.tolist(), x.tolist(), strict=True))
    path.write_text(f"time,{quantity}\n{rows}", encoding="utf-8")
    return str(path)


def sampled(curve: Spline, t: np.ndarray) -> np.ndarray:
    """Rows of displacement, velocity, acceleration."""
    motions = [motion(curve, time) for time in t.tolist()]
    return np.array([(m.floor_displacement, m.floor_velocity, m.floor_acceleration) for m in motions])


# ---- motions ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [100.0, 333.3, 2000.0])
def test_a_recorded_displacement_is_followed(tmp_path: Path, rate: float):
    """The paper's bump at any rate: the spline's error falls with the fourth power of the step, 3e-6 m at 100 Hz."""
    t = np.arange(0.0, 1.5, 1.0 / rate)
    exact = np.array([(b.floor_displacement, b.floor_velocity) for b in (bump(x, 0.07, 0.8, 1.0) for x in t.tolist())])
    curve = load(written(tmp_path / "bump.csv", "displacement", 100.0 + t, exact[:, 0]), CORNER, FADE)
    found = sampled(curve, t)
    assert np.abs(found[:, 0] - exact[:, 0]).max() < 1e-12
    # its acceleration jumps by 2.2 m/s2 at both ends, which a spline smears over a few samples
    assert np.abs(found[:, 1] - exact[:, 1]).max() < 0.5 * 2.2 / rate
    between = t[:-1] + 0.37 / rate
    expected = [bump(x, 0.07, 0.8, 1.0).floor_displacement for x in between.tolist()]
    assert np.abs(sampled(curve, between)[:, 0] - expected).max() < 0.05 * 2.2 / rate**2


def test_rest_before_and_after_and_time_from_the_first_row(tmp_path: Path):
    t = np.linspace(1e9, 1e9 + 4.0, 401)
    x = 0.05 + 0.01 * np.sin(0.25 * math.pi * (t - t[0])) ** 2 + 0.002 * (t - t[0])
    curve = load(written(tmp_path / "x.csv", "displacement", t, x), CORNER, FADE)
    assert motion(curve, -0.1) == Outputs()
    assert motion(curve, 0.0).floor_displacement == 0.0
    assert motion(curve, 0.0).floor_velocity == pytest.approx(0.0, abs=1e-12)
    after = motion(curve, 4.0)
    assert (after.floor_displacement, after.floor_velocity) == (pytest.approx(0.008), 0.0)
    assert motion(curve, 1e6) == after


@pytest.mark.parametrize(
    ("frequency", "duration", "rate"), [(1.0, 20.0, 200.0), (3.0, 20.0, 500.0), (0.5, 60.0, 100.0)]
)
@pytest.mark.parametrize("corner", [0.0, CORNER])
def test_a_sine_with_a_bias_gives_the_sine_without_drift(
    tmp_path: Path, frequency: float, duration: float, rate: float, corner: float
):
    """Within 0.5 % of the amplitude from fade to fade (2.8 % at 0.5 Hz, near the corner), 0.2 % in the middle half.

    Without removal the bias alone would lead 20 m away in 20 s.
    """
    t = np.arange(0.0, duration + 1e-9, 1.0 / rate)
    omega, amplitude = 2 * math.pi * frequency, 0.01
    recorded = -amplitude * omega**2 * np.sin(omega * t) + 0.1
    found = sampled(load(written(tmp_path / "a.csv", "acceleration", t, recorded), corner, FADE), t)
    off = np.abs(found[:, 0] / amplitude - np.sin(omega * t))
    unfaded = (t > FADE) & (t < duration - FADE)
    middle = (t > 0.25 * duration) & (t < 0.75 * duration)
    assert off[unfaded].max() < (0.028 if frequency < 1.0 else 0.005)
    assert off[middle].max() < 0.002
    assert np.abs(found[:, 2] - recorded + 0.1)[middle].max() < 0.003 * amplitude * omega**2


@pytest.mark.slow
def test_noise_of_a_sensor_does_not_wander_off(tmp_path: Path):
    """White noise of 0.02 m/s2 in ten minutes: integrated twice a walk of metres, high-passed at 0.1 Hz millimetres."""
    t = np.arange(0.0, 600.0, 0.01)
    noise = written(tmp_path / "n.csv", "acceleration", t, np.random.default_rng(3).normal(0.0, 0.02, len(t)))
    walk, calm = (np.abs(load(noise, corner, FADE).displacements).max() for corner in (0.0, CORNER))
    print(f"{walk:.3f} m without, {calm:.4f} m with high-pass")
    assert calm < 0.02 < 0.05 < walk


def test_velocity_and_acceleration_are_the_derivatives(tmp_path: Path):
    (tmp_path / "example.csv").write_bytes(example())
    curve = load(str(tmp_path / "example.csv"), CORNER, FADE)
    times = np.linspace(0.1, 7.9, 200)
    dt = 1e-6
    before, here, after = (sampled(curve, times + shift) for shift in (-dt, 0.0, dt))
    slopes = (after - before) / (2 * dt)
    assert np.abs(slopes[:, :2] - here[:, 1:]).max() < 1e-5
    # continuous at the knots as well
    knots = np.array(curve.times[1:-1])
    assert np.abs(sampled(curve, knots - 1e-9) - sampled(curve, knots)).max() < 1e-5


def test_the_example_is_what_its_sensor_reports_without_the_bias(tmp_path: Path):
    (tmp_path / "example.csv").write_bytes(example())
    times = np.linspace(1.0, 7.0, 500)
    found = sampled(load(str(tmp_path / "example.csv"), CORNER, FADE), times)[:, 2]
    expected = np.array([acceleration(t) for t in times.tolist()]) - 0.05
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.01 * np.sqrt(np.mean(expected**2))


def test_uneven_steps_other_columns_and_endings_do_not_matter(tmp_path: Path):
    random = np.random.default_rng(1)
    t = np.cumsum(random.uniform(0.004, 0.02, 400))
    x = 0.01 * np.sin(4.0 * (t - t[0])) ** 2
    plain = load(written(tmp_path / "plain.csv", "displacement", t, x), CORNER, FADE)
    rows = "".join(f' {b!r} ,,"x y",\t{a!r}\r\n' for a, b in zip(t.tolist(), x.tolist(), strict=True))
    other = tmp_path / "other.csv"
    other.write_bytes(b'\xef\xbb\xbf"displacement", ,note,"time"\r\n' + rows.encode() + b"\r\n \r\n")
    assert load(str(other), CORNER, FADE) == plain
    middle = (t[:-1] + t[1:]) / 2
    expected = 0.01 * np.sin(4.0 * (middle - t[0])) ** 2
    assert np.abs(sampled(plain, middle - t[0])[:, 0] - expected)[3:-3].max() < 1e-6


# ---- what is wrong with a file ---------------------------------------------------------------------------------------

ROWS = [f"{0.01 * k:.2f},{math.sin(k)}" for k in range(20)]


def file_of(*rows: str, header: str = "time,displacement") -> bytes:
    return "\n".join([header, *rows, ""]).encode()


def edited(number: int, row: str) -> bytes:
    """Rows with another one in a line of the file."""
    return file_of(*ROWS[: number - 2], row, *ROWS[number - 1 :])


WRONG = {
    "empty": (b"", "line 1: expected the columns time and one of acceleration, displacement, got nothing"),
    "header": (file_of(*ROWS, header="t;z"), "line 1: expected the columns time and one of .*, got t;z"),
    "both": (file_of(*ROWS, header="time,acceleration,displacement"), "line 1: expected the columns time and one of"),
    "twice": (file_of(*ROWS, header="time,time,displacement"), "line 1: expected the columns time and one of"),
    "binary": (b"\x00\x01\x02\xff" * 10, r"line 1: expected the columns .*, got \?\?\?\?"),
    "nan": (edited(7, "0.05,nan"), r"line 7: expected a number of up to 1e\+12 either way as displacement, got nan"),
    "inf": (edited(7, "0.05,-inf"), "line 7: expected a number .* as displacement, got -inf"),
    "huge": (edited(7, "0.05,1e999"), "line 7: expected a number .* as displacement, got 1e999"),
    "word": (edited(3, "o clock,1"), "line 3: expected a number .* as time, got o clock"),
    "hex": (edited(3, "0x1,1"), "line 3: expected a number .* as time, got 0x1"),
    "comma": (edited(3, "0,01,1"), "line 3: expected 2 columns, got 3"),
    "nothing": (edited(3, "0.01,"), "line 3: expected a number .* as displacement, got nothing"),
    "gap": (
        file_of(*ROWS[:10], *(f"{0.29 + 0.01 * k:.2f},1" for k in range(10))),
        r"line 12: expected a step of at most 10 times the median of 0.01 s, got 0.2 s",
    ),
    "unsorted": (edited(12, "0.05,1"), r"line 12: expected a time above 0.09 s, got 0.05 s"),
    "duplicate": (edited(12, "0.09,1"), r"line 12: expected a time above 0.09 s, got 0.09 s"),
    "few": (file_of(*ROWS[:5]), f"line 6: expected at least {MIN_ROWS} rows, got 5"),
    "hole": (edited(9, ""), "line 9: expected no empty line but at the end, got one"),
    "long": (
        edited(9, "0.07," + "1" * MAX_LINE_SIZE),
        f"line 9: expected at most {MAX_LINE_SIZE} characters, got more",
    ),
    "short": (file_of(*ROWS, header="time,acceleration"), "as long as two fades, 1 s, got 0.19 s"),
}


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., list[str]]:
    """Load recordings in C, watched by sanitizers; a line of text for each."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    program = tmp_path_factory.mktemp("recordings") / "recordings"
    sources = [
        "plant_models/recording.c",
        "plant_models/smooth_step.c",
        *(f"plant_models/shaker/{name}.c" for name in ("replay", "profiles")),
    ]
    options = [
        "-std=c99",
        "-O1",
        "-g",
        "-ffp-contract=off",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ]
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

    def load_all(paths: list[Path], *locale: str) -> list[str]:
        words = [program, repr(CORNER), repr(FADE), *locale]
        text = "".join(f"{path}\n" for path in paths).encode()
        run = subprocess.run(words, input=text, capture_output=True, check=False)
        assert (run.returncode, run.stderr) == (0, b""), run.stderr
        return run.stdout.decode().splitlines()

    return load_all


def in_python(path: Path) -> str:
    """What the C program prints."""
    try:
        curve = load(str(path), CORNER, FADE)
    except ParameterError as error:
        return str(error)
    times, time = [], -0.5
    while time < 3.0:
        times.append(time)
        time += 0.0371
    return "".join(f"{float(x).hex()} " for x in sampled(curve, np.array(times)).ravel())


def same_text(one: str, other: str) -> bool:
    """Whether two results are the same; C and Python write hexadecimal numbers with and without trailing zeros."""
    if one == other:
        return True
    try:
        numbers = [[float.fromhex(word) for word in text.split()] for text in (one, other)]
    except ValueError:
        return False
    return bool(np.array_equal(*numbers, equal_nan=True))


@pytest.mark.parametrize("what", WRONG)
def test_each_fault_gives_a_message_of_one_line(tmp_path: Path, what: str, in_c: Callable[..., list[str]]):
    content, message = WRONG[what]
    path = tmp_path / "record.csv"
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=message) as caught:
        load(str(path), CORNER, FADE)
    assert str(caught.value).startswith(str(path))
    assert in_c([path]) == [str(caught.value)]


def test_unreadable_files_give_a_message(tmp_path: Path, in_c: Callable[..., list[str]]):
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(ParameterError, match="expected a file that can be read, got none") as caught:
            read(str(path))
        assert in_c([path]) == [str(caught.value)]


@pytest.mark.long
def test_a_file_with_too_many_rows_is_refused(tmp_path: Path, in_c: Callable[..., list[str]]):
    path = tmp_path / "large.csv"
    with path.open("w", encoding="utf-8") as stream:
        stream.write("time,displacement\n")
        stream.writelines(f"{k},0\n" for k in range(MAX_ROWS + 1))
    with pytest.raises(ParameterError, match=rf"line {MAX_ROWS + 2}: expected at most {MAX_ROWS} rows, got more") as e:
        read(str(path))
    assert in_c([path]) == [str(e.value)]


def test_c_and_python_agree_on_any_file_to_the_last_bit(tmp_path: Path, in_c: Callable[..., list[str]]):
    """Good files of both kinds, and hundreds with bytes changed, cut out and put in anywhere."""
    random = np.random.default_rng(8)
    t = np.cumsum(random.uniform(0.008, 0.012, 150))
    seeds = [
        Path(written(tmp_path / f"{q}.csv", q, t, random.normal(0.0, 0.1, 150)))
        for q in ("displacement", "acceleration")
    ]
    (tmp_path / "example.csv").write_bytes(example())
    paths = [*seeds, tmp_path / "example.csv"]
    pieces = [
        b",",
        b"\n",
        b"\r",
        b"-",
        b".",
        b"e",
        b"E9",
        b"nan",
        b"0",
        b"9" * 30,
        b"\x00",
        b"\xff",
        b" ",
        b'"',
        b"\n\n",
    ]
    for number in range(400):
        content = bytearray(seeds[number % 2].read_bytes())
        for _ in range(random.integers(1, 4)):
            at = int(random.integers(0, len(content) if random.random() < 0.7 else 40))
            cut = int(random.choice([0, 1, 1, 5, 200]))
            content[at : at + cut] = pieces[random.integers(len(pieces))] if random.random() < 0.8 else b""
        paths.append(tmp_path / f"{number}.csv")
        paths[-1].write_bytes(content)
    found, expected = in_c(paths), [in_python(path) for path in paths]
    assert len(found) == len(expected)
    fine = ["expected" not in text for text in expected]
    assert fine[:3] == [True] * 3
    assert 20 < sum(fine) < 300
    for path, one, other in zip(paths, found, expected, strict=True):
        assert same_text(one, other), (path.read_bytes(), one[:200], other[:200])


@pytest.mark.skipif(shutil.which("localedef") is None, reason="localedef is not installed")
def test_numbers_are_read_in_any_locale(
    tmp_path: Path, in_c: Callable[..., list[str]], monkeypatch: pytest.MonkeyPatch
):
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", str(tmp_path / "german.UTF-8")], check=False)
    if made.returncode:
        pytest.skip("the sources of the German locale are not installed")
    monkeypatch.setenv("LOCPATH", str(tmp_path))
    (tmp_path / "example.csv").write_bytes(example())
    expected = in_c([tmp_path / "example.csv"])
    assert in_c([tmp_path / "example.csv"], "german.UTF-8") == expected
    assert same_text(expected[0], in_python(tmp_path / "example.csv"))


# ---- through the FMUs ------------------------------------------------------------------------------------------------


def shaker(folder: Path, flavour: str) -> System:
    system = System()
    system.add("shaker", folder / flavour / "Shaker.fmu")
    return system


def test_flavours_agree_on_the_example_and_on_a_file_of_ones_own(fmus: Path, native: Path, tmp_path: Path):
    t = np.arange(0.0, 2.0, 0.004)
    path = written(tmp_path / "a folder with ünicode.csv", "displacement", t, 0.01 * np.sin(5.0 * t) ** 2)
    for parameters in ({}, {"shaker.file.path": path}, {"shaker.platform.bandwidth": 8.0}):
        given = {"shaker.profile": "file", **parameters}
        found = {f: shaker(native, f).simulate(2.5, H, given) for f in (*NATIVE, "python")}
        expected = found["python"]
        assert expected.complete
        assert np.abs(expected["shaker.floor_displacement"]).max() > 1e-3
        for flavour in NATIVE:
            for name, values in expected.values.items():
                assert np.array_equal(found[flavour][name], values), (flavour, name, parameters)


@pytest.mark.parametrize("flavour", NATIVE)
def test_a_wrong_file_fails_on_leaving_the_initialisation(native: Path, flavour: str, tmp_path: Path):
    (tmp_path / "gap.csv").write_bytes(WRONG["gap"][0])
    given = {"shaker.profile": "file", "shaker.file.path": str(tmp_path / "gap.csv")}
    with pytest.raises(RunError, match=r"ExitInitializationMode failed .*gap.csv, line 12: expected a step of at most"):
        shaker(native, flavour).simulate(0.1, H, given)
    given["shaker.file.path"] = "no such.csv"  # beside the FMU's example
    with pytest.raises(RunError, match=r"resources/no such.csv: expected a file that can be read, got none"):
        shaker(native, flavour).simulate(0.1, H, given)


def test_a_wrong_file_discards_the_steps_of_the_python_flavour(fmus: Path, tmp_path: Path):
    (tmp_path / "gap.csv").write_bytes(WRONG["gap"][0])
    given = {"shaker.profile": "file", "shaker.file.path": str(tmp_path / "gap.csv")}
    result = shaker(fmus.parent, "python").simulate(0.1, H, given)
    assert not result.complete
    assert "gap.csv, line 12: expected a step of at most 10 times the median" in str(result.error)


@pytest.mark.builds
@pytest.mark.parametrize("flavour", NATIVE)
@pytest.mark.parametrize(
    ("component", "content", "names"),
    [(SHAKER, example(), ("profile", "file.path")), (TRUCK_CAB, example_road(), ("road.profile", "road.file"))],
    ids=["Shaker", "TruckCab"],
)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_the_memory_of_a_recording_is_always_freed(
    component: Component, content: bytes, names: tuple[str, str], flavour: str, tmp_path: Path
):
    sources = source_files(component, STANDARDS[flavour], "{token}")
    for name, text in {**sources, "example.csv": content, "wrong.csv": b"no recording"}.items():
        (tmp_path / name).write_bytes(text)
    compiled = [name for name in sources if name.endswith(".c")]
    compiled += [str(ROOT / "tests/native" / name) for name in (f"api_{flavour}.c", "replaying.c")]
    options = ["-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-I."]
    subprocess.run(["gcc", *options, *compiled, "-o", "replaying", "-lm"], cwd=tmp_path, check=True)
    words = ["./replaying", str(tmp_path / "example.csv"), str(tmp_path / "wrong.csv"), *names]
    run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
