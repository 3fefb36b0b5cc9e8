"""The analogue loop, u = -(s y1 + d y2) at every instant: its polynomial, its edge, and its kink at u = 0.

Source: 5.4.1, (5.24) to (5.26). At rest both chambers may hold any equal pressure p_e in (0, 1); with
sigma = sqrt(p_e) + sqrt(1 - p_e) the difference of pressures obeys

    lambda^3 + k lambda^2 + (2 + sigma gamma d) lambda + sigma gamma s,

stable iff 0 < s < k (d + 2/(sigma gamma)); the fourth eigenvalue is 0, along the rests. sigma <= sqrt2, so p_e = 1/2
goes first. The two Jacobians beside u = 0 differ in how the sum of the pressures answers, which nothing else feels:
every one of their mixtures has the same eigenvalues, so the kink cannot move the edge. The thesis's d_1 =
s/k - 4 sqrt2/(3 gamma) would need sigma = 3/(2 sqrt2), a rest at p_e = 0.0039: it does not follow from 1/2.
Arguments are dimensionless and may be arrays, which broadcast.
"""

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.actuator.model import Actuator, linearise
from controller.stability.plant import Array


def flow_slope(rest: ArrayLike = 0.5) -> Array:
    """sigma = sqrt(p_e) + sqrt(1 - p_e): difference of the flows per opening. ValueError outside (0, 1)."""
    rest = np.asarray(rest, float)
    if not np.all((rest > 0.0) & (rest < 1.0)):
        raise ValueError(f"pressure at rest {rest} must lie between return and supply, inside (0, 1)")
    return np.sqrt(rest) + np.sqrt(1.0 - rest)


def analogue_polynomial(s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, rest: ArrayLike = 0.5) -> Array:
    """Coefficients (..., 4), highest power first."""
    slope = flow_slope(rest) * np.asarray(gamma, float)
    terms = np.broadcast_arrays(1.0, k, 2.0 + slope * np.asarray(d, float), slope * np.asarray(s, float))
    return np.stack([np.asarray(term, float) for term in terms], axis=-1)


def analogue_edge(d: ArrayLike, k: ArrayLike, gamma: ArrayLike, rest: ArrayLike = 0.5) -> Array:
    """s at which stability ends, k (d + 2/(sigma gamma))."""
    return np.asarray(k, float) * (np.asarray(d, float) + 2.0 / (flow_slope(rest) * np.asarray(gamma, float)))


def analogue_frequency(d: ArrayLike, gamma: ArrayLike, rest: ArrayLike = 0.5) -> Array:
    """omega_H at the edge, from omega_H^2 = 2 + sigma gamma d."""
    return np.sqrt(2.0 + flow_slope(rest) * np.asarray(gamma, float) * np.asarray(d, float))


def one_sided_jacobians(
    s: float, d: float, k: float, gamma: float, alpha: float, rest: float = 0.5
) -> tuple[Array, Array]:
    """Jacobians (4, 4) of the proportional loop at rest, for u > 0 and for u < 0, by y1 .. y4."""
    a, up, down = linearise(Actuator(alpha, gamma, k), rest)
    opening = np.array([-s, -d, 0.0, 0.0])
    return np.asarray(a + np.outer(up, opening), float), np.asarray(a + np.outer(down, opening), float)
