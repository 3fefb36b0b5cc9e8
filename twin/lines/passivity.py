"""Filters that cannot create energy: |S+|, |S-| <= 1, enforced where a free fit exceeds it, certified on a grid."""

import math

import numpy as np

from twin.lines.filters import Filters, filled, responses, scattering, unknowns
from twin.lines.householder import Matrix, product, solve, triangle
from twin.lines.theory import Line, modes

ROUNDS = 8  # of enforcing
HOPELESS = 1.0  # |S| - 1 that no round mends; nor does one that makes it worse lead anywhere
HEAVY = 300.0  # weight of an enforced point over the largest entry of the problem
NOISE = 2e-10  # of rounding in |S|
UNSURE = 1e-8  # |S| - 1 to be feared between the points of the grid while maxima exceed what is allowed
NEAR = 1e-3  # below 1 a maximum is looked at in detail


def enforced(line: Line, empty: Filters, fixed: Matrix, free: Matrix, r: Matrix, y: Matrix) -> tuple[Filters, float]:
    """Filters of x = fixed + free v, v the least squares of R v = y, with rows added where |S| exceeds 1 until it does
    not; and the worst |S| - 1."""
    theta, heavy = _grid(line), HEAVY * float(np.abs(r).max())
    filters, excess, before = empty, math.inf, HOPELESS
    for _ in range(ROUNDS):
        filters = filled(empty, fixed + product(free, solve(r, y).reshape(-1, 1))[:, 0])
        rows, values, excess = _violations(theta, filters, line)
        if not len(rows):
            return filters, excess
        if excess > before:
            break
        before = excess
        values -= product(rows, fixed.reshape(-1, 1))[:, 0]
        r, y = triangle(np.vstack([r, heavy * product(rows, free)]), np.append(y, heavy * values))
    return filters, max(excess, UNSURE)


def _grid(line: Line) -> Matrix:
    """Angles that see every ripple of S: 8 per turn of the echo, and the slow end in detail."""
    even = np.linspace(0.0, math.pi, max(400, math.ceil(8.0 * line.steps)) + 1)[1:]
    slow = np.geomspace(1e-4 / line.steps, even[0], 200)
    return np.concatenate([slow[:-1], even])


def _violations(theta: Matrix, filters: Filters, line: Line) -> tuple[Matrix, Matrix, float]:
    """Rows on the radial part of S at the maxima of |S| that exceed what is allowed; their goals; the worst |S| - 1."""
    found = np.abs(scattering(theta, filters))
    rows, values, excess = [np.zeros((0, unknowns(filters)))], [np.zeros(0)], -1.0
    for mode in (0, 1):
        at = _maxima(theta, found[mode], filters, mode)
        s = scattering(at, filters)[mode]
        size = np.abs(s)
        goal = np.abs(modes(1j * at / line.step, line.travel_time, line.viscous_time, line.losses, line.creep)[mode])
        excess = max(excess, float(size.max(initial=0.0)) - 1.0)
        bad = size > 1.0 - 0.1 * (1.0 - goal) + NOISE
        rows.append((np.conj(s / size)[bad, None] * responses(at[bad], filters)[mode]).real)
        least = np.where(at > 0.6, 0.5 * (1.0 + goal), goal)
        values.append((least - np.maximum(size - 1.0, 0.0))[bad])  # as far below as it was above: ends in few rounds
    return np.vstack(rows), np.concatenate(values), excess


def _maxima(theta: Matrix, size: Matrix, filters: Filters, mode: int) -> Matrix:
    """Angles where |S| is largest locally and near 1, to a sixteenth of the grid."""
    peak = np.flatnonzero(np.r_[True, size[1:] >= size[:-1]] & np.r_[size[:-1] >= size[1:], True] & (size > 1.0 - NEAR))
    best, apart = theta[peak], 0.25 * (theta[np.minimum(peak + 1, len(theta) - 1)] - theta[np.maximum(peak - 1, 0)])
    for _ in range(3):
        near = np.minimum(best[:, None] + apart[:, None] * np.linspace(-1.0, 1.0, 5), math.pi)
        close = np.abs(scattering(near.ravel(), filters)[mode]).reshape(near.shape)
        best, apart = near[np.arange(len(peak)), close.argmax(axis=1)], 0.5 * apart
    return best
