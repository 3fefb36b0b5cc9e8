"""A smooth curve through a few points, as kernels read it: cubic between the points, as monotone as they are.

Slopes at the points are those of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984), so that value and slope are
continuous and nothing overshoots. Beyond its ends a curve stays at its last value.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from twin.kernel import inlined

Points = Sequence[tuple[float, float]]
MOST_POINTS = 10


class Curve(NamedTuple):
    """Places, values and slopes; those after the last point repeat it, at infinity."""

    x_0: float
    x_1: float
    x_2: float
    x_3: float
    x_4: float
    x_5: float
    x_6: float
    x_7: float
    x_8: float
    x_9: float
    y_0: float
    y_1: float
    y_2: float
    y_3: float
    y_4: float
    y_5: float
    y_6: float
    y_7: float
    y_8: float
    y_9: float
    s_0: float
    s_1: float
    s_2: float
    s_3: float
    s_4: float
    s_5: float
    s_6: float
    s_7: float
    s_8: float
    s_9: float


def curve_through(points: Points) -> Curve:
    """The curve through points (x, y), 1 to MOST_POINTS, x rising."""
    x, y = zip(*points, strict=True)
    unused = MOST_POINTS - len(x)
    slopes = _slopes(x, y)
    return Curve(*x, *[math.inf] * unused, *y, *[y[-1]] * unused, *slopes, *[0.0] * unused)


def _slopes(x: Sequence[float], y: Sequence[float]) -> list[float]:
    """Slopes at the points: weighted harmonic means inside, a parabola's at the ends; 0.0 at an extremum."""
    if len(x) == 1:
        return [0.0]
    h = [b - a for a, b in pairwise(x)]
    d = [(b - a) / width for (a, b), width in zip(pairwise(y), h, strict=True)]
    if len(x) == 2:
        return [d[0], d[0]]
    inner = [_inner_slope(*h[i : i + 2], *d[i : i + 2]) for i in range(len(h) - 1)]
    return [_end_slope(h[0], h[1], d[0], d[1]), *inner, _end_slope(h[-1], h[-2], d[-1], d[-2])]


def _inner_slope(h_1: float, h_2: float, d_1: float, d_2: float) -> float:
    if d_1 * d_2 <= 0.0:
        return 0.0
    return 3.0 * (h_1 + h_2) / ((2.0 * h_2 + h_1) / d_1 + (h_2 + 2.0 * h_1) / d_2)


def _end_slope(h_1: float, h_2: float, d_1: float, d_2: float) -> float:
    slope = ((2.0 * h_1 + h_2) * d_1 - h_1 * d_2) / (h_1 + h_2)
    if slope * d_1 <= 0.0:
        return 0.0
    return 3.0 * d_1 if d_1 * d_2 <= 0.0 and abs(slope) > 3.0 * abs(d_1) else slope


@inlined
def _places(c: Curve) -> tuple[float, ...]:
    """A record has no order that a kernel could go through."""
    return c.x_0, c.x_1, c.x_2, c.x_3, c.x_4, c.x_5, c.x_6, c.x_7, c.x_8, c.x_9


@inlined
def _values(c: Curve) -> tuple[float, ...]:
    return c.y_0, c.y_1, c.y_2, c.y_3, c.y_4, c.y_5, c.y_6, c.y_7, c.y_8, c.y_9


@inlined
def _steepness(c: Curve) -> tuple[float, ...]:
    return c.s_0, c.s_1, c.s_2, c.s_3, c.s_4, c.s_5, c.s_6, c.s_7, c.s_8, c.s_9


@inlined
def value_and_slope(x: float, curve: Curve) -> tuple[float, float]:
    """y and dy/dx at a place."""
    places, values, slopes = _places(curve), _values(curve), _steepness(curve)
    if x < places[0]:
        return values[0], 0.0
    i = 1
    while i < MOST_POINTS - 1 and x > places[i]:
        i += 1
    h = places[i] - places[i - 1]
    if math.isinf(h) or x > places[i]:
        return (values[i - 1] if math.isinf(h) else values[i]), 0.0
    t, d = (x - places[i - 1]) / h, values[i] - values[i - 1]
    a, b = h * slopes[i - 1] - d, d - h * slopes[i]
    y = values[i - 1] + t * d + t * (1.0 - t) * ((1.0 - t) * a + t * b)
    bend = (1.0 - 2.0 * t) * ((1.0 - t) * a + t * b) + t * (1.0 - t) * (b - a)
    return y, (d + bend) / h
