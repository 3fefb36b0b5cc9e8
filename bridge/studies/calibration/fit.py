"""The fit: least squares of the misses, held near the values taken without a fact, inside the ranges.

    minimise  sum (miss/scale)^2 + HOLD sum (u - u_prior)^2,   0 <= u <= 1 the place in each range,

so that a number no fact asks for stays where it was. The misses are not smooth (friction, valves, vapour) and the work
is bounded: differential evolution about a start, then a pattern search along each number in ever smaller steps.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from bridge.studies.calibration.choices import CHOICES, chosen, overrides, priors
from bridge.studies.calibration.facts import evaluate, misses

HOLD = 0.3
OUTER = (502, 1230)  # [rpm]: the fit runs these, the speeds between follow
POPULATION = 3  # per number
SPREAD = 0.25  # of the crowd about the start
FIRST, LAST = 0.1, 2e-3  # widths of the pattern
ENOUGH = 0.01  # a lower share of the cost is not worth another round at the same width
WORST = 1e4  # cost of numbers that make no circuit
Array = NDArray[np.float64]
Weights = Mapping[str, float]


class Fitted(NamedTuple):
    """What a fit has found."""

    shares: Array  # places in the ranges
    cost: float
    evaluations: int


class Budget:
    """Costs until the time is up; it remembers the best."""

    def __init__(self, cost: Callable[[Array], float], seconds: float, start: Array) -> None:
        self._cost, self._end = cost, time.monotonic() + seconds
        self.cost, self.shares, self.evaluations = np.inf, start, 0

    @property
    def spent(self) -> bool:
        """Is the time up?"""
        return time.monotonic() > self._end

    def __call__(self, shares: Array) -> float:
        if self.spent:
            return WORST
        self.evaluations += 1
        cost = self._cost(shares)
        if cost < self.cost:
            self.cost, self.shares = cost, np.array(shares)
        return cost

    def fitted(self) -> Fitted:
        """The best so far."""
        return Fitted(self.shares, self.cost, self.evaluations)


def cost(shares: Array, weights: Weights) -> float:
    """What the fit makes small."""
    try:
        found = evaluate(overrides(chosen(shares)), OUTER)
    except ValueError:
        return WORST
    return float((misses(found, weights) ** 2).sum() + HOLD * ((shares - priors()) ** 2).sum())


def evolve(start: Array, seconds: float, weights: Weights, seed: int = 1) -> Fitted:
    """Differential evolution for some time [s], from a crowd about the start and over the ranges."""
    budget = Budget(lambda shares: cost(shares, weights), seconds, start)
    crowd = np.random.default_rng(seed).random((POPULATION * len(CHOICES), len(CHOICES)))
    crowd[::2] = np.clip(start + SPREAD * (crowd[::2] - 0.5), 0.0, 1.0)
    crowd[0] = start
    start_of: Any = crowd  # of which the stub of scipy knows the word alone
    differential_evolution(
        budget, [(0.0, 1.0)] * len(CHOICES), init=start_of, maxiter=1000, polish=False, rng=seed,
        callback=lambda *_: budget.spent,
    )  # fmt: skip
    return budget.fitted()


def refine(start: Array, seconds: float, weights: Weights) -> Fitted:
    """Pattern search for some time [s]: each number a width up or down, the width halved when a round brings little."""
    budget = Budget(lambda shares: cost(shares, weights), seconds, start)
    budget(start)
    width = FIRST
    while width > LAST and not budget.spent:
        before = budget.cost
        for number in range(len(CHOICES)):
            _either_way(budget, number, width)
        if budget.cost > (1.0 - ENOUGH) * before:
            width *= 0.5
    return budget.fitted()


def _either_way(budget: Budget, number: int, width: float) -> None:
    for step in (width, -width):
        trial = budget.shares.copy()
        trial[number] = min(max(trial[number] + step, 0.0), 1.0)
        if trial[number] != budget.shares[number]:
            budget(trial)
