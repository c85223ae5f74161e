"""Default values of the controller, each with unit, symbol and source (equation numbers are those of the paper [1]).

The seat mass, suspension stiffness and driver mass are the nominal model of the controller. They are declared here, as
this package does not import the plant; a test compares them with the plant's values.
"""

from __future__ import annotations

from fmus.variables import Quantity

_TABLE_1 = "Table 1"

DRIVER_MASS = Quantity(55.0, "kg", "m_b", _TABLE_1)
SEAT_MASS = Quantity(28.0, "kg", "m_s", _TABLE_1)
SUSPENSION_STIFFNESS = Quantity(4_600.0, "N/m", "k_f", _TABLE_1)

SAMPLE_TIME = Quantity(0.002, "s", "h", "section 3.3: 500 Hz")
FORCE_LIMIT = Quantity(250.0, "N", "u_lim", _TABLE_1)

# Table 1 prints m_bmax = 120 kg, but the published L_12 = -3086 = 1/(108 x -3e-6) and L_22 = -9259 = 1/(108 x -1e-6)
# follow from M_max = 108 kg, and so do the gains: (4600 - 4573)/73 = (4600 - 4560)/108 = 0.370. Hence 80 kg.
DRIVER_MASS_MIN = Quantity(45.0, "kg", "m_bmin", _TABLE_1)
DRIVER_MASS_MAX = Quantity(80.0, "kg", "m_bmax", "from the published observer gains, Table 1 misprints 120 kg")

OBSERVERS = {
    1: Quantity(-3e-6, "s/kg2", "Gamma", "Table 1, Observer 1"),
    2: Quantity(-1e-6, "s/kg2", "Gamma", "Table 1, Observer 2"),
}
"""Constants of the two observers in the paper, by number."""
OBSERVER_GAIN = Quantity(0.0, "kg/s", "L_i", "equation 23 where 0")
PUBLISHED_OBSERVER_GAINS = {1: (-4566.0, -3086.0), 2: (-13699.0, -9259.0)}
"""L_1 and L_2 of Observers 1 and 2 as printed in section 3.2, in kg/s, by number; tests compare (23) with them."""

K_1_DEFLECTION = Quantity(4573.0, "N/m", "K_1", "section 3.2")
K_1_RATE = Quantity(-90.0, "N.s/m", "K_1", "section 3.2")
K_2_DEFLECTION = Quantity(4560.0, "N/m", "K_2", "section 3.2")
K_2_RATE = Quantity(-134.0, "N.s/m", "K_2", "section 3.2")

RATE_FILTER_CUTOFF = Quantity(30.0, "Hz", "f_c", "assumed: the paper names a point by point low pass filter only")
LINK_LENGTH = Quantity(0.30, "m", "L", "assumed, not given in the paper")
INITIAL_HEIGHT = Quantity(0.20, "m", "h_0", "assumed, not given in the paper")
GEAR_RATIO = Quantity(20.0, "1", "r_g", "section 3.1")

# Further inputs of the design; c_0 is not given in the paper.
ALPHA = Quantity(0.02, "1", "alpha", _TABLE_1)
P_2 = Quantity(400.0, "1", "P_2", _TABLE_1)
LAMBDA = Quantity(1.2, "1", "lambda", _TABLE_1)
C_0 = Quantity(1.0, "1", "c_0", "assumed, not given in the paper")

# ---- mode robust: docs/explanation/robust.md derives each; "search" is studies/tune_robust.py ----
ACTUATOR_TIME_CONSTANT = Quantity(0.0, "s", "T_a", "ideal actuator")
ACTUATOR_DELAY = Quantity(0.0, "s", "T_d", "ideal actuator")
TRAVEL = Quantity(0.040, "m", "x_e", "assumed, not given in the paper")
CUSHION_STIFFNESS = Quantity(90_000.0, "N/m", "k_c", _TABLE_1)
CUSHION_DAMPING = Quantity(2_500.0, "N.s/m", "c_c", _TABLE_1)
OBSERVER_RATE = Quantity(80.0, "1/s", "P", "largest with 20 ms of delay margin at every mass")
MOTION_BANDWIDTH = Quantity(22.6, "Hz", "f_m", "search")
FRICTION = Quantity(75.0, "N", "F_r", "plateau of equation 35")
FRICTION_SHARE = Quantity(0.9, "1", "mu", "below 1 as real friction is no clean Coulomb friction")
FRICTION_RATE = Quantity(0.0041, "m/s", "v_0", "search")
CENTRING_FREQUENCY = Quantity(0.227, "Hz", "f_0", "search")
CENTRING_DAMPING = Quantity(0.89, "1", "zeta", "search")
CENTRING_FILTER = Quantity(0.9, "Hz", "f_l", "search")
BIAS_RATE = Quantity(0.2, "1/s3", "gamma_b", "5 % of the limit of stability: the more, the worse are slow floors")
FOLLOW_BEGIN = Quantity(0.3, "1", "x_0/x_e", "search")
FOLLOW_SLOPE = Quantity(0.5, "1", "b_1", "search")
FOLLOW_MAX = Quantity(0.6, "1", "beta_m", "delay margin of the follow term")
ENVELOPE_FREQUENCY = Quantity(2.02, "Hz", "f_w", "search")
ENVELOPE_DECAY = Quantity(0.35, "1/s", "d", "search")
OVERLOAD_BEGIN = Quantity(0.91, "1", "x_2/x_e", "search")
OVERLOAD_END = Quantity(1.88, "1", "x_3/x_e", "search")
OVERLOAD_DAMPING = Quantity(2_000.0, "N.s/m", "c_p", "search")
SAFE_DAMPING = Quantity(700.0, "N.s/m", "c_s", "near the passive seat's damper of 736 N.s/m, parameter set passive")
RAMP_TIME = Quantity(0.04, "s", "t_r", "leaves the paper's bump at the start below 1.5 m/s2, with any stops")
ACCELERATION_RANGE = Quantity(40.0, "m/s2", "a_max", "assumed: 4 g")
DEFLECTION_RANGE = Quantity(0.1, "m", "x_max", "assumed: beyond any seat's travel")
