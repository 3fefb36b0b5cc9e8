"""What a line of `nodes` is made of: the cut into segments, and the filter of friction.

F(z) = 8 + sum r_j (1 - z^-1)/(1 - p_j z^-1) ~ sigma (N - 1),  r_j >= 0,  sigma = s t_v
"""

import math

import numpy as np
from numpy.typing import NDArray

from twin.lines.householder import solve
from twin.lines.theory import losses

POLES = 8
FIRST_ZERO = 26.375  # j_2,1^2: the slowest pole of N is at t_v/26.4
MIDDLE = 3.0  # shortest middle segment in steps: its taps need room
SEGMENTS = 15  # at most; see the README for error against cost


def cut(m: float) -> tuple[int, int, float]:
    """Segments, steps of an outer one and of the middle one: the finest with equal outer ones, SEGMENTS at most."""
    best = (1, 1, m)
    for segments in range(3, SEGMENTS + 1, 2):
        for delay in range(1, math.floor(m / segments) + 2):
            middle = m - (segments - 1) * delay
            if middle >= MIDDLE and max(delay, middle) < max(best[1:]):
                best = (segments, delay, middle)
    return best


def friction_poles(viscous_time: float, kind: str, step: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """p_j and r_j >= 0 of F: relative least squares in log-spaced w; a pole that would take a negative r is dropped."""
    tau = np.geomspace(0.7 * step, max(viscous_time / FIRST_ZERO, 8.0 * step), POLES)
    p, r = np.exp(-step / tau), np.zeros(POLES)
    if kind != "unsteady":
        return p, r
    omega = np.geomspace(1e-2 / viscous_time, math.pi / step, 200)
    s = 1j * omega
    target = s * viscous_time * (losses(s, viscous_time, kind) - 1.0) - 8.0
    z1 = np.exp(-1j * omega * step)[:, None]
    weight = (1.0 / (1.0 + (omega * step) ** 2) / np.abs(target + 8.0))[:, None]
    rows = weight * (1.0 - z1) / (1.0 - p * z1)
    matrix, goal = np.vstack([rows.real, rows.imag]), weight[:, 0] * target
    kept = np.arange(POLES)
    while len(kept):
        found = solve(matrix[:, kept], np.concatenate([goal.real, goal.imag]))
        if found.min() >= 0.0:
            r[kept] = found
            break
        kept = np.delete(kept, found.argmin())
    return p, r
