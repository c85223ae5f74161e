"""A cabin that crosses a kerb; pythonfmu, output: displacement of the floor in mm, without a unit."""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Cabin(Fmi2Slave):
    """Motion of a cabin on soft mounts over a kerb with ramps: x'' + 2 D w x' + w^2 (x - kerb) = 0."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.kerb = 40.0
        self.frequency = 2.5
        self.z = 0.0
        self.rate = 0.0
        self.register_variable(Real("kerb", causality=Fmi2Causality.parameter))
        self.register_variable(Real("frequency", causality=Fmi2Causality.parameter))
        self.register_variable(Real("z", causality=Fmi2Causality.output))

    def road(self, time):
        """Return the height of the road in mm at a time in s: up over 0.2 s, one second on top, down over 0.2 s."""
        ramp = min(max(time - 0.2, 0.0), 0.2) - min(max(time - 1.4, 0.0), 0.2)
        return 0.5 * self.kerb * (1.0 - math.cos(math.pi * ramp / 0.2))

    def do_step(self, current_time, step_size):
        omega = 2.0 * math.pi * self.frequency
        parts = 8
        h = step_size / parts
        for part in range(parts):
            road = self.road(current_time + (part + 0.5) * h)
            self.rate += h * (omega**2 * (road - self.z) - 2.0 * 0.5 * omega * self.rate)
            self.z += h * self.rate
        return True
