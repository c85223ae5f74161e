"""What the blocks share: their seat, and the parts of a step between which a law and its seat exchange values."""

from __future__ import annotations

from fmus.component import ParameterError
from plant_models.seat import seat
from plant_models.seat.interface import DriverModel, Parameters
from seat_controller_fmu.sampling import SAMPLE_TOLERANCE, next_exchange


def end_of_part(time: float, begin: float, step_size: float, interval: float) -> float:
    """Return where a part of a communication step ends: at the next exchange, or with the step.

    Parameters
    ----------
    time
        Begin of the communication step, in s.
    begin
        Begin of the part, in s after ``time``.
    step_size
        Communication step size, in s.
    interval
        Time between exchanges, in s, at its multiples; 0 for none within the step.

    Returns
    -------
    float
        In s after ``time``.

    Examples
    --------
    >>> end_of_part(0.003, 0.0, 0.01, 0.002), end_of_part(0.003, 0.0, 0.01, 0.0), end_of_part(0.0, 0.0, 0.001, 0.002)
    (0.001, 0.01, 0.001)
    """
    if interval == 0.0:
        return step_size
    end = next_exchange(time + begin, interval) - time
    return end if end < step_size - SAMPLE_TOLERANCE * interval else step_size


def prepare_seat(parameters: Parameters) -> seat.Coefficients:
    """Derive the coefficients of a block's seat.

    Parameters
    ----------
    parameters
        Parameters of the seat.

    Returns
    -------
    plant_models.seat.seat.Coefficients
        For its functions.

    Raises
    ------
    ParameterError
        If the driver is external, for which a block has no port, or as by the seat.
    """
    if parameters.driver_model == DriverModel.external:
        raise ParameterError(
            "seat.driver.model: expected lumped or seated, got external, for which a block has no port; "
            "SeatPlant has one"
        )
    return seat.prepare(parameters)
