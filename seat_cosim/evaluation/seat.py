"""The seat suspension as an evaluated system, and the passive seat that it is compared with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cosim.fmi.values import Value
from cosim.system import System
from seat_cosim.evaluation.system import EvaluatedSystem, SignalMap
from seat_cosim.scenarios import control, driver_mass

PASSIVE_NOTE = (
    "The passive seat is not the paper's, of which nothing is published: its damping is fitted on one of its numbers, "
    "its friction is assumed; see docs/explanation/calibration.md."
)
"""Note on the parameter set ``passive``, for readers of a report."""


def seat_signals(shaker: str = "shaker") -> SignalMap:
    """Return the signal map of the seat suspension.

    Parameters
    ----------
    shaker
        Name of the component that is a Shaker of this project.

    Examples
    --------
    >>> seat_signals("rig").floor_acceleration
    'rig.floor_acceleration'
    """
    return SignalMap(
        floor_acceleration=f"{shaker}.floor_acceleration",
        seat_acceleration="seat.driver_acceleration",
        driver_mass=tuple(driver_mass(0.0)),
        excitation={f"{shaker}.profile": "random"},
        excitation_class=f"{shaker}.random.class",
        seed=f"{shaker}.random.seed",
        suspension_deflection="seat.suspension_deflection",
        actuator_force="controller.force",
        end_stop_travel="seat.end_stop.travel",
        end_stop_height="seat.end_stop.height",
    )


def passive_seat(system: System, parameters: Mapping[str, Value]) -> EvaluatedSystem:
    """Switch a seat suspension's controller off and return it as an evaluated system.

    Parameters
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_suspension`; its parameters are changed.
    parameters
        Parameters of the passive seat, as ``component.variable``.
    """
    system.parameters |= {**control(False), **parameters}
    return EvaluatedSystem("passive seat", system, replace(seat_signals(), actuator_force=None))
