"""Robustness of the sampled loop to what the controller does not know: mass, cushion, load, empty seat, seated body.

The delay margins of :mod:`seat_controller_fmu.design.certificate` are those of the seat that the controller assumes.
Here the seat is another one, and the controller keeps its parameters. All cells are by eigenvalues of the linear
sampled loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

from threadpoolctl import threadpool_limits

from seat_controller_fmu.design.gains import Gains
from seat_controller_fmu.design.sampled_loop import BodyFor, DriverBody, SeatFor, SeatModel, delay_margin

MASSES = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
"""Driver masses of the table, in kg."""

SOFT_CUSHION = (20_000.0, 500.0)
"""Stiffness in N/m and damping in N.s/m of a cushion much softer than that of Table 1."""
STRAPPED_FACTORS = (100.0, 10.0)
"""Stiffness and damping of a strapped load's link, over those of the cushion: both masses move as one to 100 Hz."""
EMPTY_MASS = 1.0
"""Mass on an empty seat, in kg: that of the cushion itself."""


@dataclass
class LinearSeat:
    """A linear seat whose parameters can be replaced; a :class:`~seat_controller_fmu.design.sampled_loop.SeatModel`.

    Attributes
    ----------
    driver_mass, seat_mass
        m_b and m_s, in kg.
    suspension_stiffness, suspension_damping
        k_f in N/m, c_f in N.s/m.
    cushion_stiffness, cushion_damping
        k_c in N/m, c_c in N.s/m.
    """

    driver_mass: float
    seat_mass: float
    suspension_stiffness: float
    suspension_damping: float
    cushion_stiffness: float
    cushion_damping: float

    @classmethod
    def of(cls, seat: SeatModel) -> LinearSeat:
        """Return a copy of a seat of any kind.

        Parameters
        ----------
        seat
            The seat.

        Returns
        -------
        LinearSeat
            With the same parameters.
        """
        return cls(*(getattr(seat, field.name) for field in fields(cls)))


@dataclass(frozen=True)
class Case:
    """One cell of the table: the mass that the controller knows, and the seat that is there.

    Attributes
    ----------
    known_mass
        Driver's mass as parameter of the controller, in kg.
    seat
        The seat.
    body
        Driver of several masses in place of the mass on the cushion; None for this mass.
    """

    known_mass: float
    seat: LinearSeat
    body: DriverBody | None = None


def _as_assumed(gains: Gains, seat: LinearSeat) -> Case:
    return Case(seat.driver_mass, seat)


def _known_lightest(gains: Gains, seat: LinearSeat) -> Case:
    return Case(gains.setting.driver_mass_min, seat)


def _known_heaviest(gains: Gains, seat: LinearSeat) -> Case:
    return Case(gains.setting.driver_mass_max, seat)


def _strapped(gains: Gains, seat: LinearSeat) -> Case:
    stiffer, damped = STRAPPED_FACTORS
    stiffness, damping = stiffer * seat.cushion_stiffness, damped * seat.cushion_damping
    return Case(seat.driver_mass, replace(seat, cushion_stiffness=stiffness, cushion_damping=damping))


def _soft(gains: Gains, seat: LinearSeat) -> Case:
    stiffness, damping = SOFT_CUSHION
    return Case(seat.driver_mass, replace(seat, cushion_stiffness=stiffness, cushion_damping=damping))


def _empty(gains: Gains, seat: LinearSeat) -> Case:
    return Case(seat.driver_mass, replace(seat, driver_mass=EMPTY_MASS))


CONDITIONS: Mapping[str, Callable[[Gains, LinearSeat], Case]] = {
    "true mass, cushion of Table 1": _as_assumed,
    "controller has the lightest mass": _known_lightest,
    "controller has the heaviest mass": _known_heaviest,
    "strapped load": _strapped,
    f"soft cushion, {SOFT_CUSHION[0] / 1e3:g} kN/m, {SOFT_CUSHION[1]:g} N s/m": _soft,
    "empty seat, controller has the mass": _empty,
}
"""Row of the table to the case of a driver's mass."""


SEATED = "seated driver, four masses in place of one"
"""Row of the table with a driver of several masses."""


def robustness(gains: Gains, seat_for: SeatFor, body_for: BodyFor | None = None) -> dict[str, dict[float, float]]:
    """Return the delay margins of the sampled loop under conditions other than those of the design.

    Parameters
    ----------
    gains
        Set of gains.
    seat_for
        Function from the driver's mass in kg to the nominal seat.
    body_for
        Function from the driver's mass in kg to the seated driver of the row :data:`SEATED`; without the row if None.

    Returns
    -------
    dict
        Row of :data:`CONDITIONS`, and :data:`SEATED`, to driver mass in kg (:data:`MASSES`) to the delay margin in ms;
        NaN where the loop is unstable without additional delay.
    """
    seats = {mass: LinearSeat.of(seat_for(mass)) for mass in MASSES}
    rows = {name: {m: condition(gains, seat) for m, seat in seats.items()} for name, condition in CONDITIONS.items()}
    if body_for is not None:
        rows[SEATED] = {mass: Case(mass, seat, body_for(mass)) for mass, seat in seats.items()}
    with threadpool_limits(1, "blas"):  # for these small matrices threads are ten times slower
        return {
            name: {
                mass: delay_margin(gains.controller(case.known_mass), case.seat, case.body)
                for mass, case in cases.items()
            }
            for name, cases in rows.items()
        }
