"""The Shaker FMUs: every profile the same in every flavour, whatever happens to the state in between."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import System
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.versions import instantiate
from seat_cosim.scenarios import SCENARIOS, seat_suspension
from tests.helpers.paths import NATIVE

H = 0.002

PROFILES: dict[str, dict[str, Any]] = {
    "sweep": {"profile": "sweep", "sweep.duration": 5.0},
    "sweep of displacement": {"profile": "sweep", "sweep.mode": "displacement", "sweep.stop_frequency": 0.1},
    **{f"EM{n}": {"profile": "random", "random.class": f"EM{n}", "random.seed": 10 * n} for n in range(1, 10)},
    "file": {"profile": "file"},
    "platform": {"profile": "random", "platform.bandwidth": 12.0, "platform.velocity_limit": 0.1},
    "platform beneath a file": {"profile": "file", "platform.bandwidth": 5.0, "platform.stroke": 0.002},
}


def shaker(folder: Path, flavour: str) -> System:
    system = System()
    system.add("shaker", folder / flavour / "Shaker.fmu")
    return system


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("step", [H, 0.0007])
def test_flavours_agree_to_the_last_bit(fmus: Path, native: Path, profile: str, step: float):
    given = {f"shaker.{name}": value for name, value in PROFILES[profile].items()}
    found = {f: shaker(native, f).simulate(700 * step, step, given) for f in (*NATIVE, "python")}
    assert found["python"].complete
    assert np.abs(found["python"]["shaker.floor_acceleration"]).max() > 1e-4
    for flavour in NATIVE:
        for name, expected in found["python"].values.items():
            assert np.array_equal(found[flavour][name], expected), (flavour, name)


@contextmanager
def two_instances(path: Path, folder: Path) -> Iterator[list[Instance]]:
    model = ModelDescription.read(path)
    model.extract(folder)
    with ExitStack() as stack:
        instances = [instantiate(name, model, folder) for name in ("one", "other")]
        for instance in instances:
            stack.callback(instance.free)
        yield instances


@pytest.mark.parametrize("flavour", [*NATIVE, "python"])
@pytest.mark.parametrize("profile", ["EM7", "file", "platform beneath a file"])
def test_states_continue_bit_identically(fmus: Path, native: Path, flavour: str, profile: str, tmp_path: Path):
    """Back in time, and as bytes in another instance that has had other parameters."""
    with two_instances(native / flavour / "Shaker.fmu", tmp_path) as (one, other):
        model = one.model
        values = {
            name: model.value("shaker", model.elements("shaker", name), value)
            for name, value in PROFILES[profile].items()
        }
        outputs = [v.valueReference for v in model.outputs]

        def step(instance: Instance, k: int) -> list[float]:
            instance.do_step(k * H, H)
            get = instance.fmu.getFloat64 if flavour == "fmi3" else instance.fmu.getReal
            return list(get(outputs))

        fmi3 = flavour == "fmi3"
        for instance, given in ((one, values), (other, {"profile": 2.0, "sine.frequency": 7.0})):
            instance.enter_initialization(Experiment(0.0, 10.0), given)
            instance.exit_initialization()
        for k in range(300):
            step(one, k)
        state = one.fmu.getFMUState() if fmi3 else one.fmu.getFMUstate()
        expected = [step(one, 300 + k) for k in range(50)]
        (one.fmu.setFMUState if fmi3 else one.fmu.setFMUstate)(state)
        assert [step(one, 300 + k) for k in range(50)] == expected
        content = (one.fmu.serializeFMUState if fmi3 else one.fmu.serializeFMUstate)(state)
        restored = (other.fmu.deserializeFMUState if fmi3 else other.fmu.deSerializeFMUstate)(content)
        (other.fmu.setFMUState if fmi3 else other.fmu.setFMUstate)(restored)
        assert [step(other, 300 + k) for k in range(50)] == expected


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_each_scenario_runs_on_the_seat(native: Path, scenario: str):
    result = seat_suspension(native / "fmi2", SCENARIOS[scenario].floor).simulate(
        2.0, H, SCENARIOS[scenario].parameters
    )
    assert result.complete
    assert np.abs(result["seat.driver_acceleration"]).max() > 0.01
