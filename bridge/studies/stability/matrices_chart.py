"""Charts of a rig's loop under a law given as matrices: the gain is a factor on C and D.

The matrices are for one sampling period and have no derivative gain, so that delay and damping are left for the axes.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.studies.stability.chart import UNITS, Array, OfRig
from bridge.studies.stability.sampled_law import FACTOR, of_matrices
from controller.stability import SampledLoop, Timing, sampled_loop
from controller.stability.sampled import with_system

FREE = ("gain", "delay", "damping")
POSITION, VELOCITY = 1, 2  # columns of a linear law


class OfMatrices(OfRig):
    """A scenario's rig about one of its points, under the scenario's matrices."""

    def __init__(self, scenario: Scenario, point: str = "") -> None:
        law = of_matrices(scenario)
        if law is None:
            own: Any = scenario.controller
            raise ScenarioError(
                f"controller.inputs {', '.join(own.inputs)}: a chart is of a law that reads error and velocity, or "
                "reference and position by their difference alone; `hydrotwin advise` takes any"
            )
        seen = (POSITION, VELOCITY)
        self.system = law.a, law.b[:, seen], law.c, law.d[list(seen)]
        times = {"delay": scenario.loop.delay * 1e3, "period": scenario.loop.sample_period * 1e3}
        self._about(scenario, point, {"gain": 1.0, "derivative": 0.0, "damping": 0.0, **times})

    def loop(self, at: Mapping[str, Any]) -> SampledLoop:
        plant, period = self.about_point.plant(float(np.max(at["damping"]))), self.timing.period
        return with_system(sampled_loop(plant, Timing(period, 1e-3 * at["delay"] / period)), *self.system)

    def together(self, at: Mapping[str, Any]) -> list[Any]:
        return [np.ceil(1e-3 * at["delay"] / self.timing.period), at["damping"]]

    def label(self, axis: str) -> str:
        return f"{axis} [{FACTOR if axis == 'gain' else UNITS[axis]}]"

    def fixed(self) -> dict[str, float]:
        return {name: value for name, value in super().fixed().items() if name != "derivative"}

    def si(self, axis: str, value: Array) -> Array:
        return value


def refuse_axes(*axes: str) -> None:
    """Raises ValueError for what a law given as matrices does not have."""
    for axis in axes:
        if axis not in FREE:
            raise ValueError(f"axis {axis!r}: a law given as matrices has {', '.join(FREE)}; its period is its dt")
