"""A controller of another tool: PythonFMU makes an FMU of this file. Pressure in bar, travel in mm, output in V."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class ForeignLaw(Fmi2Slave):
    """Proportional on the error, with the lower chamber's pressure fed back."""

    def __init__(self, **given):
        super().__init__(**given)
        self.x = 0.0
        self.x_ref = 0.0
        self.p = 0.0
        self.kp = 0.05
        self.kq = 0.001
        self.u = 0.0
        for name in ("x", "x_ref", "p"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in ("kp", "kq"):
            tunable = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}
            self.register_variable(Real(name, **tunable))
        self.register_variable(Real("u", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """One sample."""
        if self.kp < 0.0:
            raise ValueError("kp is negative")
        self.u = self.kp * (self.x_ref - self.x) - self.kq * self.p
        return True
