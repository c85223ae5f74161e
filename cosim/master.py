"""Algorithm: who steps when. Time is an integer tick; what is recorded is the observers' business."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

from cosim.clock import Clock
from cosim.errors import RunError
from cosim.isolated import Slave


class Observer(Protocol):
    """Sees a run pass by."""

    def before(self, tick: int) -> None:
        """Look at the values at t_k, before any component has stepped."""

    def after(self, tick: int) -> None:
        """Look at the values after all components have stepped from t_k."""


def gauss_seidel(order: Sequence[Slave], clock: Clock, observers: Iterable[Observer]) -> None:
    """Step the components one after the other, each with the newest outputs of the others.

    Parameters
    ----------
    order
        Instances in their order: what an earlier one computes in this step reaches the later ones without delay, what
        a later one computes reaches the earlier ones in the next step.
    clock
        When.
    observers
        Called before and after every step, in their order.

    Raises
    ------
    RunError
        If an FMU refuses a call; the observers keep what they saw.
    """
    observers = tuple(observers)
    for tick in range(clock.steps):
        for observer in observers:
            observer.before(tick)
        time = clock.time(tick)
        for instance in order:
            try:
                instance.step(time, clock.step_size)
            except RunError:
                raise
            except Exception as error:
                raise instance.failure(error, "step", time) from error
        for observer in observers:
            observer.after(tick)
