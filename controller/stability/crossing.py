"""Where multipliers cross the unit circle as one gain grows, in any loop M(g) = M - g b r with g > 0.

A multiplier z of M(g) has g G(z) = -1 with G(z) = r (z - M)^-1 b. On the unit circle g is real only where
G(z) = G(1/z): all these z are generalised eigenvalues of one pencil, so none is missed, however narrow. Between
neighbouring crossings the number of stable multipliers cannot change and is counted half-way.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig, matrix_balance

from controller.stability.plant import Array

Spectrum = NDArray[np.complex128]

ON_CIRCLE = 1e-12  # |mu| of at least 1 - this is not stable: rounding of a multiplier that sits on the circle
NEAR = 1e-4  # of the circle: who is so near is taken as a candidate; one too many only parts a range in two
LOSING = 1e-10  # speeds |mu|'/|b||r| below this are no motion


class Onset(NamedTuple):
    """The multiplier that leaves the unit circle at a gain, or comes nearest to leaving it."""

    gain: float
    kind: str  # "fold" mu = 1 | "flip" mu = -1 | "Neimark-Sacker" a complex pair
    multiplier: complex
    angle: float  # |arg mu| [rad per sampling period], 0 .. pi: the frequency is angle/tau


def multipliers(matrix: Array) -> Spectrum:
    """Multipliers of a matrix or a stack, (..., n), complex."""
    return np.linalg.eigvals(matrix).astype(np.complex128)


def inside(mu: Spectrum) -> NDArray[np.bool_]:
    """Which multipliers lie inside the unit circle by more than rounding: those on it do not."""
    return np.abs(mu) < 1.0 - ON_CIRCLE


def stable_count(matrix: Array) -> NDArray[np.intp]:
    """How many multipliers lie inside, (...)."""
    return inside(multipliers(matrix)).sum(axis=-1)


def is_stable(matrix: Array) -> NDArray[np.bool_]:
    """Do all multipliers lie inside? Those on the circle do not."""
    return stable_count(matrix) == matrix.shape[-1]


def balanced(matrix: Array, entry: Array, row: Array) -> tuple[Array, Array, Array]:
    """The same loop in units, powers of two, that bring its numbers together: a state may be in pascal or metre."""
    whole = np.block([[matrix, entry[:, None]], [row, np.zeros(1)]])
    with np.errstate(invalid="ignore"):  # scipy casts the scales to integers, for permutations it has not made
        whole = np.asarray(matrix_balance(whole, permute=False)[0], float)
    return whole[:-1, :-1], whole[:-1, -1], whole[-1, :-1]


def crossings(matrix: Array, entry: Array, row: Array) -> Array:
    """All gains g > 0, rising, at which M - g b r has a multiplier on the circle, and a few others."""
    points = [1.0 + 0.0j, -1.0 + 0.0j, *_mirrored(matrix, entry, row)]
    found = {gain for point in points if (gain := crossing_at(point, matrix, entry, row)) > 0.0}
    return np.array(sorted(found))


def _mirrored(matrix: Array, entry: Array, row: Array) -> Array:
    """Points of the upper unit circle where G(z) = G(1/z)."""
    n = len(entry)
    left, right = np.zeros((2 * n + 1, 2 * n + 1)), np.zeros((2 * n + 1, 2 * n + 1))
    left[:n, :n], left[:n, -1], left[n:-1, n:-1] = matrix, entry, -np.eye(n)
    left[-1, :n], left[-1, n:-1] = -row, row
    right[:n, :n], right[n:-1, n:-1], right[n:-1, -1] = np.eye(n), -matrix, -entry
    with np.errstate(all="ignore"):
        z = np.asarray(eig(left, right, right=False))
    z = z[np.isfinite(z)]
    z = z[(np.abs(np.abs(z) - 1.0) < NEAR) & (z.imag > 1e-9)]
    return z / np.abs(z)


def crossing_at(z: complex, matrix: Array, entry: Array, row: Array) -> float:
    """g = -1/G(z) at a point of the circle; 0.0 where M has a multiplier there already, or where no g is real."""
    shifted = z * np.eye(len(entry)) - matrix
    if np.linalg.cond(shifted) > 1e13:
        return 0.0
    transfer = complex(row @ np.linalg.solve(shifted, entry.astype(complex)))
    return 0.0 if transfer.real >= 0.0 else float(-1.0 / transfer.real)


def stable_ranges(matrix: Array, entry: Array, row: Array) -> list[tuple[float, float]]:
    """All open ranges of g > 0 in which M - g b r is stable, rising; the last may end at inf."""
    matrix, entry, row = balanced(matrix, entry, row)
    mu, speeds = _starts(matrix, entry, row)
    size = float(np.linalg.norm(entry) * np.linalg.norm(row))
    edges = _told_apart(crossings(matrix, entry, row), speeds, size)
    middles = [*(0.5 * (a + b) for a, b in pairwise(edges)), 2.0 * edges[-1] + 1.0]
    ranges: list[tuple[float, float]] = []
    for low, high, middle in zip(edges, [*edges[1:], np.inf], middles, strict=True):
        if low == 0.0 and np.any(np.abs(mu[np.isnan(speeds)]) > 1.0):  # outside without the gain
            continue
        if not is_stable(matrix - middle * np.outer(entry, row)):
            continue
        joined = ranges and ranges[-1][1] == low
        ranges[-1:] = [(ranges[-1][0], high)] if joined else [*ranges[-1:], (low, high)]
    return ranges


def _told_apart(gains: Array, speeds: Array, size: float) -> list[float]:
    """0.0 and those gains by which every multiplier that starts on the circle has moved by more than rounding.

    size: |b||r|. Before that it crosses the circle by rounding alone.
    """
    known = np.abs(speeds[~np.isnan(speeds)])
    slowest = known.min(initial=1.0, where=known > LOSING)
    return [0.0, *(float(gain) for gain in gains if gain * size * slowest > ON_CIRCLE)]


def _starts(matrix: Array, entry: Array, row: Array) -> tuple[Spectrum, Array]:
    """Multipliers at g = 0 and, of those on the circle, how fast they leave it outward; NaN for the others."""
    mu, left, right = (np.asarray(part) for part in eig(matrix, left=True, right=True))
    speeds = np.full(len(mu), np.nan)
    for j in np.flatnonzero(np.abs(np.abs(mu) - 1.0) <= LOSING):
        speeds[j] = _outward(mu[j], left[:, j], right[:, j], entry, row)
    return mu, speeds


def _outward(mu: complex, left: Array, right: Array, entry: Array, row: Array) -> float:
    """d|mu|/dg of a multiplier on the circle at g = 0, per |b||r|; 0.0 where it is double and has no slope."""
    product = left.conj() @ right
    if abs(product) < 1e-7:
        return 0.0
    slope = -(left.conj() @ entry) * (row @ right) / product
    return float((mu.conjugate() * slope).real / (np.linalg.norm(entry) * np.linalg.norm(row)))


def first_loss(matrix: Array, entry: Array, row: Array) -> float:
    """End of the stable range that starts at g = 0; 0.0 if none does."""
    ranges = stable_ranges(matrix, entry, row)
    return ranges[0][1] if ranges and ranges[0][0] == 0.0 else 0.0


def classify(gain: float, matrix: Array, entry: Array, row: Array) -> Onset:
    """What the multiplier does that is lost at a gain; at 0.0 it is the one that any small gain drives out."""
    if gain > 0.0:
        mu = multipliers(matrix - gain * np.outer(entry, row))
        return named(gain, complex(mu[np.argmin(np.abs(np.abs(mu) - 1.0))]))
    return named(gain, _lost_at_once(*balanced(matrix, entry, row)))


def named(gain: float, mu: complex) -> Onset:
    """The kind of motion that belongs to a multiplier near the circle."""
    if abs(mu.imag) > 1e-7 * abs(mu):
        return Onset(gain, "Neimark-Sacker", complex(mu.real, abs(mu.imag)), float(abs(np.angle(mu))))
    return Onset(gain, "fold", mu, 0.0) if mu.real > 0.0 else Onset(gain, "flip", mu, float(np.pi))


def _lost_at_once(matrix: Array, entry: Array, row: Array) -> complex:
    """The largest multiplier if it is outside without the gain; else, of those on the circle, the fastest outward."""
    mu, speeds = _starts(matrix, entry, row)
    size = np.abs(mu)
    return complex(mu[np.argmax(size if size.max() > 1.0 + LOSING else np.where(np.isnan(speeds), -np.inf, speeds))])
