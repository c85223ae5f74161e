"""Default values of the truck, each with unit, symbol and source.

The chassis, axles and tyres are those of the two-axle truck in the literature on vehicle-bridge interaction [10]. Its
values were read in the published code of VBI-2D, where front and rear axle stand in different examples. What is not
there is as recalled or assumed, and is called so.
"""

from __future__ import annotations

from fmus.variables import Quantity

_VBI = "two-axle truck of VBI-2D [10]"
_VBI_RECALLED = "two-axle truck of the vehicle-bridge literature, as recalled"
_CAB = "assumed: cab bounce at 1.9 Hz, in the 1-3 Hz of sprung cabs"
_ASSUMED = "assumed"

SPEED = Quantity(60.0 / 3.6, "m/s", "v", "60 km/h")

ROAD_FADE = Quantity(10.0, "m", "L_f", _ASSUMED)
OBSTACLE_HEIGHT = Quantity(0.05, "m", "h_o", _ASSUMED)
OBSTACLE_LENGTH = Quantity(1.0, "m", "L_o", _ASSUMED)
OBSTACLE_POSITION = Quantity(10.0, "m", "x_o", _ASSUMED)

CAB_MASS = Quantity(1_000.0, "kg", "m_c", _CAB)
CAB_PITCH_INERTIA = Quantity(1_200.0, "kg.m2", "I_c", "assumed: radius of gyration 1.1 m")
CAB_POSITION = Quantity(0.2, "m", "x_c", "assumed: cab over engine")
CAB_FRONT_MOUNT = Quantity(0.9, "m", "b_1", _ASSUMED)
CAB_REAR_MOUNT = Quantity(1.1, "m", "b_2", _ASSUMED)
CAB_FRONT_STIFFNESS = Quantity(90_000.0, "N/m", "k_c1", _CAB)
CAB_REAR_STIFFNESS = Quantity(60_000.0, "N/m", "k_c2", _CAB)
CAB_FRONT_DAMPING = Quantity(4_000.0, "N.s/m", "c_c1", "assumed: damping ratio of the cab 0.25 to 0.3")
CAB_REAR_DAMPING = Quantity(3_000.0, "N.s/m", "c_c2", "assumed: damping ratio of the cab 0.25 to 0.3")

CHASSIS_MASS = Quantity(10_000.0, "kg", "m_s", "assumed: half laden; 16000 kg with the body of VBI-2D [10]")
CHASSIS_PITCH_INERTIA = Quantity(33_500.0, "kg.m2", "I_s", "radius of gyration 1.83 m as in VBI-2D [10]")
CHASSIS_POSITION = Quantity(2.4, "m", "x_s", _ASSUMED)
WHEELBASE = Quantity(4.5, "m", "L", _ASSUMED)

FRONT_STIFFNESS = Quantity(400_000.0, "N/m", "k_1", _VBI)
REAR_STIFFNESS = Quantity(1_000_000.0, "N/m", "k_2", _VBI)
FRONT_DAMPING = Quantity(20_000.0, "N.s/m", "c_1", "assumed: within the 10 to 40 kN.s/m of VBI-2D [10]")
REAR_DAMPING = Quantity(30_000.0, "N.s/m", "c_2", "assumed: within the 10 to 40 kN.s/m of VBI-2D [10]")

FRONT_AXLE_MASS = Quantity(700.0, "kg", "m_1", _VBI)
REAR_AXLE_MASS = Quantity(1_100.0, "kg", "m_2", _VBI_RECALLED)
FRONT_TYRE_STIFFNESS = Quantity(1_750_000.0, "N/m", "k_t1", _VBI)
REAR_TYRE_STIFFNESS = Quantity(3_500_000.0, "N/m", "k_t2", _VBI)

SEAT_POSITION = Quantity(0.2, "m", "d", _ASSUMED)
