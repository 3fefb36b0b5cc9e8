"""Charts of stability over any two numbers of a loop: counted multipliers on a grid, dimensionless or of a rig.

Dimensionless: `controller.stability.linear_actuator`; delay and filter time in sampling periods. Of a rig: gains in V/%
and V s/%, times in ms, damping in N s/m.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import nearest
from bridge.scenario import Scenario
from bridge.scenario.gains import gains
from bridge.studies.stability.advice import at_reference_end, plants_of, refuse_linear
from bridge.studies.stability.rig_loop import timing_of
from controller.law import per_metre, volts_per_percent
from controller.stability import SampledLoop, Timing, closed, linear_actuator, multipliers, sampled_loop
from controller.stability.crossing import inside

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
UNITS |= {"mass": "kg", "position": "mm", "opening": "%", "filter time": "ms"}
SYMBOLS = {"gain": "s", "derivative": "d", "period": "tau", "delay": "delay/tau", "damping": "k"}

Array = NDArray[np.float64]


class Chart(NamedTuple):
    """Counted multipliers on a grid; arrays are (up, across)."""

    across: str
    up: str
    x: Array
    y: Array
    outside: NDArray[np.int64]  # multipliers on or outside the unit circle; 0 is stable
    total: NDArray[np.int64]  # of all
    excess: Array  # of the largest over the unit circle
    angle: Array  # [rad] of that one; pi is half the sampling frequency
    labels: tuple[str, str]
    about: str  # what the chart is of
    fixed: dict[str, float]  # the numbers that are not on an axis, by their label
    numbers: dict[str, float]  # the same by their name


class Family:
    """Loops with two of their numbers to be chosen."""

    def __init__(self, numbers: Mapping[str, float], about: str) -> None:
        self.numbers, self.about = dict(numbers), about

    def loop(self, at: Mapping[str, Any]) -> SampledLoop:
        """The loop at period, delay and damping, in the chart's units; arrays that go together give a stack."""
        raise NotImplementedError

    def together(self, at: Mapping[str, Any]) -> list[Any]:
        """What loops that can be had as one stack have in common: arrays or numbers, equal for them."""
        raise NotImplementedError

    def label(self, axis: str) -> str:
        """A number with its symbol or unit."""
        raise NotImplementedError

    def fixed(self) -> dict[str, float]:
        """All numbers that decide a loop of the family, by their name."""
        return self.numbers

    def si(self, axis: str, value: Array) -> Array:
        """Gains as the loop takes them."""
        return value


class Plainly(Family):
    """The dimensionless actuator."""

    def __init__(self, numbers: Mapping[str, float], derivative: str = "measured", filter_time: float = 1.0) -> None:
        super().__init__({**PLAIN, **numbers}, "the dimensionless actuator, linear about its middle")
        self.derivative, self.filter_time = derivative, filter_time

    def loop(self, at: Mapping[str, Any]) -> SampledLoop:
        plant = linear_actuator(at["damping"], at["gamma"])
        return sampled_loop(plant, Timing(at["period"], at["delay"], self.derivative, self.filter_time))

    def together(self, at: Mapping[str, Any]) -> list[Any]:
        return [np.ceil(at["delay"])]

    def label(self, axis: str) -> str:
        return f"{axis} {SYMBOLS[axis]}" if axis in SYMBOLS else axis

    def fixed(self) -> dict[str, float]:
        lag = {"filter time/tau": self.filter_time} if self.derivative == "filtered" else {}
        return {name: value for name, value in self.numbers.items() if name in PLAIN} | lag


class OfRig(Family):
    """A scenario's rig about one of its points."""

    def __init__(self, scenario: Scenario, point: str = "") -> None:
        refuse_linear(scenario)
        own, loop = gains(scenario), scenario.loop
        times = {"period": loop.sample_period * 1e3, "delay": loop.delay * 1e3}
        self.scenario = scenario
        numbers = {"gain": self.volts(own.proportional), "derivative": self.volts(own.derivative), "damping": 0.0}
        self._about(scenario, point, {**numbers, **times})

    def _about(self, scenario: Scenario, point: str, numbers: Mapping[str, float]) -> None:
        """Take the rig about a point, or about its first one."""
        found = plants_of(scenario)
        self.asked, self.scenario, self.timing = scenario, at_reference_end(scenario), timing_of(scenario)
        self.about_point = found[point] if point in found else next(iter(found.values()))
        super().__init__(numbers, f"{scenario.name}, linear about its point {self.about_point.point!r}")

    def volts(self, gain: float) -> float:
        """A gain in volts per %."""
        return volts_per_percent(gain, self.scenario.rig.cylinder.stroke, self.scenario.rig.valve.full_scale)

    def loop(self, at: Mapping[str, Any]) -> SampledLoop:
        plant, period = self.about_point.plant(float(np.max(at["damping"]))), 1e-3 * np.asarray(at["period"])
        lag = self.timing.filter_time / float(np.max(period))
        return sampled_loop(plant, Timing(period, at["delay"] / at["period"], self.timing.derivative, lag))

    def together(self, at: Mapping[str, Any]) -> list[Any]:
        lag = [at["period"]] if self.timing.derivative == "filtered" else []
        return [np.ceil(at["delay"] / at["period"]), at["damping"], *lag]

    def label(self, axis: str) -> str:
        return f"{axis} [{UNITS[axis]}]"

    def fixed(self) -> dict[str, float]:
        rig = self.scenario.rig
        lag = {"filter time": 1e3 * self.timing.filter_time} if self.timing.derivative == "filtered" else {}
        own = {"mass": rig.load.mass, "position": 1e3 * self.scenario.start.position}
        return self.numbers | own | {"opening": 1e2 * self.about_point.opening} | lag

    def si(self, axis: str, value: Array) -> Array:
        return value * per_metre(1.0, self.scenario.rig.cylinder.stroke, self.scenario.rig.valve.full_scale)


def chart(
    family: Family, across: str, up: str, x: Array, y: Array, goes_on: Callable[[int], bool] = lambda done: True
) -> Chart:
    """Count multipliers over two of AXES. Raises ValueError for other axes, and for a period that is not positive.

    goes_on: asked before each column, by the number that are there; where it says no the chart ends with them.
    """
    for axis in (across, up):
        if axis not in AXES:
            raise ValueError(f"axis {axis!r} is unknown{nearest(axis, AXES)}")
    if across == up:
        raise ValueError(f"both axes are {across!r}; take two of {', '.join(AXES)}")
    shape = len(y), len(x)
    outside, total = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
    excess, angle = np.zeros(shape), np.zeros(shape)
    for column, value in enumerate(x.tolist()):
        if not goes_on(column):
            x, outside, total = x[:column], outside[:, :column], total[:, :column]
            excess, angle = excess[:, :column], angle[:, :column]
            break
        for rows, mu in _column(family, {**family.numbers, across: value}, up, y):
            worst = np.take_along_axis(mu, np.argmax(np.abs(mu), axis=-1)[..., None], -1)[..., 0]
            total[rows, column] = mu.shape[-1]
            outside[rows, column] = mu.shape[-1] - inside(mu).sum(axis=-1)
            excess[rows, column], angle[rows, column] = np.abs(worst) - 1.0, np.abs(np.angle(worst))
    labels = family.label(across), family.label(up)
    numbers = {name: value for name, value in family.fixed().items() if name not in (across, up)}
    fixed = {family.label(name): value for name, value in numbers.items()}
    return Chart(across, up, x, y, outside, total, excess, angle, labels, family.about, fixed, numbers)


def _column(family: Family, at: Mapping[str, float], up: str, y: Array) -> Iterator[tuple[Any, NDArray[np.complex128]]]:
    """Rows of one column and their multipliers (rows, n), as many at once as matrices of one size allow."""
    if up in ("gain", "derivative"):
        yield slice(None), _multipliers(family, {**at, up: y})
        return
    shared = np.stack(np.broadcast_arrays(y, *family.together({**at, up: y}))[1:], axis=-1)
    groups = np.unique(shared, axis=0, return_inverse=True)[1].ravel()
    for group in range(groups.max() + 1):
        rows = np.flatnonzero(groups == group)
        yield rows, _multipliers(family, {**at, up: y[rows]})


def _multipliers(family: Family, at: Mapping[str, Any]) -> NDArray[np.complex128]:
    gain, derivative = (family.si(name, np.asarray(at[name], float)) for name in ("gain", "derivative"))
    return multipliers(closed(family.loop(at), gain, derivative))
