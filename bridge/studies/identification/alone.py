"""Which of several numbers, changed alone, explains the recordings best? For a rig of which one thing has changed.

Each is fitted by itself, over shots of a second in which a wrong hypothesis still finds its best value. One needs
no slopes, which end a fit early where the residual is rough: it is looked for at places ever farther off to both sides,
then between the best one and its neighbours (R. Brent, Algorithms for Minimization without Derivatives, 1973). What is
left is compared in deviations of the noise, residuals far out tamed: a rod that sticks for a moment decides nothing.
"""

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from bridge.errors import RunError
from bridge.studies.identification.data import Array, Record
from bridge.studies.identification.fit import ROUGH, SHORT, Values, counted, spread
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.residuals import At, Residuals, Task
from bridge.studies.identification.simulation import shots_of
from bridge.studies.identification.taming import tamed

AROUND = (0.003, 0.01, 0.03, 0.07, 0.12, 0.2, 0.35, 0.6, 1.0, 1.5, 2.0)  # places tried, in deviations known before
CLOSE = 1e-4  # of these deviations, at which the search between places ends
MOST = 25  # places of that search
WORTH = 0.8  # a change that leaves more than this share of the residual explains nothing


class Alone(NamedTuple):
    """One number, fitted by itself."""

    parameter: Parameter
    place: float  # of the parameter: of a positive number the logarithm over its start
    left: float  # tamed residual, in deviations of the noise
    runs: int = 0  # simulations of all its stretches once

    @property
    def value(self) -> float:
        """SI."""
        return self.parameter.value(self.place)


class Ranked(NamedTuple):
    """All of them, the best first."""

    before: float  # left with the numbers to start with
    tried: list[Alone]

    @property
    def best(self) -> Alone | None:
        """The one that explains most; None where none explains anything."""
        first = self.tried[0]
        return first if first.left <= WORTH * self.before else None

    @property
    def words(self) -> str:
        """In one sentence."""
        if self.best is None:
            return (
                f"none of them explains what has changed: {self.before:.3g} times the noise are left with the numbers "
                f"at first, {self.tried[0].left:.3g} at best"
            )
        one, others = self.best, self.tried[1:]
        next_best = f"{others[0].parameter.name}, the next best, {others[0].left:.3g}, and " if others else ""
        left = f"alone it leaves {one.left:.3g} times the noise over stretches of {SHORT:g} s"
        return f"{one.parameter.name} explains most: {left}; {next_best}the numbers at first {self.before:.3g}"


def ranked(
    base: tuple[Values, float], records: Sequence[Record], parameters: Sequence[Parameter], crew: Executor | None
) -> Ranked:
    """Fit each number by itself. Raises RunError where the numbers at the start make no circuit."""
    short = spread(shots_of(records, SHORT), records)
    try:
        before = _left(Task(*base, records, (), short), np.zeros(0), crew)
    except ValueError as error:
        raise RunError(f"the rig to start with: {error}") from None
    tried = [_alone(Task(*base, records, [one], short), crew) for one in parameters]
    return Ranked(before, sorted(tried, key=lambda one: one.left))


def _alone(task: Task, crew: Executor | None) -> Alone:
    """Fit one number; what the starts of the shots explain is found anew where that ends."""
    one, residuals = task.parameters[0], Residuals(task, crew, ROUGH)

    def left(place: float) -> float:
        try:
            return _tamed(task, residuals.at(np.array([place])))
        except ValueError:  # no circuit
            return math.inf

    low, high = one.bounds
    aside = (way * share * one.prior for share in AROUND for way in (-1.0, 1.0))
    places = sorted({0.0, *(min(max(place, low), high) for place in aside)})
    found = [left(place) for place in places]
    best = int(np.argmin(found))
    ends = places[max(0, best - 1)], places[min(len(places) - 1, best + 1)]
    options = {"xatol": CLOSE * one.prior, "maxiter": MOST}
    between: Any = minimize_scalar(left, bounds=ends, method="bounded", options=options)
    place = float(between.x) if between.fun < found[best] else places[best]
    afresh = Residuals(task, crew)
    final = _tamed(task, afresh.at(np.array([place])))
    return Alone(one, place, final, residuals.runs + afresh.runs)


def _left(task: Task, places: Array, crew: Executor | None) -> float:
    return _tamed(task, Residuals(task, crew).at(places))


def _tamed(task: Task, shots: Sequence[At]) -> float:
    return math.sqrt(sum(float((tamed(at.residual) ** 2).sum()) for at in shots) / max(1, counted(task)))
