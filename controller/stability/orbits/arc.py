"""An arc of the analogue loop between two switching points, with its derivatives by start, s and d.

Dormand and Prince's pair 5(4), steps chosen by the error of the state; the variational equations go along, so that
derivatives are those of the flow; their errors choose the step too. An arc belongs to the side h <= 0: the relay holds
u = 1, the proportional valve u = min(-h, 1), the smoothed relay both edges, (5.20). CROSSED is not a valve: the
proportional loop with the edges of the other side, q1 = u G(y3), q2 = -u G(1 - y4) for u > 0; see `birth`.
"""

import math
from typing import NamedTuple

import numpy as np

from controller.stability.actuator.dormand_prince import error_of, stage
from controller.stability.actuator.model import (
    Actuator,
    Array,
    Feedback,
    rates,
    root,
    root_slope,
)
from twin.kernel import allocating_kernel, inlined

RELAY, PROPORTIONAL, SMOOTHED, CROSSED = 0, 1, 2, 3
WIDTH = 28  # of a row: y, then d y/d(y0, s, d) row by row, (4, 6)
SLOPES = 1e-3  # weight of the error of a derivative against that of a state
SHARPEST = 1e-12  # drop below which the pure root is not followed in every detail
MOST = 10_000_000  # steps of an arc
STABLE = 3.0  # step times the rate of a decay that the pair still damps


class Loop(NamedTuple):
    """An analogue loop."""

    kind: int  # RELAY | PROPORTIONAL | SMOOTHED | CROSSED
    actuator: Actuator
    gains: Feedback
    epsilon: float  # of tanh(h/epsilon), SMOOTHED only
    laminar: float  # drop below which the valve's edges are laminar; 0.0: the pure root


@inlined
def openings(h: float, loop: Loop) -> tuple[float, float, float, float]:
    """a, b and their slopes by h."""
    if loop.kind == 0:
        return 1.0, 0.0, 0.0, 0.0
    if loop.kind == 2:
        share = 0.5 * (1.0 - math.tanh(h / loop.epsilon))
        slope = -2.0 * share * (1.0 - share) / loop.epsilon
        return share, 1.0 - share, slope, -slope
    if loop.kind == 3:
        return 0.0, h, 0.0, 1.0
    return (-h, 0.0, -1.0, 0.0) if h > -1.0 else (1.0, 0.0, 0.0, 0.0)


@inlined
def derive(w, out, loop: Loop):
    """Rates of a row: state and derivatives."""
    alpha, gamma, k = loop.actuator
    s, d = loop.gains
    y1, y2, y3, y4 = w[0], w[1], w[2], w[3]
    a, b, a_h, b_h = openings(s * y1 + d * y2, loop)
    out[0], out[1], out[2], out[3] = rates(y1, y2, y3, y4, a, b, loop.actuator, loop.laminar)
    to3, to4 = gamma / (alpha * (1.0 + y1)), gamma / (alpha * (1.0 - y1))
    h3 = to3 * (a_h * root(1.0 - y3, loop.laminar) - b_h * root(y3, loop.laminar))
    h4 = to4 * (b_h * root(1.0 - y4, loop.laminar) - a_h * root(y4, loop.laminar))
    own3 = own4 = 0.0
    if a != 0.0:
        own3 -= to3 * a * root_slope(1.0 - y3, loop.laminar)
        own4 -= to4 * a * root_slope(y4, loop.laminar)
    if b != 0.0:
        own3 -= to3 * b * root_slope(y3, loop.laminar)
        own4 -= to4 * b * root_slope(1.0 - y4, loop.laminar)
    for j in range(6):
        v1, v2, v3, v4 = w[4 + j], w[10 + j], w[16 + j], w[22 + j]
        dh = s * v1 + d * v2 + (y1 if j == 4 else 0.0) + (y2 if j == 5 else 0.0)
        out[4 + j] = v2
        out[10 + j] = alpha * (v3 - v4) - k * v2
        out[16 + j] = -out[2] / (1.0 + y1) * v1 - to3 / gamma * v2 + own3 * v3 + h3 * dh
        out[22 + j] = out[3] / (1.0 - y1) * v1 + to4 / gamma * v2 + own4 * v4 + h4 * dh


@inlined
def stiffness(w, loop: Loop):
    """How fast a pressure falls back to where the flows fit the speed; the pair's own stability bounds the step by it,
    which the error alone would not as soon as nothing is left to fall back from."""
    h = loop.gains.s * w[0] + loop.gains.d * w[1]
    a, b, _, _ = openings(h, loop)
    slopes, laminar = 1e-30, max(loop.laminar, SHARPEST)
    if a != 0.0:
        slopes = abs(a) * max(root_slope(1.0 - w[2], laminar), root_slope(w[3], laminar))
    if b != 0.0:
        slopes += abs(b) * max(root_slope(w[2], laminar), root_slope(1.0 - w[3], laminar))
    return loop.actuator.gamma * slopes / (loop.actuator.alpha * (1.0 - abs(w[0])))


@allocating_kernel
def step_by(w, size, loop: Loop, stages, trial):
    """One step from w (with its rates in stages[0]) into trial; returns the error of the state in units of it."""
    for i in range(1, 7):
        stage(i, w, WIDTH, size, stages, trial)
        derive(trial, stages[i], loop)
    alpha, worst = loop.actuator.alpha, 0.0
    for n in range(WIDTH):
        error = error_of(n, size, stages)
        if n < 4:
            worst = max(worst, error / (alpha if n < 2 else 1.0))
        else:
            row, column = (n - 4) // 6, (n - 4) % 6
            scale = (alpha if column < 2 else 1.0) / (alpha if row < 2 else 1.0)
            worst = max(worst, SLOPES * error * scale)
    return worst


@allocating_kernel
def follow(y, length, loop: Loop, tolerance, to_switch):
    """Row (28,) at the end of an arc from y, and the time: `length`, or where h rises through 0 before that.

    The time is negative where the piston leaves |y1| < 1, the steps vanish, or MOST of them do not suffice.
    """
    w, trial, stages = np.zeros(WIDTH), np.empty(WIDTH), np.empty((7, WIDTH))
    w[:4] = y
    for i in range(4):
        w[4 + 7 * i] = 1.0
    s, d = loop.gains
    time, size, below = 0.0, min(1e-3, length), False
    derive(w, stages[0], loop)
    for _ in range(MOST):
        if time >= length:
            return w, time
        size = min(size, length - time, STABLE / stiffness(w, loop))
        error = step_by(w, size, loop, stages, trial)
        factor = 0.9 * (tolerance / max(error, 1e-30)) ** 0.2
        if not error <= tolerance:
            size *= max(0.1, min(factor, 0.9)) if error == error else 0.1
            if size < 1e-14:
                return w, -1.0
            continue
        h = s * trial[0] + d * trial[1]
        if to_switch and below and h >= 0.0:
            low, high = 0.0, size
            for _ in range(80):
                size = 0.5 * (low + high)
                step_by(w, size, loop, stages, trial)
                if s * trial[0] + d * trial[1] >= 0.0:
                    high = size
                else:
                    low = size
            return trial, time + size
        below = below or h < 0.0
        time = length if size == length - time else time + size
        w[:] = trial
        stages[0] = stages[6]
        if not abs(w[0]) < 1.0:
            return w, -1.0
        size *= max(0.2, min(factor, 5.0))
    return w, -1.0


def derivatives(row: Array) -> Array:
    """d y/d(y0, s, d), (4, 6), of a row."""
    return row[4:].reshape(4, 6)


def end_rates(y: Array, loop: Loop) -> Array:
    """y' (4,) at a point of the arc."""
    w, out = np.zeros(WIDTH), np.empty(WIDTH)
    w[:4] = y
    _derive(w, out, loop)
    return out[:4]


@allocating_kernel
def _derive(w, out, loop: Loop):
    derive(w, out, loop)
