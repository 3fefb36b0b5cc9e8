"""Which of several numbers, changed alone, explains the recordings best? For a rig of which one thing has changed.

Each is fitted by itself, roughly as a fit begins, over shots of a second in which a wrong hypothesis still finds its
best value. What is left is compared in deviations of the noise, residuals far out tamed: a rod that sticks for a moment
decides nothing.
"""

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from bridge.errors import RunError
from bridge.studies.identification.data import Record
from bridge.studies.identification.fit import SHORT, Fitted, Values, counted, solve, spread
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.residuals import Residuals, Task
from bridge.studies.identification.simulation import shots_of
from bridge.studies.identification.taming import tamed

ROUNDS = 5
CLOSE = 2e-3  # share of what was known before, by which a further round still moves a number
WORTH = 0.95  # a change that leaves more than this share of the residual explains nothing


class Alone(NamedTuple):
    """One number, fitted by itself."""

    parameter: Parameter
    value: float  # SI
    left: float  # tamed residual, in deviations of the noise


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
        next_best = f", {others[0].left:.3g} by {others[0].parameter.name}, the next best" if others else ""
        became = f"{one.parameter.words(one.parameter.start)} became {one.parameter.words(one.value)}"
        left = f"it leaves {one.left:.3g} times the noise{next_best}, {self.before:.3g} at first"
        return f"{one.parameter.name} explains most: {became}; {left}"


def ranked(
    base: tuple[Values, float], records: Sequence[Record], parameters: Sequence[Parameter], crew: Executor | None
) -> Ranked:
    """Fit each number by itself. Raises RunError where the numbers at the start make no circuit."""
    short = spread(shots_of(records, SHORT), records)
    try:
        before = _left(Task(*base, records, (), short), crew)
    except ValueError as error:
        raise RunError(f"the rig to start with: {error}") from None
    tried = [_alone(Task(*base, records, [one], short), crew) for one in parameters]
    return Ranked(before, sorted(tried, key=lambda one: one.left))


def _alone(task: Task, crew: Executor | None) -> Alone:
    """Fit one number, and again from where that ends: the starts of the shots are those of the first places."""
    found = solve(task, np.zeros(1), SHORT, True, crew)
    moved = abs(float(found.places[0]))
    for _ in range(ROUNDS):
        if moved < CLOSE * task.parameters[0].prior:
            break
        again = solve(task, found.places, SHORT, True, crew)
        moved, found = abs(float((again.places - found.places)[0])), again
    return Alone(task.parameters[0], found.values[0], _tamed(found))


def _left(task: Task, crew: Executor | None) -> float:
    shots = Residuals(task, crew).at(np.zeros(0))
    return _tamed(Fitted(np.zeros(0), task, SHORT, shots, np.zeros((0, 0)), 0.0, 0, (), True, np.zeros(0)))


def _tamed(found: Fitted) -> float:
    return math.sqrt(sum(float((tamed(at.residual) ** 2).sum()) for at in found.shots) / max(1, counted(found)))
