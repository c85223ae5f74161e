"""Fig. 11 and 12: the bump of the experiments, of the passive seat and the prototype as calibrated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cosim.bump import Case
from cosim.figures import Curve, Panel
from cosim.metrics import peak
from cosim.paper.finding import Finding, Kind, Row
from cosim.paper.lab import DRIVER, SEAT, Lab, change
from cosim.paper.published import BUMP_PEAKS
from cosim.results import Result
from cosim.scenarios import SCENARIOS

_KEYS = dict(zip(BUMP_PEAKS, ("fig11", "fig12"), strict=True))
_REMARKS = {
    "passive": "The bump of the experiment is not described; (34) of the simulation comes near.",
    "controlled": "The seat's peak does not come down here: each time friction reverses or the force leaves its limit, "
    "the frame rings on the cushion; the driver's peak does.",
}


def rig_bumps(lab: Lab) -> Iterator[Finding]:
    """Meet the bump with either load."""
    bump, seats = SCENARIOS["bump"], lab.seats()
    for mass, key in _KEYS.items():
        results = {
            name: lab.run(bump.stop_time, bump.parameters, seats[name].parameters, mass=mass)
            for name in BUMP_PEAKS[mass]
        }
        yield Finding(
            key,
            f"The bump (34) of the simulation, {mass:g} kg; the seats as calibrated on the 55 kg random ride, nothing "
            "fitted here.",
            [*_rows(seats, mass, results)],
            [_panel(seats, results, SEAT, "Seat"), _panel(seats, results, DRIVER, "Driver")],
        )


def _rows(seats: Mapping[str, Case], mass: float, results: Mapping[str, Result]) -> Iterator[Row]:
    paper = BUMP_PEAKS[mass]
    for signal, what in ((SEAT, "seat"), (DRIVER, "driver")):
        peaks = {name: peak(result[signal]) for name, result in results.items()}
        on_seat = signal == SEAT
        for name, value in peaks.items():
            remark = (
                _REMARKS[name] if on_seat else "The paper shows the seat's acceleration; this is above the cushion."
            )
            printed = f"{paper[name]:.2f}" if on_seat else ""
            yield Row(f"{seats[name].title}, peak of the {what}", "m/s²", printed, (value,), Kind.PREDICTED, remark)
        printed = f"{change(paper['controlled'], paper['passive']):.1f}".replace("-", "−")
        yield Row(
            f"Controlled against passive, {what}",
            "%",
            printed if on_seat else "",
            (change(peaks["controlled"], peaks["passive"]),),
            Kind.PREDICTED,
            "See above." if on_seat else "What reaches the driver falls, less than the paper says of the seat.",
            1,
        )


def _panel(seats: Mapping[str, Case], results: Mapping[str, Result], signal: str, what: str) -> Panel:
    curves = [Curve(seats[name].title, result[signal], seats[name].style) for name, result in results.items()]
    return Panel(f"{what} acceleration\n(m/s²)", results["passive"].time, curves, {})
