"""Beyond the paper: the simulated bump with anti-windup, with the recommended gains, and in mode robust."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cosim.fmi.values import Value
from cosim.metrics import peak
from cosim.results.result import Result
from seat_cosim.paper.bump_test import Case
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.paper.runner import DRIVER, HEAVY, LIGHT, ExperimentRunner
from seat_cosim.plotting import Curve, Panel
from seat_cosim.scenarios import SCENARIOS, mode, observer

_ANTI_WINDUP: Mapping[str, Value] = {"controller.anti_windup": True}
_REMARKS = {
    "published": "Fig. 5.",
    "anti-windup": "The observer gets the saturated force, so its estimate no longer winds up while the force is at "
    "its limit.",
    "recommended": "One set for all drivers from 45 to 120 kg, certified for delays of 38 ms where the published one, "
    "for 45 to 80 kg, has 24 ms.",
    "robust": "It begins at rest, and the seat goes back to its centre after the bump.",
}


def beyond_the_paper(runner: ExperimentRunner) -> Iterator[Finding]:
    """Run the bump of Fig. 5 with controllers that the paper does not have.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    scenario, cases = SCENARIOS["bump"], _cases(runner)
    results = {
        mass: {
            name: runner.run(scenario.stop_time, scenario.parameters, case.parameters, mass=mass)
            for name, case in cases.items()
        }
        for mass in (LIGHT, HEAVY)
    }
    yield Finding(
        "beyond",
        "The bump (34) and the ideal seat of Fig. 5, Observer 1, 55 kg; and the same with 70 kg.",
        list(_rows(cases, results)),
        [_panel(cases, results[LIGHT])],
    )


def _cases(runner: ExperimentRunner) -> dict[str, Case]:
    published = observer(runner.gammas[1])
    return {
        "published": Case("Observer 1", published, {"color": "C0"}),
        "anti-windup": Case("with anti-windup", {**published, **_ANTI_WINDUP}, {"color": "C2"}),
        "recommended": Case(
            "recommended gains, anti-windup", {**runner.recommended, **_ANTI_WINDUP}, {"color": "C1", "linestyle": "--"}
        ),
        "robust": Case("mode robust", mode("robust", {}), {"color": "C3"}),
    }


def _rows(cases: Mapping[str, Case], results: Mapping[float, Mapping[str, Result]]) -> Iterator[Row]:
    for name, case in cases.items():
        for mass, found in results.items():
            remark = _REMARKS[name] if mass == HEAVY else ""
            quantity = f"{case.title}, {mass:g} kg, peak"
            yield Row(quantity, "m/s²", "", (peak(found[name][DRIVER]),), Kind.SIMULATED, remark)


def _panel(cases: Mapping[str, Case], results: Mapping[str, Result]) -> Panel:
    curves = [Curve(cases[name].title, result[DRIVER], cases[name].style) for name, result in results.items()]
    return Panel("Driver acceleration\n(m/s²)", results["published"].time, curves, {})
