"""The seat suspension as an evaluated system, and the passive seat beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cosim.fmi.values import Value
from cosim.system import System
from seat_cosim.evaluation.system import EvaluatedSystem, SignalMap
from seat_cosim.scenarios import control, driver_mass


def ports(shaker: str = "shaker") -> SignalMap:
    """Name what an evaluation takes of the seat suspension.

    Parameters
    ----------
    shaker
        What the component is called that is our Shaker.
    """
    return SignalMap(
        floor=f"{shaker}.floor_acceleration",
        seat="seat.driver_acceleration",
        driver_mass=tuple(driver_mass(0.0)),
        excitation={f"{shaker}.profile": "random"},
        excitation_class=f"{shaker}.random.class",
        seed=f"{shaker}.random.seed",
        deflection="seat.suspension_deflection",
        force="controller.force",
        travel="seat.end_stop.travel",
    )


def passive_seat(system: System, parameters: Mapping[str, Value]) -> EvaluatedSystem:
    """Take a passive seat to an evaluation.

    Parameters
    ----------
    system
        From :func:`seat_suspension`.
    parameters
        What makes it a passive one, beside its controller being off.
    """
    system.parameters |= {**control(False), **parameters}
    return EvaluatedSystem("passive seat", system, replace(ports(), force=None))
