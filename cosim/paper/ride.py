"""Fig. 11-16 and Table 2: the experiments, of the passive seat and the prototype as calibrated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cosim.figures import Curve, Panel
from cosim.metrics import peak, psd, rms
from cosim.metrics.samples import Samples
from cosim.paper.finding import Finding, Kind, Row
from cosim.paper.lab import HEAVY, LIGHT, RATE, SEAT, Lab, change
from cosim.results import Result
from cosim.scenarios import SCENARIOS

RIDE_TIME = 60.0
"""s"""

_LOADS = (LIGHT, HEAVY)
_BUMP_PEAKS = {LIGHT: {"passive": 2.02, "controlled": 1.32}, HEAVY: {"passive": 2.33, "controlled": 1.03}}
"""Printed in section 3.4, in m/s2."""
_RMS = {"passive": 1.061, "uncontrolled": 1.067, "controlled": 0.578}
"""Printed in Table 2 for 55 kg, in m/s2."""
_REDUCTION = {LIGHT: 45.5, HEAVY: 49.5}
"""Printed, of the RMS acceleration from passive to controlled, in %."""
_SHOWN = 10.0
"""Hz, the end of the spectra drawn."""


def measured_bumps(lab: Lab) -> Iterator[Finding]:
    """Make Fig. 11 and 12."""
    bump, seats = SCENARIOS["bump"], lab.seats()
    for key, mass in zip(("fig11", "fig12"), _LOADS, strict=True):
        results = {
            name: lab.run(bump.stop_time, bump.parameters, seats[name].parameters, mass=mass)
            for name in _BUMP_PEAKS[mass]
        }
        peaks = {name: peak(result[SEAT]) for name, result in results.items()}
        paper = _BUMP_PEAKS[mass]
        rows = [
            Row(
                f"{seats[name].title}, peak",
                "m/s²",
                f"{paper[name]:.2f}",
                (peaks[name],),
                Kind.PREDICTED,
                "The paper does not give the bump of its experiments; this is that of its simulation.",
            )
            for name in results
        ]
        rows.append(
            Row(
                "Controlled against passive",
                "%",
                f"{change(paper['controlled'], paper['passive']):.1f}".replace("-", "−"),
                (change(peaks["controlled"], peaks["passive"]),),
                Kind.PREDICTED,
                "A bump of another height or length shakes both seats otherwise.",
                1,
            )
        )
        time = results["passive"].time
        curves = [Curve(seats[name].title, result[SEAT], seats[name].style) for name, result in results.items()]
        yield Finding(
            key,
            f"The bump (34) of the simulation, {mass:g} kg; the seats as calibrated on the 55 kg random ride, nothing "
            "fitted here.",
            rows,
            [Panel("Seat acceleration (m/s²)", time, curves, {})],
        )


def random_ride(lab: Lab) -> Iterator[Finding]:
    """Make Fig. 13 to 16 and Table 2, of one and the same random ride."""
    seats = lab.seats()
    rides = {
        mass: {name: lab.run(RIDE_TIME, lab.calibration.ride, seat.parameters, mass=mass) for name, seat in seats.items()}
        for mass in _LOADS
    }
    for key, mass in zip(("fig13", "fig14"), _LOADS, strict=True):
        yield _time_series(lab, key, mass, rides[mass])
    for key, mass in zip(("fig15", "fig16"), _LOADS, strict=True):
        yield _spectra(lab, key, mass, rides[mass])
    yield _table(lab, {mass: {name: rms(result[SEAT]) for name, result in ride.items()} for mass, ride in rides.items()})


def _time_series(lab: Lab, key: str, mass: float, ride: Mapping[str, Result]) -> Finding:
    seats, kind = lab.seats(), Kind.PREDICTED
    peaks = {name: peak(result[SEAT]) for name, result in ride.items()}
    said = {"uncontrolled": "about 6", "passive": "lower", "controlled": "low all the time"}
    rows = [
        Row(
            f"{seats[name].title}, peak",
            "m/s²",
            said[name],
            (peaks[name],),
            kind,
            "The recorded excitation is not given: ours has its level and spectrum at best, not its extreme moments.",
        )
        for name in ride
    ]
    top = 1.05 * max(peaks.values())
    panels = [
        Panel(
            f"{seats[name].title}\n(m/s²)",
            result.time,
            [Curve("seat acceleration", result[SEAT], {"color": seats[name].style["color"], "linewidth": 0.6})],
            {},
            limits=(-top, top),
        )
        for name, result in ride.items()
    ]
    return Finding(key, _ride_conditions(mass), rows, panels)


def _spectra(lab: Lab, key: str, mass: float, ride: Mapping[str, Result]) -> Finding:
    seats = lab.seats()
    found = {name: psd(result[SEAT], RATE) for name, result in ride.items()}
    shown = found["passive"].frequency <= _SHOWN
    frequency = found["passive"].frequency[shown]

    def top(name: str) -> tuple[float, float]:
        density = found[name].density[shown]
        return float(frequency[density.argmax()]), float(density.max())

    rows = [
        Row(
            f"{seats[name].title}, frequency of the peak",
            "Hz",
            "around 2",
            (top(name)[0],),
            Kind.FITTED if mass == LIGHT else Kind.PREDICTED,
            "The excitation's spectrum is ours.",
        )
        for name in ("passive", "uncontrolled")
    ]
    rows.append(
        Row(
            "Controlled, peak over that of the passive seat",
            "1",
            "low",
            (top("controlled")[1] / top("passive")[1],),
            Kind.PREDICTED,
            "The paper prints no number.",
        )
    )
    curves = [Curve(seats[name].title, each.density[shown], seats[name].style) for name, each in found.items()]
    panel = Panel("PSD of the seat's\nacceleration ((m/s²)²/Hz)", frequency, curves, {})
    return Finding(key, _ride_conditions(mass), rows, [panel], "Frequency (Hz)")


def _ride_conditions(mass: float) -> str:
    fitted = "fitted to the RMS values of Table 2" if mass == LIGHT else "fitted at 55 kg, nothing at this load"
    return f"A random ride of {RIDE_TIME:g} s, {mass:g} kg; excitation, passive seat and imperfections {fitted}."


def _table(lab: Lab, found: Mapping[float, Mapping[str, float]]) -> Finding:
    ideal = lab.ideal()["controlled"].parameters
    rows = []
    for mass, levels in found.items():
        kind = Kind.FITTED if mass == LIGHT else Kind.PREDICTED
        for name, level in levels.items():
            paper = f"{_RMS[name]:.3f}" if mass == LIGHT else ""
            remark = "Fitted." if paper else "Of this row of the paper's table only the reduction is in its text."
            rows.append(Row(f"{mass:g} kg, {name}", "m/s²", paper, (level,), kind, remark, 3))
        rows.append(_reduction(f"{mass:g} kg, reduction", mass, levels["controlled"], levels["passive"], kind))
        simulated = rms(lab.run(RIDE_TIME, lab.calibration.ride, ideal, mass=mass)[SEAT])
        rows.append(
            _reduction(
                f"{mass:g} kg, reduction, ideal prototype", mass, simulated, levels["passive"], Kind.PREDICTED
            )
        )
    return Finding("table2", "The ride of Fig. 13 to 16; RMS of the seat's acceleration.", rows)


def _reduction(quantity: str, mass: float, controlled: float, passive: float, kind: Kind) -> Row:
    paper = f"{_REDUCTION[mass]:.1f}"
    return Row(quantity, "%", paper, (-change(controlled, passive),), kind, "…", 1)
