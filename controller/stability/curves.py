"""Closed-form edges of the sampled actuator without damping or delay, k = 0, and those any loop has.

Source: (5.42) to (5.45), garbled in print; the sign of (5.44) is wrong there. Dimensionless numbers or arrays. A curve
says where a multiplier is on the circle, not that the others are inside; NaN where it asks for s < 0.
"""

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.crossing import balanced, crossing_at
from controller.stability.plant import SQRT2, Array
from controller.stability.sampled import SampledLoop, closed


def flip_curve(tau: ArrayLike, gamma: ArrayLike) -> Array:
    """s with mu = -1, whatever d: 4 cos x/(sqrt2 gamma (tau cos x - sqrt2 sin x)), x = tau/sqrt2."""
    tau = np.asarray(tau, float)
    x = tau / SQRT2
    with np.errstate(divide="ignore"):
        return _positive(4.0 * np.cos(x) / (SQRT2 * gamma * (tau * np.cos(x) - SQRT2 * np.sin(x))))


def neimark_sacker_curve(tau: ArrayLike, d: ArrayLike, gamma: ArrayLike) -> Array:
    """s with two multipliers of product 1: a boundary only where they are a complex pair, not m and 1/m."""
    tau, d, gamma = np.broadcast_arrays(np.asarray(tau, float), np.asarray(d, float), np.asarray(gamma, float))
    above = 4.0 * d * (SQRT2 + d * gamma) * np.sin(tau / SQRT2) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return _positive(above / (2.0 * d * gamma * tau - (2.0 + SQRT2 * d * gamma) * np.sin(SQRT2 * tau)))


def fold_intervals(longest: float) -> Array:
    """Sampling intervals up to `longest` at which mu = 1 for every s: whole periods of the oil spring, 2 pi N/sqrt2."""
    return SQRT2 * np.pi * np.arange(1.0, np.floor(longest / (SQRT2 * np.pi)) + 1.0)


def flip_gain(loop: SampledLoop, d: float) -> float:
    """s > 0 with mu = -1 in any loop, -1/G(-1) of its transfer from a command to the position; inf: none."""
    gain = crossing_at(-1.0 + 0.0j, *balanced(closed(loop, 0.0, d), loop.entry, loop.position))
    return gain if gain > 0.0 else np.inf


def pair_gains(loop: SampledLoop, d: float) -> tuple[float, float]:
    """Smaller and larger s > 0 with a complex pair on the circle, in a loop of three states; NaN: none.

    Its mu^3 + p2 mu^2 + p1 mu + p0 is affine in s; a pair of product 1 asks for p0^2 - p0 p2 + p1 = 1.
    """
    at_rest, slope = (np.poly(closed(loop, s, d)) for s in (0.0, 1.0))
    slope = slope - at_rest
    (_, a2, a1, a0), (_, b2, b1, b0) = at_rest, slope
    square = b0 * (b0 - b2), 2.0 * a0 * b0 - a0 * b2 - a2 * b0 + b1, a0 * (a0 - a2) + a1 - 1.0
    gains = sorted(float(s.real) if s.imag == 0.0 else np.nan for s in np.roots(square))
    # real m and 1/m have product 1 too: the sum of a pair on the circle is below 2
    kept = [s if s > 0.0 and abs(a2 + s * b2 - a0 - s * b0) < 2.0 else np.nan for s in gains]
    first, second = [*kept, np.nan, np.nan][:2]
    return first, second


def _positive(s: Array) -> Array:
    return np.where(s > 0.0, s, np.nan)
