"""The controller's force never exceeds its limit: not by a bit, for any input, any parameters, any history.

It is clipped as the last thing that happens to it, so there is nothing to round. Where numbers overflow on the way, the
step of an FMU returns an error and leaves outputs as they were.
"""

from __future__ import annotations

import math

from fmpy.fmi1 import FMICallException
from hypothesis import strategies as st

from cosim.errors import RunError
from fmus.component import ParameterError
from fmus.variables import variables_of
from seat_controller_fmu import controller as kernel
from seat_controller_fmu.interface import Estimator, Inputs, Mode, Parameters
from tests.helpers.driven import Driven
from tests.helpers.searching import examples, fails, for_all

STEP = 0.002
NUMBERS = {v.field: v for v in variables_of(Parameters) if v.type is float}
"""All parameters that are numbers."""


def values(low: float | None, high: float | None, start: float) -> st.SearchStrategy[float]:
    """Anything legal, often something usual."""
    anything = st.floats(low, high, allow_nan=False, allow_infinity=False)
    return st.one_of(st.just(start), st.floats(0.5, 2.0).map(lambda factor: start * factor), anything).filter(
        lambda x: (low is None or x >= low) and (high is None or x <= high)
    )


parameters = st.fixed_dictionaries(
    {field: values(v.minimum, v.maximum, v.start) for field, v in NUMBERS.items()},
    optional={
        "anti_windup": st.booleans(),
        "mode": st.sampled_from(Mode),
        "robust_estimator": st.sampled_from(Estimator),
    },
)
measured = st.one_of(st.floats(-10.0, 10.0), st.floats(allow_nan=False, allow_infinity=False))
histories = st.lists(st.tuples(measured, measured), min_size=1, max_size=30)


def check(given: dict[str, float], history: list[tuple[float, float]], excess: float = 0.0) -> None:
    """Take samples with the kernel; ``excess`` is what somebody adds to the force after it was clipped, in N."""
    p = Parameters(**given)
    try:
        c = kernel.prepare(p)
    except ParameterError:
        return
    state, _ = kernel.initialize(Inputs(), c, 0.0)
    for acceleration, deflection in history:
        state, outputs = kernel.step(state, Inputs(acceleration, deflection), c)
        force = outputs.force + excess
        assert abs(force) <= p.force_limit or math.isnan(force)
        if math.isnan(force):  # the numbers have overflowed: what an FMU refuses
            return
        assert outputs.saturated == (outputs.force != outputs.force_demand)


@examples(100, 4_000)
def test_the_kernels_force_stays_within_any_limit(count: int):
    for_all(count, lambda given, history: check(given, history), given=parameters, history=histories)


def test_a_force_that_is_changed_after_the_limit_is_noticed():
    fails(1000, lambda given, history: check(given, history, 1e-6), given=parameters, history=histories)


# ---- through the FMUs ------------------------------------------------------------------------------------------------


def check_fmu(controller: Driven, given: dict[str, float], history: list[tuple[float, float]]) -> None:
    """Take samples with an FMU; a step that it refuses leaves the outputs as they were."""
    named = {(NUMBERS[field].name if field in NUMBERS else field).replace(".", "__"): x for field, x in given.items()}
    try:
        controller.begin(**named)
    except RunError:
        return
    force, time = [0.0], 0.0
    for acceleration, deflection in history:
        controller.set(seat_acceleration=acceleration, suspension_deflection=deflection)
        try:
            controller.step(time, STEP)
        except FMICallException:
            assert controller.get("force") == force
            return
        time += STEP
        force = controller.get("force")
        assert abs(force[0]) <= given["force_limit"]
    controller.end()


@examples(40, 1_000)
def test_the_fmus_force_stays_within_any_limit(controller: Driven, count: int):
    for_all(count, lambda given, history: check_fmu(controller, given, history), given=parameters, history=histories)
