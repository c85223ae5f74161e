"""PID controller of the seat acceleration with the inputs and outputs of SeatController; its setpoint is 0."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Pid(Fmi2Slave):
    """Force -M (p a + i v + d a'), with a the filtered acceleration of the seat, v its integral, M driver and seat.

    The integral has a leak below a corner frequency, so an offset of the accelerometer causes a constant force, not a
    growing one. The filter limits the proportional part at high frequencies, where the actuator moves the seat frame
    without the driver.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.seat_acceleration = 0.0
        self.suspension_deflection = 0.0
        self.force = 0.0
        self.driver_mass = 55.0  # kg
        self.force_limit = 250.0  # N
        self.p = 0.939  # 1; tuned, with the four below, by studies/tune_baselines.py
        self.i = 50.3  # 1/s
        self.d = 0.0138  # s
        self.bandwidth = 0.797  # Hz, corner frequency of the filter
        self.corner = 0.873  # Hz, corner frequency of the leak
        self.filtered = 0.0
        self.integral = 0.0
        self.samples = 0
        for name in ("seat_acceleration", "suspension_deflection"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("driver_mass", "force_limit", "p", "i", "d", "bandwidth", "corner"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(Real("force", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete))

    def do_step(self, current_time, step_size):
        while self.samples * 0.002 < current_time + step_size - 1e-9:  # every sample due in [t, t + H)
            self.samples += 1
            self.sample(0.002)
        return True

    def sample(self, h):
        before = self.filtered
        share = 1.0 - math.exp(-2.0 * math.pi * self.bandwidth * h)
        self.filtered += share * (self.seat_acceleration - self.filtered)
        leak = 2.0 * math.pi * self.corner
        self.integral = (self.integral + h * self.seat_acceleration) / (1.0 + h * leak)
        command = self.p * self.filtered + self.i * self.integral + self.d * (self.filtered - before) / h
        force = -(self.driver_mass + 28.0) * command
        self.force = min(max(force, -self.force_limit), self.force_limit)
