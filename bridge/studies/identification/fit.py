"""The fit: least squares of the residuals, first over short shots, then over the longest that the twin can follow.

Over short shots the residual is nearly linear in the numbers and a wrong guess still finds its way; over a whole record
it says most about what is slow. So the fit begins roughly with short ones and continues with whole records. Where these
are explained much worse, the twin drifts away from the rig for a reason that no number explains: then shots of a length
between are taken, or the short ones.

A rod that sticks may all but break away: with numbers a little off it does where the rig's does not, and pressures are
off by tens of deviations until the next motion. No slope shows that, and numbers that are right otherwise are pulled
away. So, once short shots have brought the numbers near, the fit is blind to what is far out (`tamed`): the rest of
the data puts the numbers right, and with them the rod moves when it should. Where more than noise is left, the fit
continues with open eyes, and the better one is taken.
"""

import math
from collections.abc import Sequence
from concurrent.futures import Executor
from typing import Any, NamedTuple, cast

import numpy as np
from scipy.optimize import least_squares

from bridge.errors import RunError
from bridge.studies.identification.data import Array, Record
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.residuals import At, Residuals, SettledError, Task
from bridge.studies.identification.simulation import Shot, shots_of
from bridge.studies.identification.taming import tamed

SHORTEST, SHORT, BETWEEN, WHOLE = 0.2, 1.0, 5.0, math.inf  # lengths of shots [s]
MORE = 1.1  # residual, in deviations, that is more than noise
WORSE = 1.5  # by how much longer ones may be explained worse
ENOUGH, FEW = 10.0, 4.0  # [s] of short and of shortest shots, spread over all records
ROUGH = 0.03  # share of the residual that a step over short shots must be worth
REACH = 0.3  # first step of a place, at most
TOLERANCE = 1e-9  # the residuals themselves say when a step is worth nothing
MOST = 40  # evaluations of the residual
Values = Any


class Fitted(NamedTuple):
    """What a fit has found."""

    places: Array  # of the parameters
    task: Task
    length: float  # of the shots [s]; inf: whole records
    shots: list[At]
    jacobian: Array  # of the residuals, starts taken out
    cost: float  # half the sum of squares, of all with what was known before
    runs: int  # simulations of all records once
    tried: tuple[tuple[float, float], ...]  # lengths of shots, and the rms residual in deviations
    converged: bool
    steps: Array  # for slopes, in places

    @property
    def values(self) -> list[float]:
        """Of the parameters."""
        return [one.value(float(u)) for one, u in zip(self.task.parameters, self.places, strict=True)]


def fit(
    base: tuple[Values, float],
    records: Sequence[Record],
    parameters: Sequence[Parameter],
    start: Array | None = None,
    length: float | None = None,
    crew: Executor | None = None,
) -> Fitted:
    """Fit from a start (places). base: values of the rig, and the step [s]; length: of the shots, if it is given [s].

    Raises RunError where the numbers at the start make no circuit.
    """

    def over(shots: float, places: Array, rough: bool = False, blind: bool = True) -> Fitted:
        cut = shots_of(records, shots)
        cut = spread(cut, records, FEW if shots == SHORTEST else ENOUGH) if rough else cut
        steps = done[-1].steps if done else None
        found = solve(Task(*base, records, parameters, cut), places, shots, rough, crew, steps, blind)
        done.append(found)
        return found

    done: list[Fitted] = []
    places = np.zeros(len(parameters)) if start is None else start
    for shots in (SHORTEST, SHORT):
        if length is None or shots <= length:
            places = over(shots, places, True, False).places
    rough = rms(done[-1]) if done else math.inf
    if math.isfinite(rough) and rough > MORE:
        places = over(done[-1].length, places, True).places
    best: Fitted | None = None
    for shots in (length,) if length else (WHOLE, BETWEEN, SHORT):
        best = over(shots, places)
        if rms(best) > MORE:
            best = min(best, over(shots, best.places, blind=False), key=lambda one: one.cost)
        if rms(best) <= WORSE * rough:
            break
    assert best is not None
    tried = tuple((one.length, rms(one)) for one in done)
    return best._replace(tried=tried, runs=sum(one.runs for one in done))


def solve(
    task: Task,
    start: Array,
    length: float,
    rough: bool,
    crew: Executor | None = None,
    steps: Array | None = None,
    blind: bool = False,
) -> Fitted:
    """One least squares over the shots of a task.

    steps: for slopes, as another fit has found them; blind: to what is far out.
    """
    residuals = Residuals(task, crew, ROUGH if rough else 0.0, steps, blind)
    low, high = np.array([one.bounds for one in task.parameters]).T
    inside = np.clip(start, low, high)
    try:
        residuals.at(inside)
    except ValueError as error:
        raise RunError(f"the rig to start with: {error}") from None
    scale = np.minimum([one.prior for one in task.parameters], REACH)
    settled, slopes = False, cast("Any", residuals.jacobian)  # of which the stub of scipy knows the word alone
    try:
        found = least_squares(
            residuals.residual, inside, slopes, (low, high), x_scale=scale, ftol=TOLERANCE, xtol=TOLERANCE,
            max_nfev=MOST,
        )  # fmt: skip
        settled = found.status > 0
    except SettledError:
        settled = True
    places, _ = residuals.last()
    shots = residuals.at(places) if rough else residuals.afresh(places)
    left = float(sum((tamed(at.residual) ** 2).sum() for at in shots) + ((places / residuals.priors()) ** 2).sum())
    jacobian = np.zeros((0, len(places))) if rough else residuals.slopes(places)[: -len(places)]
    return Fitted(places, task, length, shots, jacobian, 0.5 * left, residuals.runs, (), settled, residuals.steps)


def spread(shots: list[Shot], records: Sequence[Record], enough: float = ENOUGH) -> list[Shot]:
    """Shots evenly over all, `enough` in time [s]."""
    lasts = sum((shot.end - shot.begin) * records[shot.record].period for shot in shots)
    return shots[:: max(1, math.floor(lasts / enough))]


def rms(found: Fitted) -> float:
    """Of the residual, in deviations of the noise."""
    squares = sum(float(at.residual @ at.residual) for at in found.shots)
    return math.sqrt(squares / max(1, counted(found.task)))


def counted(task: Task) -> int:
    """Values that are compared."""
    records = task.records
    return sum(
        int(signal.counted[shot.begin + 1 : shot.end + 1].sum())
        for shot in task.shots
        for signal in records[shot.record].signals
    )
