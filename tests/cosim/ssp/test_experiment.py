"""Default experiments: start and stop time, read and written; components that say their type."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.ssp.package import DESCRIPTION
from tests.helpers.shell import Shell
from tests.helpers.ssd_text import component, document, load
from tests.helpers.wild import Var, Wild

pytestmark = pytest.mark.builds


def experiment(attributes: str) -> str:
    return document(component("a"), after=f"<ssd:DefaultExperiment {attributes}/>")


def test_a_system_may_begin_later(gain: Path, tmp_path: Path):
    loaded = load(tmp_path, experiment('startTime="10" stopTime="20"'), gain)
    result = loaded.simulate()
    assert (result.time[0], result.time[-1], len(result.time)) == (10.0, 20.0, 101)
    result = loaded.simulate(stop_time=11.0)
    assert (result.time[0], result.time[-1]) == (10.0, 11.0)


@pytest.mark.parametrize(
    ("attributes", "times"),
    [
        ("", (0.0, 1.0)),
        ('stopTime="2"', (0.0, 2.0)),
        ('startTime="-3"', (-3.0, 1.0)),
        ('startTime="0.5"', (0.5, 1.0)),
        ('startTime="-2" stopTime="-1"', (-2.0, -1.0)),
        ('startTime="" stopTime="0.5"', (0.0, 0.5)),
    ],
)
def test_what_the_system_does_not_say_the_fmus_do(
    gain: Path, tmp_path: Path, attributes: str, times: tuple[float, float]
):
    clock = load(tmp_path, experiment(attributes), gain).clock()
    assert (clock.start_time, clock.stop_time) == times


@pytest.mark.parametrize(
    ("attributes", "problem"),
    [
        (
            'startTime="10" stopTime="5"',
            "stop time: expected .* above the start time, 10 s, got 5",
        ),
        ('startTime="10" stopTime="10"', "above the start time, 10 s, got 10"),
        (
            'startTime="10"',
            "expected one after the start time, 10 s, got none but that of the FMUs' default experiments, 1 s",
        ),
        ('startTime="NaN" stopTime="5"', "start time: expected a finite number of seconds, got nan"),
        ('startTime="0" stopTime="INF"', "stop time: expected a finite number of seconds above 0, got inf"),
    ],
)
def test_times_without_sense_are_refused(gain: Path, tmp_path: Path, attributes: str, problem: str):
    loaded = load(tmp_path, experiment(attributes), gain)
    with pytest.raises(SetupError, match=problem):
        loaded.validate()
    assert loaded.clock(stop_time=20.0, start_time=0.0).stop_time == 20.0


def described(path: Path) -> str:
    with zipfile.ZipFile(path) as archive:
        return archive.read(DESCRIPTION).decode()


@pytest.mark.parametrize("times", [(10.0, 20.0), (0.0, 1.0), (-1.5, None), (None, 2.0), (None, None)])
def test_times_are_written_and_read(gain: Path, tmp_path: Path, times: tuple[float | None, float | None]):
    loaded = load(tmp_path, document(component("a")), gain)
    loaded.start_time, loaded.stop_time = times
    loaded.save(tmp_path / "it.ssp")
    again = System.load(tmp_path / "it.ssp")
    assert (again.start_time, again.stop_time) == (times[0] or 0.0, times[1])
    assert again.clock() == loaded.clock()
    again.save(tmp_path / "again.ssp")
    assert (tmp_path / "again.ssp").read_bytes() == (tmp_path / "it.ssp").read_bytes()


def test_a_start_time_of_the_fmus_is_left_to_them(tmp_path: Path):
    Wild([Var("y")], experiment='startTime="100" stopTime="110" stepSize="1"').build(tmp_path / "Late.fmu")
    loaded = load(tmp_path, document(component("a", "Late.fmu")))
    loaded.save(tmp_path / "it.ssp")
    assert "startTime" not in described(tmp_path / "it.ssp")
    again = System.load(tmp_path / "it.ssp")
    assert (again.start_time, again.clock().start_time, again.clock(stop_time=5.0).start_time) == (None, 100.0, 0.0)


def test_components_are_written_with_their_type(gain: Path, tmp_path: Path):
    loaded = load(tmp_path, document(component("a"), component("b")), gain)
    loaded.save(tmp_path / "it.ssp")
    types = re.findall(r'<ssd:Component name="." type="([^"]*)"', described(tmp_path / "it.ssp"))
    assert types == ["application/x-fmu-sharedlibrary"] * 2


def test_the_command_line_needs_no_stop_time_of_the_system(gain: Path, tmp_path: Path, shell: Shell):
    load(tmp_path, document(component("a")), gain)
    code, out, err = shell("simulate", str(tmp_path / "it.ssd"), "--output", str(tmp_path / "out"))
    assert (code, "11 rows" in out) == (0, True), err
