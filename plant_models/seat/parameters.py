"""Default values of the seat, each with unit, symbol and source (equation numbers are those of the paper [1])."""

from __future__ import annotations

from fmus.variables import Quantity

_TABLE_1 = "Table 1"
_FRICTION = "Appendix"

DRIVER_MASS = Quantity(55.0, "kg", "m_b", _TABLE_1)
SEAT_MASS = Quantity(28.0, "kg", "m_s", _TABLE_1)
CUSHION_STIFFNESS = Quantity(90_000.0, "N/m", "k_c", _TABLE_1)
CUSHION_DAMPING = Quantity(2_500.0, "N.s/m", "c_c", _TABLE_1)
SUSPENSION_STIFFNESS = Quantity(4_600.0, "N/m", "k_f", _TABLE_1)
SUSPENSION_DAMPING = Quantity(0.0, "N.s/m", "c_f", "the prototype's damper is removed, section 3.1")

FRICTION_ALPHA = Quantity(3.0983e5, "N/m", "alpha", _FRICTION)
FRICTION_GAMMA = Quantity(2.1617e8, "1/m2", "gamma_d", _FRICTION)
FRICTION_BETA = Quantity(-9.8889e7, "1/m2", "beta_d", _FRICTION)
FRICTION_A = Quantity(6.9321, "1", "A_d", _FRICTION)

_NO_ACTUATOR = "an ideal actuator"
_NO_SENSOR = "an ideal sensor"
_NO_STOP = "no end stop"

ACTUATOR_FORCE_LIMIT = Quantity(0.0, "N", "u_max", _NO_ACTUATOR)
ACTUATOR_DELAY = Quantity(0.0, "s", "T_d", _NO_ACTUATOR)
ACTUATOR_TIME_CONSTANT = Quantity(0.0, "s", "T_a", _NO_ACTUATOR)

SENSOR_BANDWIDTH = Quantity(0.0, "Hz", "f_s", _NO_SENSOR)
ACCELERATION_NOISE = Quantity(0.0, "m/s2", "sigma_a", _NO_SENSOR)
ACCELERATION_BIAS = Quantity(0.0, "m/s2", "b_a", _NO_SENSOR)
ACCELERATION_RESOLUTION = Quantity(0.0, "m/s2", "q_a", _NO_SENSOR)
DEFLECTION_NOISE = Quantity(0.0, "m", "sigma_d", _NO_SENSOR)
DEFLECTION_BIAS = Quantity(0.0, "m", "b_d", _NO_SENSOR)
DEFLECTION_RESOLUTION = Quantity(0.0, "m", "q_d", _NO_SENSOR)

END_STOP_TRAVEL = Quantity(0.0, "m", "x_e", _NO_STOP)
END_STOP_HEIGHT = Quantity(0.0, "m", "x_m", "static equilibrium in the middle of the travel")
END_STOP_STIFFNESS = Quantity(0.0, "N/m", "k_e", _NO_STOP)
END_STOP_DAMPING = Quantity(0.0, "N.s/m", "c_e", _NO_STOP)
