"""The oscillation of a sampled relay about a linear plant: u = +-opening in the direction of h = (x_ref - x) - T_d v.

Sampled, a relay has no rest. It sees a change of sign of h at the next sample, 0 to tau later, and its command acts
`delay` later still: a relay without sampling, but with a dead time between delay and delay + tau, in the mean half a
period. With the dead time t_d the half cycle H and the state X at its begin follow from

    exp(a H) X + int_0^H exp(a t) b dt = -X,       h(H - t_d) = 0 falling, h > 0 for the H before.

A backward difference is the velocity half a period ago; a filter adds its lag, as a state. The dead band of a valve
that the relay does not jump makes the opening smaller than the command and changes nothing else.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from controller.stability.plant import Array, Plant, zero_order_hold
from controller.stability.timing import Timing

LONGEST = 300.0  # dead times, of half a cycle that is looked for
SLOWEST = 20.0  # and in radians of the plant's slowest motion
DENSE = 40  # half cycles that are tried in each ratio of e
PLACES = 240  # instants within a half cycle


class RelayCycle(NamedTuple):
    """A symmetric oscillation in the plant's unit of time and length."""

    frequency: float  # cycles in a unit of time
    peak_to_peak: float  # of the position, at a valve opened by +-1 times what was asked for


class RelaySwing(NamedTuple):
    """What a sampled relay does: a run stays between the two ends, as samples fall before or behind the turns.

    Where the samples of a period are few, it locks onto a whole number of them, which may be anywhere between.
    """

    middle: RelayCycle
    fastest: RelayCycle  # every turn seen at once
    slowest: RelayCycle  # every turn just missed by a sample


def opening(limit: float, overlap: float) -> float:
    """Opening of a valve whose spool a relay takes to +-limit, with the overlap of its lands left in; 0..1."""
    return max(limit - overlap, 0.0) / (1.0 - overlap)


def relay_cycle(plant: Plant, derivative_time: float, timing: Timing, opened: float = 1.0) -> RelaySwing | None:
    """Frequency and peak to peak of the loop; None where no cycle is found, as with a plant that runs away.

    plant: x' = a x + b u at a valve opened by u, one plant and not a stack; timing: its period tau in the plant's unit
    of time, its delay in periods. derivative_time: T_d, same unit; opened: |u|, see `opening`. A time that the valve
    takes to switch is a further delay. Raises ValueError for an opening that is not above 0 and a wrong derivative.
    """
    if not opened > 0.0:
        raise ValueError(f"opening {opened} must be above 0: a valve that stays shut moves nothing")
    seen, row = _seen(plant, derivative_time, timing)
    tau, delay = _number(timing.tau), _number(timing.delay)
    late = [tau * (delay + share) for share in (0.5, 1e-6, 1.0)]
    found = [dead_time_cycle(seen, row, dead, opened) for dead in late]
    middle, fastest, slowest = found
    if middle is None or slowest is None:
        return None
    return RelaySwing(middle, fastest or middle, slowest)


def dead_time_cycle(plant: Plant, row: Array, dead: float, opened: float = 1.0) -> RelayCycle | None:
    """The slowest cycle of a relay without sampling, whose command follows h = -row x by a dead time."""
    halves = _halves(plant, dead)
    values = _at_turn(plant, row, dead, halves)
    turns = np.flatnonzero((values[:-1] > 0.0) != (values[1:] > 0.0))
    for k in turns[::-1]:
        half = brentq(lambda h: float(_at_turn(plant, row, dead, np.array([h]))[0]), halves[k], halves[k + 1])
        times, switching, position = _half(plant, row, _number(half), PLACES)
        if _falls_once(times, switching, _number(half), dead):
            return RelayCycle(0.5 / _number(half), 2.0 * opened * float(np.max(np.abs(position))))
    return None


def _halves(plant: Plant, dead: float) -> Array:
    """Half cycles to try: from the dead time to many of them, and to many times what the plant takes."""
    pace = np.abs(np.linalg.eigvals(plant.a))
    slowest = float(np.min(pace[pace > 1e-6 * np.max(pace)], initial=np.inf))
    top = max(LONGEST, SLOWEST / (slowest * dead))
    return np.asarray(dead * np.geomspace(1.001, top, 1 + round(DENSE * np.log(top))), np.float64)


def _number(value: object) -> float:
    return float(np.asarray(value, float))


def _seen(plant: Plant, derivative_time: float, timing: Timing) -> tuple[Plant, Array]:
    """The plant with what the velocity's estimate adds to it, and the row x + T_d v."""
    if timing.memory == 0:
        if plant.velocity is None:
            raise ValueError(
                "derivative 'measured', but the plant has no velocity output; take 'backward' or 'filtered'"
            )
        return plant, plant.position + derivative_time * plant.velocity
    tau, n = _number(timing.tau), len(plant.b)
    lag = tau * (0.5 + (timing.filter_time or 0.0))  # of the difference, and of its filter
    a, b = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    a[:n, :n], b[:n] = plant.a, plant.b
    a[n, :n], a[n, n] = plant.position / lag, -1.0 / lag  # x behind its lag: v = (x - x behind)/lag
    held = np.append(plant.position, 0.0)
    row = held + derivative_time * np.append(plant.position, -1.0) / lag
    return Plant(a, b, held, None), row


def _start(plant: Plant, half: Array) -> Array:
    """The state at the begin of half cycles of length `half`, (m, n)."""
    power, moved = zero_order_hold(plant, half)
    return np.asarray(-np.linalg.solve(np.eye(len(plant.b)) + power, moved[..., None])[..., 0], np.float64)


def _at_turn(plant: Plant, row: Array, dead: float, half: Array) -> Array:
    """h a dead time before the end of half cycles."""
    power, moved = zero_order_hold(plant, half - dead)
    return -((power @ _start(plant, half)[..., None])[..., 0] + moved) @ row


def _half(plant: Plant, row: Array, half: float, places: int) -> tuple[Array, Array, Array]:
    """Times within a half cycle, h and the position there."""
    times = half * np.arange(places, dtype=np.float64) / (places - 1)
    power, moved = zero_order_hold(plant, times)
    state = power @ _start(plant, np.array([half]))[0] + moved
    return times, np.asarray(-state @ row, np.float64), np.asarray(state @ plant.position, np.float64)


def _falls_once(times: Array, h: Array, half: float, dead: float) -> bool:
    """Is h above zero until a dead time before the end, and below from there on? Before the begin it was -h."""
    turn, slack = half - dead, 2.0 * half / PLACES
    up, down = h[times < turn - slack], h[times > turn + slack]
    return bool(np.all(up > 0.0) and np.all(down < 0.0))
