"""Default values of the blocks that are not those of their parts, each with unit, symbol and source."""

from __future__ import annotations

from fmus.variables import Quantity

KNOWN_MASS = Quantity(0.0, "kg", "m_b", "0: seat.driver_mass")
KNOWN_TIME_CONSTANT = Quantity(0.0, "s", "T_a", "0: seat.actuator.time_constant")
KNOWN_DELAY = Quantity(0.0, "s", "T_d", "0: seat.actuator.delay")
KNOWN_TRAVEL = Quantity(0.0, "m", "x_e", "0: the shorter way to an end stop of the seat")

INNER_STEP_SIZE = Quantity(0.0, "s", "h_i", "0: one exchange in each communication step, as by a master")

# of the parameter set `passive`, whose values docs/explanation/calibration.md derives; a test compares them
PASSIVE_DAMPING = Quantity(736.0, "N.s/m", "c_f", "fitted: passive RMS 1.061 m/s2 at 55 kg, Table 2")
PASSIVE_FRICTION = Quantity(
    61_966.0, "N/m", "alpha", "assumed: 0.2 of the prototype's, which has gear reducers besides"
)

# of the variable damper; "search" is studies/seat_blocks.py
MINIMUM_DAMPING = Quantity(150.0, "N.s/m", "c_min", "assumed: the open valve")
MAXIMUM_DAMPING = Quantity(2500.0, "N.s/m", "c_max", "assumed: the closed valve")
SKYHOOK_DAMPING = Quantity(1290.0, "N.s/m", "c_sky", "search")
DAMPER_TIME_CONSTANT = Quantity(0.010, "s", "T_c", "assumed: 23 ms to 90 % of a change")
VELOCITY_CORNER = Quantity(0.5, "Hz", "f_l", "search, with a bias of 50 mm/s2")
RATE_CUTOFF = Quantity(30.0, "Hz", "f_c", "as of SeatController")
