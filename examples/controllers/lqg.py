"""LQG controller with the inputs and outputs of SeatController: a Kalman filter and a linear-quadratic regulator."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

GAINS = {
    "K_deflection": 0.8608,  # regulator, in 1/s2
    "K_rate": 1.312,  # regulator, in 1/s
    "L_deflection_m": 0.7342,  # filter: gains from the innovation of the deflection, in m, to deflection x,
    "L_rate_m": 226.5,  # rate v
    "L_rest_m": 0.008251,  # and disturbance e
    "L_deflection_a": 2.063e-7,  # filter: gains from the innovation of the acceleration, in m/s2
    "L_rate_a": 2.215e-4,
    "L_rest_a": 0.1052,
}
"""Computed by studies/tune_baselines.py with scipy, not at run time."""


class Lqg(Fmi2Slave):
    """LQG controller of the seat as one mass M on a linear spring k, without friction.

    Deflection x and its rate v follow x' = v, v' = (u - k x)/M + e - (acceleration of the floor). In the filter the
    floor acceleration is white noise. The disturbance e stands for all effects that the model does not have and is
    noise with a decay. The force compensates spring and disturbance: u = k x - M (e + K_deflection x + K_rate v). An
    offset of the accelerometer becomes part of e and moves the seat by offset / K_deflection.
    """

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.seat_acceleration = 0.0
        self.suspension_deflection = 0.0
        self.force = 0.0
        self.driver_mass = 55.0  # kg
        self.force_limit = 250.0  # N
        self.suspension_stiffness = 4600.0  # N/m
        self.corner = 0.05  # Hz, corner frequency of the decay of e
        vars(self).update(GAINS)
        self.x = self.v = self.e = 0.0  # predicted for the next sample
        self.samples = 0
        for name in ("seat_acceleration", "suspension_deflection"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("driver_mass", "force_limit", "suspension_stiffness", "corner", *GAINS):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable))
        self.register_variable(Real("force", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete))

    def do_step(self, current_time, step_size):
        while self.samples * 0.002 < current_time + step_size - 1e-9:  # every sample due in [t, t + H)
            self.samples += 1
            self.sample(0.002)
        return True

    def sample(self, h):
        mass, stiffness = self.driver_mass + 28.0, self.suspension_stiffness
        deflection = self.suspension_deflection - self.x
        rest = self.seat_acceleration - (self.force - stiffness * self.suspension_deflection) / mass
        innovation = rest - self.e
        x = self.x + self.L_deflection_m * deflection + self.L_deflection_a * innovation
        v = self.v + self.L_rate_m * deflection + self.L_rate_a * innovation
        e = self.e + self.L_rest_m * deflection + self.L_rest_a * innovation
        force = stiffness * x - mass * (e + self.K_deflection * x + self.K_rate * v)
        self.force = min(max(force, -self.force_limit), self.force_limit)
        acceleration = (self.force - stiffness * x) / mass + e
        self.x, self.v = x + h * v + 0.5 * h * h * acceleration, v + h * acceleration
        self.e = e * math.exp(-2.0 * math.pi * self.corner * h)
