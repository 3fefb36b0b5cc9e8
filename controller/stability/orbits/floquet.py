"""What a periodic orbit does to its neighbours, and how far it swings.

Multipliers are eigenvalues of the derivative of the motion over a period. At the switch of a relay the field jumps from
f to f': saltation 1 + (f' - f) n^T/(n^T f), n = (s, d, 0, 0), of determinant 1 because n^T f = n^T f' (5.13); the field
of a proportional valve is continuous there. One multiplier is 1, along the orbit. An orbit whose pressures pass
supply and return has two more that are 0: there the pressures follow the speed, whatever they were before.
"""

import numpy as np
from scipy.optimize import brentq

from controller.stability.actuator.model import Array, mirror
from controller.stability.orbits.arc import (
    RELAY,
    Loop,
    derivatives,
    end_rates,
    follow,
)
from controller.stability.orbits.limit_cycle import (
    MIRROR,
    TOLERANCE,
    Orbit,
    arc,
)

INTERVALS = 64  # of an arc, between which at most one turning of a state is looked for


def monodromy_of(orbit: Orbit) -> Array:
    """Derivative (4, 4) of the motion over all arcs, seen through as many mirrors."""
    flow, normal = np.eye(4), np.array([*orbit.loop.gains, 0.0, 0.0])
    for i in range(len(orbit.lengths)):
        row = arc(orbit, i)
        flow = derivatives(row)[:, :4] @ flow
        if orbit.loop.kind == RELAY:
            before = end_rates(row[:4], orbit.loop)
            after = MIRROR @ end_rates(mirror(row[:4]), orbit.loop)
            flow += np.outer(after - before, normal @ flow) / (normal @ before)
        flow = MIRROR @ flow
    return flow


def orbit_multipliers(orbit: Orbit) -> Array:
    """Floquet multipliers (4,) over the period, the largest first."""
    found = np.linalg.eigvals(monodromy_of(orbit)) ** orbit.laps
    return np.array(sorted(found, key=abs, reverse=True))


def other_multipliers(orbit: Orbit) -> Array:
    """The three that are left without the one along the orbit."""
    found = list(orbit_multipliers(orbit))
    found.pop(int(np.argmin([abs(mu - 1.0) for mu in found])))
    return np.array(found)


def attracts(orbit: Orbit) -> bool:
    """Are all multipliers but the one along the orbit inside the unit circle?"""
    return float(np.abs(other_multipliers(orbit)).max()) < 1.0


def samples(orbit: Orbit, i: int, count: int = INTERVALS) -> tuple[Array, Array]:
    """Times (count + 1,) and states (count + 1, 4) along arc i, seen with h <= 0."""
    states = [orbit.starts[i]]
    for _ in range(count):
        states.append(_along(states[-1], orbit.lengths[i] / count, orbit.loop))
    return np.linspace(0.0, orbit.lengths[i], count + 1), np.array(states)


def _along(y: Array, time: float, loop: Loop) -> Array:
    return follow(y, time, loop, TOLERANCE, False)[0][:4] if time > 0.0 else y


def is_one_sided(orbit: Orbit) -> bool:
    """Does h stay below 0 within every arc? If not, the orbit has switchings that its equations do not know of."""
    s, d = orbit.loop.gains
    return all((samples(orbit, i, INTERVALS // 4)[1][1:-1, :2] @ (s, d) < 0.0).all() for i in range(len(orbit.lengths)))


def profile(orbit: Orbit, count: int = INTERVALS) -> tuple[Array, Array]:
    """Times (n,) and states (n, 4) over a whole period; both ends of every arc are given."""
    times, states, time = [], [], 0.0
    for i in range(orbit.laps * len(orbit.lengths)):
        t, y = samples(orbit, i % len(orbit.lengths), count)
        times.append(time + t)
        states.append(mirror(y) if i % 2 else y)
        time += t[-1]
    return np.concatenate(times), np.concatenate(states)


def peaks(orbit: Orbit) -> Array:
    """Greatest y1 .. y4 (4,) over the period: at an end of an arc, or where the rate passes through 0."""
    tops = []
    for i in range(len(orbit.lengths)):
        high, low = _extremes(orbit, i)
        other = np.array([-low[0], -low[1], high[3], high[2]])
        tops.append((high, other))
    if len(tops) % 2:
        return np.max(tops, axis=(0, 1))
    return np.max([top[i % 2] for i, top in enumerate(tops)], axis=0)


def _extremes(orbit: Orbit, i: int) -> tuple[Array, Array]:
    """Greatest and least y1 .. y4 of an arc."""
    times, states = samples(orbit, i)
    rates = np.array([end_rates(y, orbit.loop) for y in states])
    high, low = states.max(axis=0), states.min(axis=0)
    for j, column in np.argwhere(rates[:-1] * rates[1:] < 0.0):
        turn = _turning(states[j], times[1], orbit.loop, column)
        high[column], low[column] = max(high[column], turn), min(low[column], turn)
    return high, low


def _turning(y: Array, within: float, loop: Loop, column: int) -> float:
    def rate(time: float) -> float:
        return end_rates(_along(y, time, loop), loop)[column]

    if rate(0.0) * rate(within) >= 0.0:  # it turns at an end, to rounding
        return y[column]
    return _along(y, float(brentq(rate, 0.0, within, xtol=1e-3 * within)), loop)[column]  # pyright: ignore
