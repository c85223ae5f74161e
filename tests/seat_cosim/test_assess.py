"""``assess``, and ``--recording`` of ``run`` and ``simulate``."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from cosim import Result
from cosim.units import GRAVITY
from tests.helpers.loggers import Ride, clock, comma, ride, text
from tests.helpers.shell import Shell

FILES = {"assessment.html", "assessment.csv", "assessment.json", "spectra.csv"}
FIGURES = {f"{name}.{suffix}" for name in ("ride", "spectra", "transmissibility") for suffix in ("svg", "png")}


@pytest.fixture
def logger(tmp_path: Path) -> Path:
    """A file of 20 s with decimal commas, ms, and gravity on the floor."""
    return text(
        tmp_path / "ride.csv",
        "time [ms];acc_floor [g];acc_seat [m/s²]",
        ride(10_000),
        lambda t, x, y: comma(f"{1e3 * t:.0f};{x / GRAVITY + 1.0:.6f};{y:.5f}"),
        encoding="latin-1",
    )


BARE = ("--no-figures",)
"""Words that save the time of drawing."""

BOTH = ("--floor", "acc_floor", "--seat", "acc_seat")


@pytest.mark.parametrize("scenario", [("bump",), ("random", "--stop-time", "20"), ("sweep", "--stop-time", "15")])
@pytest.mark.parametrize("form", ["csv", "g and ms", "parquet", "mdf4"])
def test_a_simulation_has_the_same_numbers(scenario: tuple[str, ...], form: str, shell: Shell, tmp_path: Path):
    """Those of the run itself, within 0.1 %."""
    formats = ("--format", form) if form in ("parquet", "mdf4") else ()
    code, out, _ = shell("run", *scenario, *formats, "--json", "--compare", "none", "--output", "run")
    assert code == 0
    expected = json.loads(out)["rides"]["this ride"]
    names = {"floor": "shaker.floor_acceleration", "seat": "seat.driver_acceleration"}
    path = tmp_path / "run" / {"parquet": "result.parquet", "mdf4": "result.mf4"}.get(form, "result.csv")
    if form == "g and ms":
        result = Result.read(path)
        rows = Ride(result.time, result[names["floor"]], result[names["seat"]])
        path = text(
            tmp_path / "logger.csv", "t_ms;shaker.floor_acceleration [g];seat.driver_acceleration [mm/s2]", rows,
            lambda t, x, y: comma(f"{1e3 * t:.0f};{x / GRAVITY:.6f};{1e3 * y:.3f}"),
        )  # fmt: skip
    time = "t_ms" if form == "g and ms" else "time"
    options = [f"--{key}={name}" for key, name in names.items()]
    code, out, err = shell("assess", str(path), "--time", time, *options, "--json", *BARE)
    assert (code, "error" in err) == (0, False)
    found = json.loads(out)
    for key in ("a_w", "vdv", "seat", "peak"):
        assert found[key] == pytest.approx(expected[key], rel=1e-3), key


def test_the_folder_holds_page_tables_and_figures(logger: Path, shell: Shell, tmp_path: Path):
    code, out, err = shell("assess", "ride.csv", *BOTH)
    assert code == 0
    assert "contains gravity; the mean of 9.8" in err
    assert "SEAT 0." in out
    folder = tmp_path / "results" / "assess" / "ride"
    assert {path.name for path in folder.iterdir() if path.name[0] != "."} == FILES | FIGURES
    page = (folder / "assessment.html").read_text(encoding="utf-8")
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    for words in ("contains gravity", "SEAT by a_w", "Daily exposure", "semicolons between columns", "2002/44/EC"):
        assert words in page
    data = json.loads((folder / "assessment.json").read_text(encoding="utf-8"))
    table = {row[0]: row[2:] for row in csv.reader((folder / "assessment.csv").open(encoding="utf-8"))}
    assert table["quantity"] == ["floor", "seat"]
    assert [float(cell) for cell in table["a_w"]] == [data["channels"][key]["a_w"] for key in ("floor", "seat")]
    assert float(table["seat"][1]) == data["seat"] < 1.0
    lines = list(csv.reader((folder / "spectra.csv").open(encoding="utf-8")))
    assert [name.partition(" ")[0] for name in lines[0]] == [
        "frequency", "floor", "seat", "gain", "phase", "coherence", "relative",
    ]  # fmt: skip
    assert all(len(row) == 7 for row in lines)


def test_an_assessment_is_repeatable_and_a_second_one_gets_a_folder_of_its_own(
    logger: Path, shell: Shell, tmp_path: Path
):
    folder, found = tmp_path / "results" / "assess" / "ride", []
    for _ in range(2):
        assert shell("assess", "ride.csv", *BOTH, "--quiet")[:2] == (0, "")
        found.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert found[0] == found[1]
    assert shell("assess", "ride.csv", "--seat", "acc_seat", "--quiet", *BARE)[0] == 0
    other = tmp_path / "results" / "assess" / "ride-2"
    assert {path.name for path in other.iterdir() if path.name[0] != "."} == FILES
    code, _, err = shell("run", "bump", "--output", str(other))
    assert code == 2
    assert "got those of seat-cosim assess" in err


def test_the_seat_alone_has_no_seat_factor_and_the_floor_alone_is_judged(logger: Path, shell: Shell):
    found = json.loads(shell("assess", "ride.csv", "--seat", "acc_seat", "--json", *BARE)[1])
    assert (found["judged"], found["seat"], found["seat_vdv"], list(found["channels"])) == (
        "seat",
        None,
        None,
        ["seat"],
    )
    found = json.loads(shell("assess", "ride.csv", "--floor", "acc_floor", "--json", *BARE)[1])
    assert (found["judged"], found["seat"]) == ("floor", None)
    assert found["a_w"] == found["channels"]["floor"]["a_w"]


def test_hours_scale_the_exposure(logger: Path, shell: Shell):
    whole, half = (
        json.loads(shell("assess", "ride.csv", *BOTH, "--hours", hours, "--json", *BARE)[1]) for hours in ("8", "2")
    )
    assert whole["a8"] == pytest.approx(whole["a_w"])
    assert half["a8"] == pytest.approx(whole["a8"] / 2.0)
    assert half["daily_vdv"] == pytest.approx(whole["daily_vdv"] / 4.0**0.25)
    assert half["hours_to_action"] == whole["hours_to_action"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "expected --seat NAME, --floor NAME or both"),
        (("--seat", "acc_saet"), "(did you mean acc_seat"),
        (("--seat", "acc_seat", "--time", "acc_floor"), "expected a unit of time, got g; --time-unit says what it is"),
        (("--seat", "acc_seat", "--unit", "mm"), "expected a unit of acceleration (m/s2), got mm"),
        (("--seat", "acc_seat", "--unit", "furlong"), "expected a unit of acceleration (m/s2), got furlong"),
        (("--seat", "acc_seat", "--floor-unit", "g"), "--floor-unit g: expected with --floor NAME"),
        (("--seat", "acc_seat", "--rate", "500", "--time", "time"), "expected without --time and --time-unit"),
        (("--seat", "acc_seat", "--rate", "100"), "rate: expected at least 160 Hz, as Wk reaches to 80 Hz, got 100"),
        (("--seat", "acc_seat", "--encoding", "klingon"), "expected the name of an encoding"),
        (("--seat", "acc_seat", "--from", "30"), "expected at least 10 samples, got 0"),
        (("--seat", "acc_seat", "--resolution", "0.01"), "expected at least"),
        (("--seat", "acc_seat", "--resolution", "-1"), "resolution"),
    ],
)
def test_wrong_use_is_one_line_and_code_2(words: tuple[str, ...], message: str, logger: Path, shell: Shell):
    code, out, err = shell("assess", "ride.csv", *words)
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1


def test_gaps_are_refused_or_split(shell: Shell, tmp_path: Path):
    data = ride(10_000)
    kept = np.r_[0:4000, 5000:10_000]
    text(
        tmp_path / "gap.csv", "time,acc [m/s2]", Ride(*(column[kept] for column in data)),
        lambda t, x, _: f"{clock(t)},{x:.5f}",
    )  # fmt: skip
    code, _, err = shell("assess", "gap.csv", "--seat", "acc")
    assert code == 2
    assert "got 1: 2.002 s after 7.998 s; choose a part by --from and --to, or use --gaps split" in err
    found = json.loads(shell("assess", "gap.csv", "--seat", "acc", "--gaps", "split", "--json", *BARE)[1])
    assert (found["parts"], found["duration"]) == (2, pytest.approx(18.0))
    page = (Path(found["folder"]) / "assessment.html").read_text(encoding="utf-8")
    assert "18 s in 2 parts" in page


# ---- recordings for the shaker ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["run", "simulate"])
def test_a_recording_drives_the_shaker_and_can_be_repeated(
    command: str, logger: Path, shell: Shell, native: Path, tmp_path: Path
):
    from seat_cosim.scenarios import seat_suspension

    seat_suspension(native / "fmi2").save(tmp_path / "Seat.ssp")
    words = ("run", "file", "--compare", "none") if command == "run" else ("simulate", "Seat.ssp")
    code, out, err = shell(*words, "--recording", "ride.csv", "--channel", "acc_floor", "--output", "out", "--json")
    assert code == 0, err
    data = json.loads(out)
    assert any("contains gravity" in note for note in data["notes"])
    plain = np.loadtxt(tmp_path / "out" / "recording.csv", delimiter=",", skiprows=1)
    assert (tmp_path / "out" / "recording.csv").read_text().startswith("time,acceleration\n")
    result = Result.read(tmp_path / "out" / "result.csv")
    assert result.time[-1] == pytest.approx(plain[-1, 0])
    middle = slice(2500, 7500)  # apart from the fades
    expected = ride(10_000).floor[middle]
    assert np.abs(result["shaker.floor_acceleration"][middle] - expected).max() < 0.02 * np.abs(expected).max()
    logger.unlink()  # the run is repeated from the plain file beside it
    code, out, _ = shell("rerun", "out/run.json")
    assert (code, "the same bytes" in out) == (0, True)


def test_a_displacement_drives_the_shaker(shell: Shell, tmp_path: Path):
    text(tmp_path / "z.csv", "time;z [mm]", ride(5000), lambda t, x, _: comma(f"{t:.3f};{10.0 * x:.4f}"))
    code, _, err = shell("run", "file", "--recording", "z.csv", "--channel", "z", "--output", "out", "--quiet")
    assert code == 0, err
    assert (tmp_path / "out" / "recording.csv").read_text().startswith("time,displacement\n")
    result = Result.read(tmp_path / "out" / "result.csv")
    np.testing.assert_allclose(result["shaker.floor_displacement"], 0.01 * ride(5000).floor, atol=1e-6)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("bump", "--recording", "ride.csv", "--channel", "acc_floor"), "expected with the scenario file, got bump"),
        (("file", "--recording", "ride.csv"), "expected --channel NAME beside it"),
        (("file", "--channel", "acc_floor"), "--channel: expected with --recording FILE, got without"),
        (("file", "--unit", "g"), "--unit: expected with --recording FILE, got without"),
        (("file", "--recording", "ride.csv", "--channel", "acc"), "(did you mean acc_seat or acc_floor?)"),
        (
            ("file", "--recording", "ride.csv", "--channel", "acc_floor", "--set", "shaker.file.path=ride.csv"),
            "shaker.file.path with --recording: expected one of them, got both",
        ),
        (("file", "--recording", "no.csv", "--channel", "a"), "no.csv: expected a measurement file, got no such file"),
        (
            ("file", "--recording", "ride.csv", "--channel", "acc_floor", "--unit", "N"),
            "expected a unit of acceleration (m/s2) or displacement (m), got N",
        ),
    ],
)
def test_wrong_recordings_are_one_line_and_code_2(words: tuple[str, ...], message: str, logger: Path, shell: Shell):
    code, out, err = shell("run", *words)
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1
    assert not Path("results").exists()


def test_a_system_without_a_shaker_plays_no_recording(logger: Path, shell: Shell, native: Path, tmp_path: Path):
    from cosim import System

    system = System()
    system.add("seat", native / "fmi2" / "SeatPlant.fmu")
    system.save(tmp_path / "Seat.ssp")
    code, _, err = shell("simulate", "Seat.ssp", "--recording", "ride.csv", "--channel", "acc_floor")
    assert code == 2
    assert "--recording: expected a system with one Shaker, which plays it, got none" in err
