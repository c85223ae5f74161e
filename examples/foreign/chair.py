"""A seat with one mass on a spring and a damper; pythonfmu3, other names, deflection in mm."""

from pythonfmu3 import CoSimulation, Float64, Fmi3Causality, Fmi3SlaveBase, Fmi3StepResult, Fmi3Variability, Unit


class Chair(Fmi3SlaveBase, CoSimulation):
    """Seat with m x'' = -k (x - floor) - c (x' - floor') + F."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.register_units([Unit("m", m=1), Unit("mm", m=1, factor=1e-3), Unit("m/s2", m=1, s=-2)])
        self.register_units([Unit("m/s", m=1, s=-1), Unit("N", kg=1, m=1, s=-2), Unit("kg", kg=1)])
        self.time = 0.0
        self.mass = 90.0
        self.zv = self.dzv = self.F = 0.0
        self.x = self.rate = 0.0
        self.acc_seat = self.stroke = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        for name, unit in (("zv", "m"), ("dzv", "m/s"), ("F", "N")):
            self.register_variable(Float64(name, causality=Fmi3Causality.input, unit=unit, start=0.0))
        self.register_variable(
            Float64(
                "mass", causality=Fmi3Causality.parameter, variability=Fmi3Variability.tunable, unit="kg", start=90.0
            )
        )
        for name, unit in (("acc_seat", "m/s2"), ("stroke", "mm")):
            self.register_variable(Float64(name, causality=Fmi3Causality.output, unit=unit))

    def do_step(self, current_time, step_size):
        parts = 8
        h = step_size / parts
        for part in range(parts):
            floor = self.zv + (part + 0.5) * h * self.dzv
            self.acc_seat = (-5500.0 * (self.x - floor) - 500.0 * (self.rate - self.dzv) + self.F) / self.mass
            self.rate += h * self.acc_seat
            self.x += h * self.rate
        self.stroke = 1e3 * (self.x - self.zv - step_size * self.dzv)
        return Fmi3StepResult()
