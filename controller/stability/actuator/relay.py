"""The relay loop u = -sign(s y1 + d y2), smoothed to u = -tanh(h/eps): polynomial and Hopf point for any eps.

Source: 5.3.2, (5.20) to (5.22). With g = gamma/(sqrt2 alpha) the difference of pressures obeys

    lambda^3 + (k + g) lambda^2 + (2 + k g + sqrt2 gamma d/eps) lambda + sqrt2 gamma s/eps.

Smoothing makes the rest that the relay itself has not; as eps -> 0 the edge stays and the frequency grows without
bound. There is no sliding: h' = s y2 + d y2' is the same on both sides of h = 0.
"""

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.plant import SQRT2, Array


def relay_polynomial(
    s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike, eps: ArrayLike
) -> Array:
    """Coefficients (..., 4), highest power first; eps > 0."""
    k, eps, g = np.asarray(k), np.asarray(eps), np.asarray(gamma) / (SQRT2 * np.asarray(alpha))
    slope = SQRT2 * gamma / eps
    terms = np.broadcast_arrays(1.0, k + g, 2.0 + k * g + slope * d, slope * s)
    return np.stack([np.asarray(term, float) for term in terms], axis=-1)


def relay_edge(s: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike, eps: ArrayLike = 0.0) -> Array:
    """d_H below which the loop oscillates (5.22); eps = 0, the relay: sqrt2 alpha s/(gamma + sqrt2 alpha k)."""
    k, gamma = np.asarray(k, float), np.asarray(gamma, float)
    g = gamma / (SQRT2 * np.asarray(alpha))
    return s / (k + g) - eps * (2.0 + k * g) / (SQRT2 * gamma)


def relay_frequency(s: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike, eps: ArrayLike) -> Array:
    """omega_H of the smoothed relay, from omega_H^2 = sqrt2 gamma s/(eps (k + g)); eps > 0."""
    gamma = np.asarray(gamma, float)
    g = gamma / (SQRT2 * np.asarray(alpha))
    return np.sqrt(SQRT2 * gamma * s / (np.asarray(eps) * (np.asarray(k) + g)))
