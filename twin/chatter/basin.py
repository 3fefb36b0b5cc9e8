"""Which starts end calm, in a free swing, or on the seat: basins, charts of flow and damping, bifurcation diagrams."""

import math

import numpy as np
from numpy.typing import NDArray

from twin.chatter.equilibrium import onset, rest
from twin.chatter.flight import END, HIT, TOP, Point, next_event
from twin.chatter.impact import motion
from twin.chatter.system import System
from twin.kernel import allocating_kernel, kernel

Array = NDArray[np.floating]
CALM, SWINGS, HITS = 0, 1, 2
CLOSE = 2e-3  # of the steady lift: a smaller swing counts as none
SETTLED = 1e-5  # relative change of the tops over BLOCK of them: it goes on like this
BLOCK = 32
TOLERANCE = 1e-6  # of a step, in steady lifts


@kernel
def verdict(y1: float, y2: float, y3: float, steady: float, stable: bool, most: int, s: System) -> tuple[int, float]:
    """CALM, SWINGS or HITS; the last top in steady lifts. Blocks of tops, until two are alike or `most` are taken.

    stable: is the equilibrium, by linear theory? A run that comes to rest on an unstable one is pushed off it.
    """
    at = Point(0.0, y1, y2, y3, 1e-2, 0.0)
    before, highest, hit = -1.0, 0.0, False
    n = 0
    while n < most:
        highest, hit = 0.0, False
        for _ in range(BLOCK):
            for _ in range(1000):
                at = next_event(at, 1e300, TOLERANCE * steady, steady, s)
                if at.event == TOP or at.event == END:
                    break
                hit = hit or at.event == HIT
            highest = max(highest, at.y1)
            if at.event == END:  # it creeps to its rest, without a top
                break
        n += BLOCK
        swing = highest / steady - 1.0
        if not hit and swing < CLOSE:
            if stable:
                return CALM, highest / steady
            at = Point(at.time, at.y1 + 5.0 * CLOSE * steady, at.y2, at.y3, at.step, 0.0)
        if abs(highest - before) < SETTLED * max(highest - steady, 1e-12 * steady):
            break
        before = highest
    return (HITS if hit else SWINGS), highest / steady


@allocating_kernel
def verdicts(starts: Array, steady: Array, stable, systems: Array, law, most: int) -> tuple[Array, Array]:
    """Verdict and last top of each row: starts (n, 3), steady lifts (n), is it stable (n), beta q e k r (n, 5)."""
    kind, top = np.empty(len(steady)), np.empty(len(steady))
    for i in range(len(steady)):
        row = systems[i]
        s = System(law, row[0], row[1], row[2], row[3], row[4])
        kind[i], top[i] = verdict(starts[i, 0], starts[i, 1], starts[i, 2], steady[i], stable[i], most, s)
    return kind, top


def basin(s: System, lifts: Array, speeds: Array, most: int = 4000) -> Array:
    """Verdicts for starts at a lift y1 and a speed y2, in steady lifts, y3 in equilibrium, (speeds, lifts)."""
    at = rest(s)
    x, v = np.meshgrid(lifts, speeds)
    starts = np.column_stack([at.lift * x.ravel(), at.lift * v.ravel(), np.full(x.size, at.pressure)])
    systems, stable = np.tile(s[1:], (x.size, 1)), np.full(x.size, s.damping > onset(s).damping)
    return verdicts(starts, np.full(x.size, at.lift), stable, systems, s.law, most)[0].reshape(x.shape)


def chart(s: System, flows: Array, dampings: Array, shut: bool, most: int = 4000) -> tuple[Array, Array]:
    """Verdicts and last tops over flow and damping, (dampings, flows), the rest as in s.

    shut: start from a shut valve; else from the equilibrium, opened by 1 % more.
    """
    q, k = np.meshgrid(flows, dampings)
    of_flow = [s._replace(flow=float(flow)) for flow in flows]
    lift, pressure = (np.tile(column, len(dampings)) for column in np.array([rest(one) for one in of_flow]).T)
    stable = (k > np.array([onset(one).damping for one in of_flow])).ravel()
    still = np.zeros(q.size)
    if shut:
        starts = np.column_stack([still, still, np.full(q.size, s.precompression)])
    else:
        starts = np.column_stack([1.01 * lift, still, pressure])
    systems = np.column_stack(
        [
            np.full(q.size, s.beta),
            q.ravel(),
            np.full(q.size, s.precompression),
            k.ravel(),
            np.full(q.size, s.restitution),
        ]
    )
    kind, top = verdicts(starts, lift, stable, systems, s.law, most)
    return kind.reshape(q.shape), top.reshape(q.shape)


def bifurcation(s: System, flows: Array, skip: int = 600, count: int = 40) -> tuple[Array, Array, Array]:
    """Flow, top and hardest impact speed, of `count` tops for each flow after `skip`, from twice the steady lift."""
    columns = []
    for flow in flows:
        own = s._replace(flow=float(flow))
        at = rest(own)
        run = motion(own, (2.0 * at.lift, 0.0, at.pressure), skip, count, 1e-8)
        columns.append(np.array([np.full(len(run.lift), flow), run.lift, run.impact]))
    found = np.concatenate(columns, axis=1)
    return found[0], found[1], found[2]


def boundary_flow(kind: Array, flows: Array) -> Array:
    """The flow up to which each row of a chart hits the seat, (dampings); nan: none."""
    return np.array([flows[np.flatnonzero(row == HITS)[-1]] if (row == HITS).any() else math.nan for row in kind])
