"""What the valve does after a long time: calm, a free swing, one that hits the seat; and exact period-one orbits.

Section: the highest lifts, y2 = 0 from above. 4.4.3 of the thesis, whose pages are lost.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.chatter.equilibrium import rest
from twin.chatter.flight import HIT, TOP, Point, next_event
from twin.chatter.system import System
from twin.kernel import allocating_kernel, kernel

Array = NDArray[np.floating]
TOLERANCE = 1e-10  # of a step, in steady lifts


class Motion(NamedTuple):
    """The last tops of a run, an entry each: its lift and pressure, its time, hardest impact since the one before."""

    lift: Array
    pressure: Array
    time: Array
    impact: Array  # speed, >= 0; 0.0: none
    hits: Array  # impacts since the top before


@allocating_kernel
def tops(y1: float, y2: float, y3: float, skip: int, count: int, tolerance: float, scale: float, s: System) -> Array:
    """Rows of lift, pressure, time, hardest impact, impacts: of `count` tops after `skip` of them, (count, 5).

    Fewer where the poppet comes to rest without a top.
    """
    rows = np.empty((count, 5))
    at = Point(0.0, y1, y2, y3, 1e-3, 0.0)
    n, hardest, hits = 0, 0.0, 0.0
    for _ in range(2000 * (skip + count)):
        at = next_event(at, 1e300, tolerance * scale, scale, s)
        if at.event == HIT:
            hardest, hits = max(hardest, -at.y2), hits + 1.0
        elif at.event == TOP:
            if n >= skip:
                k = n - skip
                rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4] = at.y1, at.y3, at.time, hardest, hits
            n, hardest, hits = n + 1, 0.0, 0.0
            if n == skip + count:
                return rows
        else:
            break
    return rows[: max(0, n - skip)]


def motion(s: System, start: tuple[float, float, float], skip: int, count: int, tolerance: float = TOLERANCE) -> Motion:
    """A run from a start (y1, y2, y3), `count` tops after the first `skip`."""
    scale = rest(s).lift
    return Motion(*tops(*start, skip, count, tolerance, scale, s).T)


@kernel
def next_top(
    y1: float, y3: float, tolerance: float, scale: float, s: System
) -> tuple[float, float, float, float, float]:
    """From a top to the next: lift, pressure, time between, hardest impact, impacts."""
    at = Point(0.0, y1, 0.0, y3, 1e-3, 0.0)
    hardest, hits = 0.0, 0.0
    for _ in range(1000):
        at = next_event(at, 1e300, tolerance * scale, scale, s)
        if at.event != HIT:
            break
        hardest, hits = max(hardest, -at.y2), hits + 1.0
    return at.y1, at.y3, at.time, hardest, hits


class ImpactOrbit(NamedTuple):
    """A period-one orbit: once up and down, one impact or none."""

    lift: float  # highest y1
    pressure: float  # y3 there
    period: float
    impact: float  # speed into the seat; 0.0: it does not touch
    multiplier: float  # greatest modulus: below 1 it is stable

    @property
    def frequency(self) -> float:
        """In units of that of poppet and spring."""
        return 2.0 * math.pi / self.period


def impact_orbit(s: System, tolerance: float = 1e-12, settle: int = 4000) -> ImpactOrbit:
    """The period-one orbit that a valve twice as far open as in equilibrium settles into, by Newton on the map of tops.

    Raises ValueError where it does not settle there: a longer period, or chaos, or a calm valve.
    """
    at, scale = rest(s), rest(s).lift
    run = motion(s, (2.0 * at.lift, 0.0, at.pressure), settle, 1, 1e-9)
    x = np.array([run.lift[0], run.pressure[0]]) if len(run.lift) else np.zeros(2)  # no top: it crept to its rest
    for _ in range(30 if len(run.lift) else 0):
        value, slope = _map(x, tolerance, scale, s)
        change = np.linalg.solve(slope - np.eye(2), x - value[:2])
        x = x + change
        if not (x[0] > 0.0 and x[1] > 0.0):
            break
        if np.abs(change).max() <= 1e-9 * scale:
            lift, pressure, period, impact, hits = next_top(x[0], x[1], tolerance, scale, s)
            multiplier = float(np.abs(np.linalg.eigvals(_map(x, tolerance, scale, s)[1])).max())
            if hits > 1.0 or abs(lift - at.lift) < 1e-6 * scale:
                break
            return ImpactOrbit(lift, pressure, period, impact, multiplier)
    raise ValueError(f"no period-one orbit at q = {s.flow:.4g}, k = {s.damping:.4g}, e = {s.precompression:.4g}")


def _map(x: Array, tolerance: float, scale: float, s: System) -> tuple[Array, Array]:
    """The next top, (5), and the derivatives of its lift and pressure by differences, (2, 2)."""
    value = np.array(next_top(x[0], x[1], tolerance, scale, s))
    columns = []
    for k in range(2):
        d = 1e-5 * scale
        moved = [x + sign * d * np.eye(2)[k] for sign in (1.0, -1.0)]
        ahead, behind = (next_top(float(y[0]), float(y[1]), tolerance, scale, s) for y in moved)
        columns.append((np.array(ahead[:2]) - np.array(behind[:2])) / (2.0 * d))
    return value, np.array(columns).T


def orbit_error(s: System, fine: float = 1e-12, coarse: float = 1e-9) -> ImpactOrbit:
    """By how much period, lift, pressure and impact speed change from a coarse tolerance to a fine one, relative."""
    a, b = impact_orbit(s, coarse), impact_orbit(s, fine)
    return ImpactOrbit(*(abs(x - y) / max(abs(y), 1e-300) for x, y in zip(a, b, strict=True)))
