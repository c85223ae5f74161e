"""Fig. 8 and 10: transmissibility of the acceleration, floor to seat, by sines in steady state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from cosim.fmi.values import Value
from cosim.metrics import sine_transmissibility
from cosim.metrics.samples import Samples
from seat_cosim.paper.bump_test import Case
from seat_cosim.paper.finding import Finding, Kind, Row
from seat_cosim.paper.runner import FLOOR, RATE, SEAT, SEAT_MEASURED, ExperimentRunner, extent
from seat_cosim.plotting import Curve, Panel

_FREQUENCIES = np.array([1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4, 4.25, 4.5, 5, 5.5, 6, 7, 8.0])
_SQUARES = (2.0 * np.pi * _FREQUENCIES) ** 2
_WARM_UP = 20.0
"""Time until the transient has decayed, in s."""
_PERIODS = 20
"""Number of periods that are evaluated."""
_AMPLITUDE = 1.0
"""Amplitude of the floor's acceleration in the simulation of Fig. 8, in m/s2."""
_LARGER = 2.0
"""A second amplitude, in m/s2; shows how the result depends on it."""
_STROKES = (0.005, 0.010)
"""Amplitudes of the floor for Fig. 10, in m: those of the paper's friction test. The rows are of the first one."""


@dataclass(frozen=True)
class _Response:
    """Ratios over ``_FREQUENCIES``: of the RMS values, with all harmonics, and at the excitation's frequency alone."""

    rms_ratio: Samples
    gain: Samples

    def within(self, low: float, high: float) -> Samples:
        """Return the RMS ratios of a band in Hz, both ends included."""
        return self.rms_ratio[(low <= _FREQUENCIES) & (high >= _FREQUENCIES)]


def _response(
    runner: ExperimentRunner, parameters: Mapping[str, Value], amplitudes: Samples, signal: str = SEAT
) -> _Response:
    """Run sines at all frequencies; ``amplitudes`` of the floor's displacement in m, shape of ``_FREQUENCIES``."""
    found = []
    for frequency, amplitude in zip(_FREQUENCIES.tolist(), amplitudes.tolist(), strict=True):
        sine: dict[str, Value] = {
            "shaker.profile": "sine",
            "shaker.sine.frequency": frequency,
            "shaker.sine.amplitude": amplitude,
        }
        result = runner.run(_WARM_UP + _PERIODS / frequency, sine, parameters, record=[FLOOR, signal])
        found.append(sine_transmissibility(result[FLOOR], result[signal], RATE, frequency, _WARM_UP))
    return _Response(np.array([each.rms_ratio for each in found]), np.array([each.gain for each in found]))


def simulated_transmissibility(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Fig. 8: the ideal seat with and without Observer 1.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    seats = runner.ideal()
    small, large = (
        {name: _response(runner, case.parameters, acceleration / _SQUARES) for name, case in seats.items()}
        for acceleration in (_AMPLITUDE, _LARGER)
    )
    low, gain = small["controlled"].within(1.0, 2.5), small["controlled"].gain[_FREQUENCIES <= 2.5]
    rows = [
        Row(
            "Observer 1, 1 to 2.5 Hz, ratio of RMS values",
            "1",
            "around 0.4",
            extent(low),
            Kind.SIMULATED,
            "Harmonics that friction makes count here; the paper gives neither amplitude nor method.",
        ),
        Row(
            "Observer 1, 1 to 2.5 Hz, fundamental alone",
            "1",
            "around 0.4",
            extent(gain),
            Kind.SIMULATED,
            "What a method that sees the excitation's frequency alone would find.",
        ),
        Row(
            f"Observer 1, 1 to 2.5 Hz, ratio of RMS values at {_LARGER:g} m/s²",
            "1",
            "around 0.4",
            extent(large["controlled"].within(1.0, 2.5)),
            Kind.SIMULATED,
            "Friction weighs less as the amplitude grows.",
        ),
        Row(
            "Observer 1, 1 to 4.5 Hz, largest ratio of RMS values",
            "1",
            "below 1",
            (float(small["controlled"].within(1.0, 4.5).max()),),
            Kind.SIMULATED,
            'As the paper says; "below 4.5 Hz" is the range of its abstract.',
        ),
        Row(
            "Uncontrolled, 1 to 4.5 Hz, ratio of RMS values",
            "1",
            "",
            extent(small["uncontrolled"].within(1.0, 4.5)),
            Kind.SIMULATED,
            f"At {_AMPLITUDE:g} m/s² friction hardly lets the suspension move, and the seat follows the floor; at "
            f"{_LARGER:g} m/s² it breaks loose and resonates.",
        ),
    ]
    panels = [_panel(f"at {_AMPLITUDE:g} m/s²", seats, small, 1.4), _panel(f"at {_LARGER:g} m/s²", seats, large, 3.0)]
    yield Finding(
        "fig08",
        f"Sines of constant floor acceleration, 55 kg, {_PERIODS} periods after {_WARM_UP:g} s; seat over floor. The "
        "seat's motion is no sine, for friction: full and dashed lines are ratios of RMS values, dotted ones of the "
        "fundamental alone.",
        rows,
        panels,
        "Frequency (Hz)",
    )


def rig_transmissibility(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Fig. 10: the seats as calibrated.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    seats = runner.seats()
    del seats["ideal"]
    small, large = (
        {
            name: _response(runner, case.parameters, np.full_like(_FREQUENCIES, stroke), SEAT_MEASURED)
            for name, case in seats.items()
        }
        for stroke in _STROKES
    )
    yield Finding(
        "fig10",
        f"Sines of {1e3 * _STROKES[0]:g} and {1e3 * _STROKES[1]:g} mm of the floor, 55 kg, ratio of RMS values, seat "
        "over floor. The paper gives no amplitude; those of its friction test are taken, the smaller one for the "
        "numbers.",
        list(_rig_rows(small)),
        [
            _panel(f"at {1e3 * stroke:g} mm", seats, found, 1.2, fundamental=False)
            for stroke, found in zip(_STROKES, (small, large), strict=True)
        ],
        "Frequency (Hz)",
    )


def _rig_rows(found: Mapping[str, _Response]) -> Iterator[Row]:
    highest = {name: float(response.rms_ratio.max()) for name, response in found.items()}
    below = found["passive"].within(2.5, 4.5) - found["uncontrolled"].within(2.5, 4.5)
    better = _FREQUENCIES[found["controlled"].rms_ratio > found["passive"].rms_ratio][0]
    yield Row(
        "Controlled, 1 to 4.5 Hz, largest ratio",
        "1",
        "below 1",
        (float(found["controlled"].within(1.0, 4.5).max()),),
        Kind.PREDICTED,
        "As the paper says; it prints no number.",
    )
    yield Row(
        "Controlled, better than the passive seat up to",
        "Hz",
        "4.5",
        (float(better),),
        Kind.PREDICTED,
        "Somewhat further than in the paper, whose amplitude is not given.",
    )
    yield Row(
        "Passive, highest",
        "1",
        "higher than uncontrolled",
        (highest["passive"],),
        Kind.FITTED,
        "The passive seat's friction and the amplitude were chosen so that the order is the paper's.",
    )
    yield Row(
        "Uncontrolled, highest",
        "1",
        "lower than passive",
        (highest["uncontrolled"],),
        Kind.FITTED,
        "Friction holds the seat at this amplitude; at 10 mm it slides, and is the better one from 2 Hz on.",
    )
    yield Row(
        "Passive less uncontrolled, 2.5 to 4.5 Hz",
        "1",
        "lower, very close",
        extent(below),
        Kind.FITTED,
        "Lower up to 4 Hz; above, its damper carries more through than the friction of the uncontrolled seat.",
    )


def _panel(
    what: str,
    seats: Mapping[str, Case],
    found: Mapping[str, _Response],
    top: float,
    *,
    fundamental: bool = True,
) -> Panel:
    curves = [Curve(seats[name].title, each.rms_ratio, seats[name].style) for name, each in found.items()]
    if fundamental:
        curves += [
            Curve(f"{seats[name].title}, fundamental", each.gain, {**seats[name].style, "linestyle": ":"})
            for name, each in found.items()
        ]
    return Panel(f"Transmissibility\n{what}", _FREQUENCIES, curves, {"1": 1.0}, limits=(0.0, top))
