"""Fig. 8 and 10: transmissibility of the acceleration, floor to seat, by sines in steady state."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from cosim.bump import Case
from cosim.figures import Curve, Panel
from cosim.metrics import sine_transmissibility
from cosim.metrics.samples import Samples
from cosim.model import Value
from cosim.paper.finding import Finding, Kind, Row
from cosim.paper.lab import FLOOR, RATE, SEAT, Lab, change, extent

_FREQUENCIES = np.array([1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75, 3, 3.25, 3.5, 3.75, 4, 4.25, 4.5, 5, 5.5, 6, 7, 8.0])
_SETTLE = 20.0
"""s, until the transient has faded."""
_PERIODS = 20
"""How many are looked at."""
_AMPLITUDE = 1.0
"""m/s2, of the floor's acceleration, in the simulation of Fig. 8."""
_LARGER = 2.0
"""m/s2; shows what the amplitude does."""
_EXPERIMENT = 1.5
"""m/s2, in the experiment of Fig. 10."""


@dataclass(frozen=True)
class _Response:
    """Ratios over ``_FREQUENCIES``: of the RMS values, harmonics and all, and of the excitation's frequency alone."""

    rms_ratio: Samples
    gain: Samples

    def within(self, low: float, high: float) -> Samples:
        """Return the RMS ratios of a band in Hz, ends included."""
        return self.rms_ratio[(low <= _FREQUENCIES) & (high >= _FREQUENCIES)]


def _response(lab: Lab, parameters: Mapping[str, Value], amplitude: float) -> _Response:
    """Shake a seat at one frequency after the other with so much acceleration of the floor, in m/s2."""
    found = []
    for frequency in _FREQUENCIES.tolist():
        sine: dict[str, Value] = {
            "shaker.profile": "sine",
            "shaker.sine.frequency": frequency,
            "shaker.sine.amplitude": amplitude / (2.0 * math.pi * frequency) ** 2,
        }
        result = lab.run(_SETTLE + _PERIODS / frequency, sine, parameters)
        found.append(sine_transmissibility(result[FLOOR], result[SEAT], RATE, frequency, _SETTLE))
    return _Response(np.array([each.rms_ratio for each in found]), np.array([each.gain for each in found]))


def simulated_transmissibility(lab: Lab) -> Iterator[Finding]:
    """Make Fig. 8, of the ideal seat with and without Observer 1."""
    seats = lab.ideal()
    small, large = (
        {name: _response(lab, case.parameters, amplitude) for name, case in seats.items()}
        for amplitude in (_AMPLITUDE, _LARGER)
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
            'None; "below 4.5 Hz" is the range of the abstract.',
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
        f"Sines of constant floor acceleration, 55 kg, {_PERIODS} periods after {_SETTLE:g} s; seat over floor. With "
        "friction the seat's motion is no sine: full lines are ratios of RMS values, dotted ones the fundamental alone.",
        rows,
        panels,
        "Frequency (Hz)",
    )


def measured_transmissibility(lab: Lab) -> Iterator[Finding]:
    """Make Fig. 10, of the seats as calibrated."""
    seats = lab.seats()
    found = {name: _response(lab, case.parameters, _EXPERIMENT) for name, case in seats.items()}
    highest = {name: float(response.rms_ratio.max()) for name, response in found.items()}
    between = change(found["passive"].within(2.5, 4.5).mean(), found["uncontrolled"].within(2.5, 4.5).mean())
    rows = [
        Row(
            "Controlled, 1 to 4.5 Hz, largest ratio",
            "1",
            "below 1",
            (float(found["controlled"].within(1.0, 4.5).max()),),
            Kind.PREDICTED,
            "The paper prints no numbers, only the figure.",
        ),
        Row(
            "Passive, at its resonance",
            "1",
            "higher than uncontrolled",
            (highest["passive"],),
            Kind.PREDICTED,
            "The paper prints no numbers, and no amplitude.",
        ),
        Row(
            "Uncontrolled, highest",
            "1",
            "lower than passive",
            (highest["uncontrolled"],),
            Kind.PREDICTED,
            "It depends on the amplitude more than on anything else: friction holds the seat below it, lets go above.",
        ),
        Row(
            "Passive against uncontrolled, mean over 2.5 to 4.5 Hz",
            "%",
            "lower, very close",
            (between,),
            Kind.PREDICTED,
            "The paper prints no numbers.",
        ),
    ]
    yield Finding(
        "fig10",
        f"Sines of {_EXPERIMENT:g} m/s² floor acceleration (the paper gives none), 55 kg, ratio of RMS values, seat over "
        "floor; the passive seat and the prototype's imperfections as calibrated on Table 2, nothing fitted here.",
        rows,
        [_panel("seat over floor", seats, found, None)],
        "Frequency (Hz)",
    )


def _panel(what: str, seats: Mapping[str, Case], found: Mapping[str, _Response], top: float | None) -> Panel:
    curves = [Curve(seats[name].title, each.rms_ratio, seats[name].style) for name, each in found.items()]
    if top is not None:
        curves += [
            Curve(f"{seats[name].title}, fundamental", each.gain, {**seats[name].style, "linestyle": ":"})
            for name, each in found.items()
        ]
    limits = None if top is None else (0.0, top)
    return Panel(f"Transmissibility\n{what}", _FREQUENCIES, curves, {"1": 1.0}, limits=limits)
