"""Charts: how many multipliers are stable, over any grid of gains, sampling intervals, delays and damping.

The characteristic polynomial is affine in s and d, D(z) + s P(z) + d Q(z): it is made once for each plant, interval and
delay, and its roots are counted by Schur's recursion, without finding one. Where rounding could change the count
(a multiplier on the circle, or within some 1e-10 of it) the eigenvalues decide by the rule of `crossing.stable_count`:
|mu| < 1 - 1e-12, so that a multiplier on the circle, as at s = 0, is not stable.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from controller.stability.crossing import stable_count
from controller.stability.plant import Array, Plant, linear_actuator
from controller.stability.sampled import SampledLoop, closed, sampled_loop
from controller.stability.timing import Timing
from twin.kernel import kernel

Counts = NDArray[np.int8]
MOST = 100_000  # matrices at once


def stable_multipliers(s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, timing: Timing) -> Counts:
    """Number of stable multipliers of the actuator, in the shape to which all arguments broadcast.

    Unlike `monodromy` it takes delays of any length together, so the number that means "stable" is
    3 + ceil(delay) + (0, 1, 2 for measured, backward, filtered): see `unstable_multipliers` for a chart over delay.
    """
    cases = [np.asarray(value, float) for value in (k, gamma, timing.tau, timing.delay)]
    ceilings = np.ceil(cases[3])
    out = np.empty(np.broadcast_shapes(np.shape(s), np.shape(d), *(case.shape for case in cases)), np.int8)
    for ceiling in np.unique(ceilings):
        chosen = np.where(ceilings == ceiling, cases[3], ceiling)
        loop = sampled_loop(linear_actuator(*cases[:2]), timing._replace(tau=cases[2], delay=chosen))
        np.copyto(out, count_loop(loop, s, d), where=ceilings == ceiling)
    return out


def unstable_multipliers(s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, timing: Timing) -> Counts:
    """How many multipliers are not inside: 0 means stable, whatever the delay."""
    size = 3 + np.ceil(timing.delay) + timing.memory
    return (size - stable_multipliers(s, d, k, gamma, timing)).astype(np.int8)


def count_plant(plant: Plant, s: ArrayLike, d: ArrayLike, timing: Timing) -> Counts:
    """The same for any plant; all delays must round up to the same number of periods."""
    return count_loop(sampled_loop(plant, timing), s, d)


def count_loop(loop: SampledLoop, s: ArrayLike, d: ArrayLike) -> Counts:
    """Number of stable multipliers of a stack of loops; s and d broadcast with the stack."""
    stack, n = loop.free.shape[:-2], loop.free.shape[-1]
    shape = np.broadcast_shapes(stack, np.shape(s), np.shape(d))
    base, by_s, by_d = (part.reshape(-1, n + 1) for part in polynomials(loop))
    which = np.broadcast_to(np.arange(len(base)).reshape(stack), shape).ravel()
    gains = [np.broadcast_to(np.asarray(gain, float), shape).ravel() for gain in (s, d)]
    out = np.empty(which.shape, np.int8)
    count_inside(base, by_s, by_d, which, gains[0], gains[1], np.empty(n + 1), np.empty(n + 1), out)
    _decide(out, loop, which, gains)
    return out.reshape(shape)


def polynomials(loop: SampledLoop) -> tuple[Array, Array, Array]:
    """D, P, Q of det(z - M) = D + s P + d Q, each (..., n + 1), lowest power first."""
    velocity = np.broadcast_to(loop.velocity, loop.entry.shape)
    d = characteristic(loop.free)
    p = characteristic(loop.free - loop.entry[..., :, None] * loop.position) - d
    return d, p, characteristic(loop.free - loop.entry[..., :, None] * velocity[..., None, :]) - d


def characteristic(matrix: Array) -> Array:
    """det(z - M), lowest power first (..., n + 1), by Faddeev and LeVerrier."""
    n = matrix.shape[-1]
    out, power = np.zeros((*matrix.shape[:-2], n + 1)), np.zeros_like(matrix)
    out[..., n] = 1.0
    for j in range(1, n + 1):
        power = matrix @ (power + out[..., n - j + 1, None, None] * np.eye(n))
        out[..., n - j] = -np.trace(power, axis1=-2, axis2=-1) / j
    return out


def _decide(out: Counts, loop: SampledLoop, which: NDArray[np.intp], gains: list[Array]) -> None:
    """Fill what the kernel left at -1."""
    n, open_ = loop.free.shape[-1], np.flatnonzero(out < 0)
    velocity = np.broadcast_to(loop.velocity, loop.entry.shape).reshape(-1, n)
    for part in np.array_split(open_, len(open_) // MOST + 1):
        rows = which[part]
        free, entry = loop.free.reshape(-1, n, n)[rows], loop.entry.reshape(-1, n)[rows]
        one = SampledLoop(free, entry, loop.position, velocity[rows])
        out[part] = stable_count(closed(one, gains[0][part], gains[1][part]))


@kernel
def count_inside(base, by_s, by_d, which, s, d, work, spare, out):
    """Roots inside the unit circle of base + s by_s + d by_d [which], lowest power first, into out; -1 if unsure.

    Schur: with |a_0| < |a_m|, a_m a - a_0 a* has the root 0 and as many inside as a; else a* stands for a. What calls
    no other file is safe in numba's own cache.
    """
    n = base.shape[1] - 1
    for i in range(len(out)):
        largest = 1.0
        for j in range(n + 1):
            work[j] = base[which[i], j] + s[i] * by_s[which[i], j] + d[i] * by_d[which[i], j]
            largest = max(largest, abs(work[j]))
        error, count, sign, m = 1e-15 * largest, 0, 1, n
        while m > 0:
            if abs(work[0]) > abs(work[m]):
                for j in range((m + 1) // 2):
                    work[j], work[m - j] = work[m - j], work[j]
                count, sign = count + sign * m, -sign
            first, error = work[0] / work[m], error / abs(work[m])
            gap = 1.0 - first * first
            if not gap > 1e4 * error:
                break
            largest, top = 1.0, work[m]
            for j in range(m + 1):
                work[j] /= top
                largest = max(largest, abs(work[j]))
            for j in range(m):
                spare[j] = work[j + 1] - first * work[m - 1 - j]
            work, spare = spare, work
            m -= 1
            count, error = count + sign, 2.0 * error * largest / gap
        out[i] = count if m == 0 else -1
