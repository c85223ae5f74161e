"""Skyhook controller with the inputs and outputs of SeatController: a virtual damper to an inertial frame."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Skyhook(Fmi2Slave):
    """Force -M s v, with v the seat's acceleration integrated above a corner frequency, and M driver and seat.

    The integral has a leak below the corner frequency, so an offset of the accelerometer causes a constant force, not a
    growing one.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.seat_acceleration = 0.0
        self.suspension_deflection = 0.0
        self.force = 0.0
        self.driver_mass = 55.0  # kg
        self.force_limit = 250.0  # N
        self.rate = 54.6  # 1/s: s; tuned, with the corner, by studies/tune_baselines.py
        self.corner = 0.965  # Hz
        self.velocity = 0.0
        self.samples = 0
        for name in ("seat_acceleration", "suspension_deflection"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("driver_mass", "force_limit", "rate", "corner"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(Real("force", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete))

    def do_step(self, current_time, step_size):
        while self.samples * 0.002 < current_time + step_size - 1e-9:  # every sample due in [t, t + H)
            self.samples += 1
            self.sample(0.002)
        return True

    def sample(self, h):
        leak = 2.0 * math.pi * self.corner
        self.velocity = (self.velocity + h * self.seat_acceleration) / (1.0 + h * leak)
        force = -(self.driver_mass + 28.0) * self.rate * self.velocity
        self.force = min(max(force, -self.force_limit), self.force_limit)
