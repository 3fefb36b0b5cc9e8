"""The sampled loop about the whole actuator from sample to sample, with its exact derivatives.

x = (y1 .. y4, u_{i-1}, u_{i-2}, .., memory) as in `controller.stability.sampled`, there with three linear states: the
youngest command first, as many as the delay rounds up to; memory is nothing for `measured`, else the last position,
and the last estimate where it is filtered (kept > 0). Derivatives by the variational equations, chained over the
stretches of the period; where the valve is at its limit the command has none.
"""

import math

import numpy as np

from controller.stability.actuator.constant_command import (
    LONGEST,
    WHOLE,
    Observed,
    SimulatedActuator,
    integrate,
)
from controller.stability.actuator.model import mirror
from controller.stability.actuator.simulate import Sampled
from controller.stability.plant import Array


def past_of(loop: Sampled) -> int:
    """How many commands have yet to act, or still act, at a sample."""
    return math.ceil(loop.delay)


def width_of(loop: Sampled) -> int:
    """Length of x."""
    return 4 + past_of(loop) + (0 if loop.measured else 2 if loop.kept > 0.0 else 1)


def scale_of(loop: Sampled, plant: SimulatedActuator) -> Array:
    """Units in which all of x is of the size of a pressure swing."""
    alpha, past = plant.actuator.alpha, past_of(loop)
    motion = np.full(width_of(loop), alpha)
    motion[2:4], motion[4 : 4 + past] = 1.0, alpha / plant.actuator.gamma
    return motion


def mirrored(x: Array) -> Array:
    """The same point of the motion seen from the other side."""
    return np.array([*mirror(x[:4]), *-x[4:]])


def velocity_row(loop: Sampled) -> Array:
    """The law's velocity by x."""
    row, at = np.zeros(width_of(loop)), 4 + past_of(loop)
    if loop.measured:
        row[1] = 1.0
        return row
    row[0], row[at] = (1.0 - loop.kept) / loop.tau, -(1.0 - loop.kept) / loop.tau
    if loop.kept > 0.0:
        row[at + 1] = loop.kept
    return row


def command(x: Array, loop: Sampled) -> tuple[float, Array, float]:
    """u given at a sample, and its derivatives by x and by s."""
    row = velocity_row(loop)
    h = loop.s * x[0] + loop.d * (row @ x)
    if abs(h) >= loop.limit:
        return -math.copysign(loop.limit, h), np.zeros(len(x)), 0.0
    by_x = -loop.d * row
    by_x[0] -= loop.s
    return -h, by_x, -x[0]


def period(x: Array, plant: SimulatedActuator, loop: Sampled) -> tuple[Array, Array, Array]:
    """x a sampling period later, and its derivatives by x (n, n) and by s (n,). ArithmeticError where steps vanish."""
    n, past = len(x), past_of(loop)
    u, by_x, by_s = command(x, loop)
    commands, gradients = np.array([u, *x[4 : 4 + past]]), np.vstack([by_x, np.eye(n)[4 : 4 + past]])
    slopes = np.array([by_s, *np.zeros(past)])
    y, of_x, of_s = x[:4], np.eye(n)[:4], np.zeros(4)
    share = loop.delay - max(past - 1, 0)
    for which, part in ((past, share), (max(past - 1, 0), 1.0 - share)):
        if part > 0.0:
            y, flow = flown(y, float(commands[which]), part * loop.tau, plant)
            of_x = flow[:, :4] @ of_x + np.outer(flow[:, 4], gradients[which])
            of_s = flow[:, :4] @ of_s + flow[:, 4] * slopes[which]
    row, tail = velocity_row(loop), n - 4 - past
    memory, keeps = np.array([x[0], row @ x])[:tail], np.vstack([np.eye(n)[0], row])[:tail]
    after, by_s_after = np.array([*y, *commands[:past], *memory]), np.array([*of_s, *slopes[:past], *np.zeros(tail)])
    return after, np.array([*of_x, *gradients[:past], *keeps], float), by_s_after


def flown(y: Array, u: float, duration: float, plant: SimulatedActuator) -> tuple[Array, Array]:
    """y after holding u, and its derivatives by y and u, (4, 5)."""
    row = np.zeros(WHOLE)
    row[:4], row[4:] = y, np.eye(4, 5).ravel()
    seen = Observed(np.zeros(2), np.zeros(4))
    size = integrate(row, WHOLE, u, 0.0, duration, LONGEST, plant, np.empty((7, WHOLE)), np.empty(WHOLE), seen)
    if size == 0.0:
        raise ArithmeticError("steps vanish")
    return row[:4], row[4:].reshape(4, 5)
