"""A skyhook controller: a virtual damper to an inertial frame; pythonfmu, other names, no units."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Damper(Fmi2Slave):
    """Force F = -c v, with v the seat acceleration integrated above a corner frequency."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.acc = 0.0
        self.damping = 1000.0
        self.corner = 0.2
        self.limit = 250.0
        self.velocity = 0.0
        self.F = 0.0
        self.register_variable(Real("acc", causality=Fmi2Causality.input))
        for name in ("damping", "corner", "limit"):
            self.register_variable(Real(name, causality=Fmi2Causality.parameter))
        self.register_variable(Real("F", causality=Fmi2Causality.output, variability=Fmi2Variability.discrete))

    def do_step(self, current_time, step_size):
        self.velocity += step_size * (self.acc - 2.0 * math.pi * self.corner * self.velocity)
        self.F = min(max(-self.damping * self.velocity, -self.limit), self.limit)
        return True
