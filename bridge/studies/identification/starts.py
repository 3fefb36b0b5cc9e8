"""Fits over short shots from several starts: does another one end somewhere better?

Starts fill what is known before evenly (a Latin hypercube), the first is the scenario's own. Each is a point of a
sweep, so that they run on all cores or on a cluster, and an interrupted search continues.
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.stats import qmc

from bridge.errors import RunError
from bridge.studies.identification.data import Array
from bridge.studies.identification.fit import SHORT, rms, solve, spread
from bridge.studies.identification.parameters import Parameter
from bridge.studies.identification.residuals import Task
from bridge.studies.identification.simulation import shots_of
from bridge.studies.sweep.engine import Crew, sweep
from bridge.studies.sweep.journal import Point, Result

if TYPE_CHECKING:
    from bridge.studies.identification.identify import Wanted

FAR = 1.0  # places of a start, at most, to either side: a factor of 2.7
SAME = 0.02  # share by which the rms residuals of one minimum differ


class Starts(NamedTuple):
    """Fits from several starts."""

    best: Array  # places
    rms: list[float | None]  # residual of each, in deviations; None where the rig is impossible
    same: int  # that ended as well as the best

    @property
    def words(self) -> str:
        """In one sentence."""
        tried = [value for value in self.rms if value is not None]
        own = self.rms[0]
        ended = f"{self.same} of {len(self.rms)} starts end in the same minimum"
        worse = f", the others up to {max(tried) / min(tried):.3g} times as far from the data"
        own_words = "" if own is None or own <= (1.0 + SAME) * min(tried) else "; the scenario's own does not"
        return ended + (worse if self.same < len(tried) else "") + own_words


def from_several(
    wanted: "Wanted", parameters: Sequence[Parameter], count: int, part: Path | None, crew: Crew
) -> Starts:
    """Fit from so many starts. Raises RunError when none is possible."""
    points = [{"places": place} for place in places_of(parameters, count)]
    task = partial(rough, wanted=wanted._asdict())
    found = sweep(task, points, {"title": "starts", **wanted._asdict()}, part, crew)
    tried = [result["rms"] for result in found]
    possible = [value for value in tried if value is not None]
    if not possible:
        raise RunError("none of the starts makes a rig")
    best = found[tried.index(min(possible))]
    same = sum(value <= (1.0 + SAME) * min(possible) for value in possible)
    return Starts(np.array(best["places"]), tried, same)


def places_of(parameters: Sequence[Parameter], count: int) -> list[list[float]]:
    """Places of the starts, the first at the scenario's own numbers."""
    low, high = np.array([one.bounds for one in parameters]).T
    reach = np.minimum([one.prior for one in parameters], FAR)
    low, high = np.maximum(low, -reach), np.minimum(high, reach)
    shares = qmc.LatinHypercube(len(parameters), rng=1).random(count - 1)
    return [[0.0] * len(parameters), *(low + shares * (high - low)).tolist()]


def rough(point: Point, wanted: dict[str, Any]) -> Result:
    """A fit over short shots from one start."""
    from bridge.studies.identification.identify import Wanted, prepared

    ready = prepared(Wanted(**wanted))
    shots = spread(shots_of(ready.records, SHORT), ready.records)
    task = Task(*ready.base, ready.records, ready.parameters, shots)
    try:
        found = solve(task, np.array(point["places"]), SHORT, True)
    except RunError:
        return {"rms": None, "places": point["places"]}
    return {"rms": rms(found), "places": found.places.tolist()}
