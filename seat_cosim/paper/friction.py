"""Fig. 18 and 19: the friction of the suspension in the testing machine."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from cosim.fmi.values import Value
from cosim.metrics import peak
from cosim.results.result import Result
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.paper.runner import DEFLECTION, DEFLECTION_RATE, FRICTION, RATE, ExperimentRunner
from seat_cosim.plotting import Curve, Panel
from seat_cosim.scenarios import control

_FREQUENCY = 0.5
_AMPLITUDES = {0.005: {"color": "C0"}, 0.010: {"color": "C3"}}
"""Amplitude of the deflection in m, as in the paper, to line style."""
_PERIODS = 3
_CLAMPED: dict[str, Value] = {"seat.seat_mass": 1e9}
"""A seat so heavy that it stays where it is: the floor's motion is the deflection, as between the machine's jaws."""
_REVERSED = 0.9
"""Share of the plateau at which the force counts as reversed."""
_CLOSE_UP = 0.15
"""Distance from the turning point that the figure shows, in mm."""
_CLOSE_UP_SAMPLES = 40
"""Number of samples within it at the smaller amplitude."""


def friction_loops(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Fig. 18 and 19: sines of the deflection, with the seat held and the controller off.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    loops = {amplitude: _last_period(runner, amplitude) for amplitude in _AMPLITUDES}
    seat = "seat.friction."
    alpha, gamma, beta, A = (runner.system.start(seat + name) for name in ("alpha", "gamma", "beta", "A"))
    plateau = alpha * math.sqrt(A / (gamma + beta))
    yield _loops(loops, plateau)
    yield _reversal(loops, plateau)


def _last_period(runner: ExperimentRunner, amplitude: float) -> Result:
    """Run sines of an amplitude in m until the loop is periodic; returns its last period."""
    sine: dict[str, Value] = {
        "shaker.profile": "sine",
        "shaker.sine.frequency": _FREQUENCY,
        "shaker.sine.amplitude": amplitude,
    }
    result = runner.run(_PERIODS / _FREQUENCY, sine, control(False), _CLAMPED)
    first = round((_PERIODS - 1) / _FREQUENCY * RATE)
    return replace(result, time=result.time[first:], values={n: v[first:] for n, v in result.values.items()})


def _loops(loops: Mapping[float, Result], plateau: float) -> Finding:
    """Make Fig. 18: force over deflection and over its rate."""
    rows = [
        Row(
            f"Plateau, {amplitude * 1e3:g} mm",
            "N",
            "around 80",
            (peak(result[FRICTION]),),
            Kind.SIMULATED,
            f"The published parameters give alpha √(A/(gamma+beta)) = {plateau:.1f} N, 6 % less than what the paper "
            "reads off its figure.",
            1,
        )
        for amplitude, result in loops.items()
    ]
    rows += [
        Row(
            f"Deflection reached, {amplitude * 1e3:g} mm",
            "mm",
            f"{amplitude * 1e3:.2f}",
            (1e3 * peak(result[DEFLECTION]),),
            Kind.GIVEN,
            "",
            2,
        )
        for amplitude, result in loops.items()
    ]
    return Finding(
        "fig18",
        "The machine moves the suspension and measures the force; here the floor moves by the same sine under a seat "
        "of a million tonnes, which stays where it is, so the floor's motion is the deflection. The controller is "
        "off; the friction is an output of its own, no spring has to be taken off.",
        rows,
        [
            _panel(loops, DEFLECTION, 1e3, "Deflection (mm)", plateau),
            _panel(loops, DEFLECTION_RATE, 1e3, "Rate of the deflection (mm/s)", plateau),
        ],
    )


def _panel(loops: Mapping[float, Result], signal: str, factor: float, label: str, plateau: float) -> Panel:
    curves = [
        Curve(f"{amplitude * 1e3:g} mm", result[FRICTION], _AMPLITUDES[amplitude], factor * result[signal])
        for amplitude, result in loops.items()
    ]
    end = 1.05 * max(np.abs(curve.x).max() for curve in curves if curve.x is not None)
    return Panel("Friction (N)", np.array([-end, end]), curves, _marks(plateau), label)


def _marks(plateau: float) -> dict[str, float]:
    return {f"±{plateau:.1f} N": plateau, "": -plateau}


def _reversal(loops: Mapping[float, Result], plateau: float) -> Finding:
    """Make Fig. 19: the reversal of the force after the motion has turned."""
    ways, forces = {}, {}
    for amplitude, result in loops.items():
        top = int(result[DEFLECTION].argmax())
        ways[amplitude] = 1e3 * (result[DEFLECTION][top] - result[DEFLECTION][top : top + _CLOSE_UP_SAMPLES])
        forces[amplitude] = result[FRICTION][top : top + _CLOSE_UP_SAMPLES]
    lengths = [float(np.interp(_REVERSED * plateau, -forces[amplitude], way)) for amplitude, way in ways.items()]
    curves = [
        Curve(f"{amplitude * 1e3:g} mm", forces[amplitude], {**_AMPLITUDES[amplitude], "marker": "."}, way)
        for amplitude, way in ways.items()
    ]
    rows = [
        Row(
            f"Way from the turning point until {_REVERSED:.0%} of the plateau",
            "mm",
            "",
            tuple(lengths),
            Kind.SIMULATED,
            "The paper prints no number; the same for both amplitudes, as the model does not depend on the rate.",
            3,
        )
    ]
    return Finding(
        "fig19",
        "The loops of Fig. 18, close to the upper turning point. The paper's measured points are not published, so the "
        "model stands alone here. It is (36) in the usual form of Bouc and Wen: as printed, with |v||z||z|, it has no "
        "plateau for v < 0 and diverges.",
        rows,
        [Panel("Friction (N)", np.array([0.0, _CLOSE_UP]), curves, _marks(plateau))],
        "Way back from the turning point (mm)",
    )
