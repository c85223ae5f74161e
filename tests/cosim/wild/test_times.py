"""Times of a run: start and stop time, default experiments, step sizes that are fixed, tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from cosim import SetupError, System
from cosim.results.result import StepperName
from tests.helpers.hosts import LOOPS
from tests.helpers.wild import Var, Wild, var_in

pytestmark = pytest.mark.builds

FMI = (2, 3)

STRICT = Wild(
    [Var("y", start="0"), Var("stop", start="0"), Var("begin", start="0"), Var("tolerance", start="-1")],
    calculate="""
        m->y[0] = m->run.time; m->stop[0] = m->run.stop_defined ? m->run.stop : -1; m->begin[0] = m->run.start;
        m->tolerance[0] = m->run.tolerance_defined ? m->run.tolerance : -1;
    """,
    advance="""
        if (m->run.stop_defined && time + h > m->run.stop)
            return report(&m->run, ERROR, "step to %.17g past the stop time %.17g", time + h, m->run.stop);
        if (fabs(time - m->run.time) > 1e-9 * fmax(1.0, fabs(time)))
            return report(&m->run, ERROR, "step from %.17g, expected %.17g", time, m->run.time);
    """,
)
"""Refuses a step past its stop time, by one ulp either; tells which times it got."""


@pytest.fixture(scope="module")
def strict(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    return {version: STRICT.build(tmp_path_factory.mktemp("strict") / "strict.fmu", version) for version in FMI}


def alone(fmu: Path) -> System:
    system = System()
    system.add("a", fmu)
    return system


STEP_SIZES = (0.002, 0.1, 1 / 60, 0.0007, 1 / 3)


def stop_time(count: int, step_size: float) -> float:
    """Return the stop time after a number of steps as a user writes it: in decimals where the step size has few."""
    return round(count * step_size, 9) if round(step_size, 4) == step_size else count * step_size


def check_stop_times(fmu: Path, counts: Iterable[int], step_size: float, stepper: StepperName) -> None:
    with alone(fmu).open() as session:
        for count in counts:
            stop = stop_time(count, step_size)
            result = session.run(stop, step_size, record_every=count, stepper=stepper)
            assert result.error is None, result.error
            assert result["a.stop"][-1] >= result["a.y"][-1]
            assert math.isclose(result["a.stop"][-1], stop, rel_tol=1e-12)


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_no_step_ends_past_the_announced_stop_time(strict: dict[int, Path], version: int, step_size: float):
    """A thousand stop times: all of up to 900 steps, and a hundred of up to 40,000, 60 s at 2 ms among them."""
    rng = np.random.default_rng(7)
    counts = [*range(1, 901), *rng.integers(901, 40_000, 99).tolist(), 30_000]
    check_stop_times(strict[version], counts, step_size, "c")


@pytest.mark.parametrize("step_size", STEP_SIZES)
def test_no_step_of_the_loop_in_python_either(strict: dict[int, Path], step_size: float):
    check_stop_times(strict[3], range(1, 101), step_size, "python")


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("start", [10.0, -3.0, 1e6, 0.1])
@pytest.mark.parametrize("stepper", LOOPS)
def test_a_run_begins_at_its_start_time(strict: dict[int, Path], version: int, start: float, stepper: StepperName):
    result = alone(strict[version]).simulate(start + 0.5, 0.01, start_time=start, stepper=stepper)
    assert result.error is None
    assert result.time[0] == start
    np.testing.assert_allclose(result.time, start + 0.01 * np.arange(51), rtol=1e-15)
    assert (result["a.begin"] == start).all()
    np.testing.assert_allclose(result["a.y"], result.time, rtol=1e-15)


def test_rows_of_a_shifted_run_are_those_of_an_isolated_one(strict: dict[int, Path]):
    system = alone(strict[3])
    plain = system.simulate(12.0, 0.01, start_time=10.0)
    isolated = system.simulate(12.0, 0.01, start_time=10.0, isolate=["a"])
    assert all((plain[name] == isolated[name]).all() for name in plain.values)


@pytest.mark.parametrize(
    ("start", "stop", "problem"),
    [
        (2.0, 1.0, "stop time: expected a finite number of seconds above the start time, 2 s, got 1"),
        (1.0, 1.0, "stop time: expected a finite number of seconds above the start time"),
        (math.nan, 1.0, "start time: expected a finite number"),
        (math.inf, 1.0, "start time: expected a finite number"),
        (0.5, 1.005, "stop time: expected a multiple of the step size 0.01 s after the start time, 0.5 s"),
    ],
)
def test_times_that_make_no_sense_are_refused(strict: dict[int, Path], start: float, stop: float, problem: str):
    with pytest.raises(SetupError, match=problem):
        alone(strict[2]).validate(stop, 0.01, start_time=start)


# ---- default experiments ---------------------------------------------------------------------------------------------


def with_experiment(tmp_path: Path, version: int, experiment: str, **more: str) -> System:
    model = Wild(STRICT.variables, STRICT.calculate, STRICT.advance, experiment=experiment, **more)
    return alone(model.build(tmp_path / "experiment.fmu", version))


@pytest.mark.parametrize("version", FMI)
def test_the_default_experiment_of_the_only_fmu_is_the_systems(tmp_path: Path, version: int):
    system = with_experiment(tmp_path, version, 'startTime="100" stopTime="101" stepSize="0.1" tolerance="1e-5"')
    result = system.simulate()
    assert (result.time[0], result.time[-1]) == (100.0, 101.0)
    assert len(result.time) == 11
    assert (result["a.tolerance"] == 1e-5).all()
    assert not [text for text in result.warnings if "starts at" in text]


@pytest.mark.parametrize("version", FMI)
def test_a_run_that_begins_elsewhere_says_so(tmp_path: Path, version: int):
    system = with_experiment(tmp_path, version, 'startTime="100" stopTime="101"')
    result = system.simulate(1.0, 0.1)
    assert result.time[0] == 0.0
    assert "a: its default experiment starts at 100 s, the run at 0 s" in result.warnings


def test_start_times_that_differ_are_reported_for_each(tmp_path: Path, strict: dict[int, Path]):
    system = with_experiment(tmp_path, 2, 'startTime="1" stopTime="5"')
    model = Wild(STRICT.variables, STRICT.calculate, experiment='startTime="2" stopTime="5"')
    (tmp_path / "b").mkdir()
    system.add("b", model.build(tmp_path / "b" / "b.fmu", 3))
    result = system.simulate(step_size=0.5)
    assert (result.time[0], result.time[-1]) == (0.0, 5.0)
    assert [text for text in result.warnings if "starts at" in text] == [
        "a: its default experiment starts at 1 s, the run at 0 s",
        "b: its default experiment starts at 2 s, the run at 0 s",
    ]


@pytest.mark.parametrize("version", FMI)
def test_a_tolerance_of_the_run_goes_to_all_and_is_checked(tmp_path: Path, version: int):
    system = with_experiment(tmp_path, version, 'tolerance="1e-5"')
    assert (system.simulate(1.0, 0.1, tolerance=1e-8)["a.tolerance"] == 1e-8).all()
    assert (with_experiment(tmp_path, version, "").simulate(1.0, 0.1)["a.tolerance"] == -1.0).all()
    for wrong in (0.0, -1e-3, math.nan, math.inf):
        with pytest.raises(SetupError, match="tolerance: expected a finite number above 0"):
            system.validate(1.0, 0.1, tolerance=wrong)


# ---- step sizes ------------------------------------------------------------------------------------------------------

FIXED = 'canHandleVariableCommunicationStepSize="false"'

COUNTS = Wild(
    [Var("steps", start="0"), Var("largest", start="0"), Var("smallest", start="100")],
    calculate="m->steps[0] = m->run.steps;",
    advance="m->largest[0] = fmax(m->largest[0], h); m->smallest[0] = fmin(m->smallest[0], h);",
)


@pytest.mark.parametrize("version", FMI)
@pytest.mark.parametrize("stepper", LOOPS)
@pytest.mark.parametrize("own", [0.01, 0.0005])
def test_an_fmu_with_a_fixed_step_size_steps_by_it(tmp_path: Path, version: int, stepper: StepperName, own: float):
    model = Wild(COUNTS.variables, COUNTS.calculate, COUNTS.advance, interface=FIXED, experiment=f'stepSize="{own}"')
    system = alone(model.build(tmp_path / "fixed.fmu", version))
    result = system.simulate(0.1, 0.002, stepper=stepper)
    assert result["a.steps"][-1] == round(0.1 / own)
    assert (result["a.largest"][-1], result["a.smallest"][-1]) == (pytest.approx(own), pytest.approx(own))
    expected = f"a: steps by {own:g} s, as it cannot handle other communication step sizes"
    assert expected in result.warnings


def test_the_fixed_internal_step_size_of_fmi_3_counts_where_there_is_no_default(tmp_path: Path):
    interface = f'{FIXED} fixedInternalStepSize="0.005"'
    model = Wild(COUNTS.variables, COUNTS.calculate, COUNTS.advance, interface=interface)
    result = alone(model.build(tmp_path / "fixed.fmu", 3)).simulate(0.1, 0.01)
    assert result["a.steps"][-1] == 20


def test_a_fixed_step_size_that_does_not_fit_is_refused(tmp_path: Path):
    model = Wild(COUNTS.variables, COUNTS.calculate, interface=FIXED, experiment='stepSize="0.003"')
    with pytest.raises(SetupError, match=r"a: expected .*0\.003"):
        alone(model.build(tmp_path / "fixed.fmu", 2)).validate(0.1, 0.002)


def test_a_step_size_given_for_the_component_wins(tmp_path: Path):
    model = Wild(COUNTS.variables, COUNTS.calculate, interface=FIXED, experiment='stepSize="0.01"')
    system = alone(model.build(tmp_path / "fixed.fmu", 2))
    system.component_steps["a"] = 0.004
    result = system.simulate(0.1, 0.002, record_every=50)
    assert result["a.steps"][-1] == 25
    assert not [text for text in result.warnings if "communication step sizes" in text]


def test_the_only_fixed_step_size_is_that_of_the_system(tmp_path: Path):
    """Where nothing else is said, the default step size of the only FMU is the communication step size."""
    model = Wild(COUNTS.variables, COUNTS.calculate, interface=FIXED, experiment='stepSize="0.01" stopTime="0.1"')
    system = alone(model.build(tmp_path / "fixed.fmu", 3))
    result = system.simulate()
    assert len(result.time) == 11
    assert not result.warnings


def test_an_input_that_is_fed_by_a_fixed_one_is_held(tmp_path: Path):
    model = Wild(COUNTS.variables, COUNTS.calculate, interface=FIXED, experiment='stepSize="0.01"')
    system = alone(model.build(tmp_path / "fixed.fmu", 2))
    sink = Wild([var_in("u"), Var("y", start="0", depends=("u",))], calculate="m->y[0] = m->u[0];")
    (tmp_path / "b").mkdir()
    system.add("b", sink.build(tmp_path / "b" / "b.fmu", 3))
    system.connect("a.steps", "b.u")
    result = system.simulate(0.04, 0.002)
    assert set(np.diff(result["b.y"])) <= {0.0, 1.0}
    assert result["b.y"][-1] >= 3.0
