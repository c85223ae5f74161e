"""The floor of a truck's cabin; pythonfmu3, output: acceleration in g, with its unit."""

import math

from pythonfmu3 import CoSimulation, Float64, Fmi3Causality, Fmi3SlaveBase, Fmi3StepResult, Fmi3Variability, Unit


class Truck(Fmi3SlaveBase, CoSimulation):
    """Vibration at two frequencies that fades in and out; its double integral ends at zero."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.register_units([Unit("g", m=1, s=-2, factor=9.80665)])
        self.time = 0.0
        self.level = 0.15
        self.acc = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        self.register_variable(
            Float64(
                "level", causality=Fmi3Causality.parameter, variability=Fmi3Variability.tunable, unit="g", start=0.15
            )
        )
        self.register_variable(Float64("acc", causality=Fmi3Causality.output, unit="g"))

    def do_step(self, current_time, step_size):
        self.time = current_time + step_size
        fade = math.sin(math.pi * min(self.time / 4.0, 1.0)) ** 2
        self.acc = (
            self.level * fade * (math.sin(2 * math.pi * 2.0 * self.time) + math.sin(2 * math.pi * 3.5 * self.time))
        )
        return Fmi3StepResult()
