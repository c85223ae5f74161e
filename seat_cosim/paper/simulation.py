"""Fig. 5-7: the bump (34) under the ideal seat, by the paper's equations and parameters alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosim.metrics import peak, rms
from cosim.results.result import Result
from seat_cosim.paper import bump_test as bump
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.paper.runner import DRIVER, FORCE, LIGHT, ExperimentRunner
from seat_cosim.scenarios import SCENARIOS

_DEMAND = "controller.force_demand"
_ESTIMATE = "controller.disturbance_estimate"
_TITLES = {"uncontrolled": "Uncontrolled", "observer1": "Observer 1", "observer2": "Observer 2"}
_BUMP_END = 0.8
"""Time at which the bump ends, l / v_0, in s."""


def simulated_bump(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Fig. 5 to 7: the bump without control, with Observer 1 and with Observer 2.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    scenario, cases = SCENARIOS["bump"], bump.cases(runner.gammas)
    results = {
        name: runner.run(scenario.stop_time, scenario.parameters, case.parameters) for name, case in cases.items()
    }
    panels = bump.figures(results, cases, LIGHT)
    conditions = (
        "The bump (34), 0.07 m high and 0.8 m long, met at 1 m/s with a 55 kg driver; equations (1)-(2) with the "
        "friction (35)-(36) and the published gains."
    )
    yield Finding("fig05", conditions, list(_accelerations(results)), panels["fig05"])
    yield Finding("fig06", conditions, list(_estimates(results)), panels["fig06"])
    yield Finding("fig07", conditions, list(_forces(results)), panels["fig07"])


def _accelerations(results: dict[str, Result]) -> Iterator[Row]:
    paper = {"uncontrolled": "about 4", "observer1": "lower", "observer2": "lower"}
    remarks = {
        "uncontrolled": "The paper's own equations and friction give 3.2; they give 4.0 with 0.7 times that friction, "
        "and 6.1 with none, so the figure was hardly made with the friction of the appendix.",
        "observer1": "The paper prints no number; the peak falls by more than half.",
        "observer2": "The paper prints no number and calls the two very close, as they are.",
    }
    for name, result in results.items():
        yield _row(f"{_TITLES[name]}, peak", "m/s²", paper[name], peak(result[DRIVER]), remarks[name])
    for name, result in results.items():
        claim = "fades sooner" if name == "observer2" else ""
        remark = "The paper prints no number; a third of that with Observer 1, as it says." if claim else ""
        after = result[DRIVER][result.time >= _BUMP_END]
        yield _row(f"{_TITLES[name]}, RMS after the bump", "m/s²", claim, rms(after), remark, 3)


def _estimates(results: dict[str, Result]) -> Iterator[Row]:
    for name, claim in (("observer1", ""), ("observer2", "bigger peak")):
        value = peak(results[name][_ESTIMATE])
        remark = "The paper prints no number; three times as big, as it says." if claim else ""
        yield _row(f"{_TITLES[name]}, peak estimate", "N", claim, value, remark, 0)
    for name, claim in (("observer1", ""), ("observer2", "follows better")):
        result = results[name]
        free = np.abs(result[_DEMAND] - result[FORCE]) == 0.0
        error = (result[_ESTIMATE] - bump.disturbance(result, LIGHT))[free]
        remark = "The paper prints no number; it follows better, as it says." if claim else ""
        quantity = f"{_TITLES[name]}, RMS error of the estimate while the actuator does not saturate"
        yield _row(quantity, "N", claim, rms(error), remark, 1)


def _forces(results: dict[str, Result]) -> Iterator[Row]:
    for name in ("observer1", "observer2"):
        result = results[name]
        yield _row(f"{_TITLES[name]}, peak force", "N", "250", peak(result[FORCE]), "", 0)
        remark = "So much would be needed without the limit."
        yield _row(f"{_TITLES[name]}, peak demand", "N", "", peak(result[_DEMAND]), remark, 0)


def _row(quantity: str, unit: str, paper: str, value: float, remark: str, digits: int = 2) -> Row:
    return Row(quantity, unit, paper, (value,), Kind.SIMULATED, remark, digits)
