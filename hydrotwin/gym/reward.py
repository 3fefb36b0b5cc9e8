"""What a step of the environment was like, and what it is worth."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import UsageError, nearest
from bridge.scenario import Scenario
from bridge.scenario.units import quantity
from controller.reference import Target
from twin.topology import OBSERVED


class Step(NamedTuple):
    """One step of the environment, for a reward of your own; the true quantities, SI."""

    scenario: Scenario  # of this episode
    time: float  # [s], at the end of the step
    target: Target  # position [m] and velocity [m/s] that the reference asks for
    position: float  # [m]
    velocity: float  # [m/s]
    action: float  # -1..1
    previous: float  # action of the step before, 0.0 at first
    bands: int  # how many there are
    broken: list[str]  # of these, within the step
    ended: str  # why the episode was terminated; empty while it was not
    left: int  # steps to the end of the scenario
    rows: NDArray[np.float64]  # one per tick of the step, in the order of twin.topology.OBSERVED

    @property
    def error(self) -> float:
        """Reference - position [m]."""
        return self.target.position - self.position

    def greatest(self, name: str) -> float:
        """Of a true quantity within the step, such as "p_lower"."""
        return float(self._column(name).max())

    def least(self, name: str) -> float:
        """Of a true quantity within the step."""
        return float(self._column(name).min())

    def _column(self, name: str) -> NDArray[np.float64]:
        if name not in OBSERVED:
            raise UsageError(f"no signal {name!r}{nearest(name, OBSERVED)}")
        return self.rows[:, [*OBSERVED].index(name)]


Reward = Callable[[Step], float]


class Tracking:
    """-(|error|/error_size + change_cost |action - previous| + band_cost * number of bands broken).

    An episode that is terminated pays for each step left the most that a step can cost, so that none is better off
    for ending early.
    """

    def __init__(self, error_size: float | str = 0.01, change_cost: float = 0.1, band_cost: float = 1.0) -> None:
        self.error_size = _positive("error_size", error_size)
        self.change_cost = change_cost
        self.band_cost = band_cost

    def __call__(self, step: Step) -> float:
        """The reward of a step."""
        change = self.change_cost * abs(step.action - step.previous)
        cost = abs(step.error) / self.error_size + change + self.band_cost * len(step.broken)
        return -(cost + step.left * self.most(step)) if step.ended else -cost

    def most(self, step: Step) -> float:
        """What a step can cost; a reference is at most one stroke outside the stroke."""
        farthest = 2.0 * step.scenario.rig.cylinder.stroke
        return farthest / self.error_size + 2.0 * self.change_cost + self.band_cost * step.bands


def _positive(name: str, value: float | str) -> float:
    try:
        found = quantity(value, "m")
    except ValueError as error:
        raise UsageError(f"{name}: {error}") from None
    if not found > 0.0:
        raise UsageError(f"{name} {value!r}: must be above 0, such as '10 mm'")
    return found
