"""Charts of stability over any two numbers of a loop: counted multipliers on a grid, dimensionless or of a rig.

Dimensionless: the actuator of chapter 5 about its middle, z1' = z2, z2' = a - k z2, a' = -2 z2 + sqrt2 gamma u; delay
and filter time in sampling periods. Of a rig: gains in V/% and V s/%, times in ms, damping in N s/m.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.controller_side import gains
from bridge.scenario import Scenario
from bridge.stability.advice import held, plants_of
from bridge.stability.edges import timing_of
from bridge.stability.loop import NEUTRAL, Loop, Timing, multipliers, sampled
from bridge.stability.plant import Plant
from controller.law import per_metre, volts_per_percent

AXES = ("gain", "derivative", "period", "delay", "damping")
PLAIN = {"gain": 0.5, "derivative": 0.0, "period": 3.0, "delay": 0.0, "damping": 0.1, "gamma": 0.23}
RANGES = {
    "gain": (0.0, 5.0),
    "derivative": (0.0, 5.0),
    "period": (0.1, 20.0),
    "delay": (0.0, 3.0),
    "damping": (0.0, 2.0),
}
UNITS = {"gain": "V/%", "derivative": "V s/%", "period": "ms", "delay": "ms", "damping": "N s/m"}
SYMBOLS = {"gain": "s", "derivative": "d", "period": "tau", "delay": "delay/tau", "damping": "k"}

Array = NDArray[np.float64]


class Chart(NamedTuple):
    """Counted multipliers on a grid; arrays are (up, across)."""

    across: str
    up: str
    x: Array
    y: Array
    outside: NDArray[np.int64]  # multipliers outside the unit circle
    total: NDArray[np.int64]  # of all
    excess: Array  # of the largest over the unit circle
    angle: Array  # [rad] of that one; pi is half the sampling frequency
    labels: tuple[str, str]
    about: str  # what the chart is of


class Family:
    """Loops with two of their numbers to be chosen."""

    def __init__(self, numbers: Mapping[str, float], about: str) -> None:
        self.numbers, self.about = dict(numbers), about

    def loop(self, at: Mapping[str, float]) -> Loop:
        """The loop at period, delay and damping, in the chart's units."""
        raise NotImplementedError

    def label(self, axis: str) -> str:
        """An axis with its symbol or unit."""
        raise NotImplementedError

    def si(self, axis: str, value: Array) -> Array:
        """Gains as the loop takes them."""
        return value


class Plainly(Family):
    """The dimensionless actuator."""

    def __init__(self, numbers: Mapping[str, float], derivative: str = "measured", filter_time: float = 1.0) -> None:
        super().__init__({**PLAIN, **numbers}, "the dimensionless actuator, linear about its middle")
        self.derivative, self.filter_time = derivative, filter_time

    def loop(self, at: Mapping[str, float]) -> Loop:
        period = at["period"]
        timing = Timing(period, at["delay"] * period, self.derivative, self.filter_time * period)
        return sampled(actuator(at["damping"], at["gamma"]), timing)

    def label(self, axis: str) -> str:
        return f"{axis} {SYMBOLS[axis]}"


class OfRig(Family):
    """A scenario's rig about one of its points."""

    def __init__(self, scenario: Scenario, point: str = "") -> None:
        found = plants_of(scenario)
        self.scenario, self.timing = held(scenario), timing_of(scenario)
        self.plant = found[point] if point in found else next(iter(found.values()))
        own, times = gains(scenario), {"period": self.timing.period * 1e3, "delay": self.timing.delay * 1e3}
        numbers = {"gain": self.volts(own.proportional), "derivative": self.volts(own.derivative), "damping": 0.0}
        super().__init__({**numbers, **times}, f"{scenario.name}, linear about its point {self.plant.point!r}")

    def volts(self, gain: float) -> float:
        """A gain in volts per %."""
        return volts_per_percent(gain, self.scenario.rig.cylinder.stroke, self.scenario.rig.valve.full_scale)

    def loop(self, at: Mapping[str, float]) -> Loop:
        timing = self.timing._replace(period=at["period"] * 1e-3, delay=at["delay"] * 1e-3)
        a = self.plant.a - at["damping"] / self.scenario.rig.load.mass * self.plant.velocity.T @ self.plant.velocity
        return sampled(self.plant._replace(a=a), timing)

    def label(self, axis: str) -> str:
        return f"{axis} [{UNITS[axis]}]"

    def si(self, axis: str, value: Array) -> Array:
        return value * per_metre(1.0, self.scenario.rig.cylinder.stroke, self.scenario.rig.valve.full_scale)


def actuator(damping: float, gamma: float) -> Plant:
    """The dimensionless actuator about (0, 0, 1/2, 1/2), where alpha drops out."""
    a = np.array([[0.0, 1.0, 0.0], [0.0, -damping, 1.0], [0.0, -2.0, 0.0]])
    b = np.array([[0.0], [0.0], [np.sqrt(2.0) * gamma]])
    return Plant("middle", a, b, np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 1.0, 0.0]]), 0.0)


def chart(family: Family, across: str, up: str, x: Array, y: Array) -> Chart:
    """Count multipliers over two of AXES. Raises ValueError for other axes, and for a period that is not positive."""
    for axis in (across, up):
        if axis not in AXES:
            raise ValueError(f"axis {axis!r} is none of {', '.join(AXES)}")
    if across == up:
        raise ValueError(f"both axes are {across!r}; take two of {', '.join(AXES)}")
    shape = len(y), len(x)
    outside, total = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
    excess, angle = np.zeros(shape), np.zeros(shape)
    for column, value in enumerate(x.tolist()):
        for rows, found in _column(family, across, up, value, y):
            size = np.abs(found)
            worst = np.argmax(size, axis=-1)[..., None]
            outside[rows, column] = (size > 1.0 + NEUTRAL).sum(axis=-1)
            total[rows, column] = found.shape[-1]
            excess[rows, column] = np.take_along_axis(size, worst, -1)[..., 0] - 1.0
            angle[rows, column] = np.abs(np.angle(np.take_along_axis(found, worst, -1)[..., 0]))
    return Chart(
        across, up, x, y, outside, total, excess, angle, (family.label(across), family.label(up)), family.about
    )


def _column(family: Family, across: str, up: str, value: float, y: Array) -> Any:
    """Rows of one column and their multipliers: all at once where only gains change, else one by one."""
    at = {**family.numbers, across: value}
    if up in ("gain", "derivative"):
        yield slice(None), _multipliers(family, family.loop(at), {**at, up: y})
        return
    for row, other in enumerate(y.tolist()):
        here = {**at, up: other}
        yield row, _multipliers(family, family.loop(here), here)


def _multipliers(family: Family, loop: Loop, at: Mapping[str, Any]) -> NDArray[np.complex128]:
    gain, derivative = (family.si(name, np.asarray(at[name], float)) for name in ("gain", "derivative"))
    return multipliers(loop, gain, derivative)
