"""A long curve as a page can show it: of each stretch the mean, and how far the curve went in it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

STRETCHES = 900  # of a curve, more than a page shows

Array = NDArray[np.float64]


class ThinCurve(NamedTuple):
    """A curve, thinned."""

    time: Array  # [s], middle of each stretch
    mean: Array
    least: Array
    greatest: Array


def thinned(time: Array, values: Array, stretches: int = STRETCHES) -> ThinCurve:
    """A curve in so many stretches, peaks kept; a short one as it is. Of a stretch what is not NaN counts."""
    if len(time) <= stretches:
        return ThinCurve(time, values, values, values)
    spans = list(pairwise(np.linspace(0, len(time), stretches + 1).astype(int)))
    parts = [_known(values[begin:end]) for begin, end in spans]
    middle = np.array([0.5 * (time[begin] + time[end - 1]) for begin, end in spans])
    mean, least, greatest = (np.array([of(part) for part in parts], float) for of in (np.mean, np.min, np.max))
    return ThinCurve(middle, mean, least, greatest)


def _known(values: Array) -> Array:
    """What is not NaN; one NaN where all is."""
    there = ~np.isnan(values)
    return values if there.all() else values[there] if there.any() else values[:1]
