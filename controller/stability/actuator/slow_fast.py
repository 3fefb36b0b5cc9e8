"""The actuator at two speeds: pressures fall onto a manifold within a time of order alpha, then follow the piston.

Source: 5.3.1, (5.14) to (5.19). With a valve held open by u and r = y2/(gamma u), the manifold of a stiff oil
(alpha -> 0) is where the flows fit the speed:

    u > 0: y3 = 1 - r |r|, y4 = r |r|;      u < 0: y3 = r |r|, y4 = 1 - r |r|.

It always attracts. On it y1' = y2, y2' = alpha sign(u) (1 - 2 r |r|) - k y2, whose slopes at rest give 0 and -k on both
sides of the relay: neutral. Acceleration jumps with u there, so the reduced relay loop slides along h = 0 to its rest,
whatever d > 0; the whole one cannot, (5.13), and oscillates below d_H. So what the loop does near its rest is decided
by the pressures the manifold leaves out, by the compressibility. Dimensionless numbers or arrays, u != 0.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from controller.stability.actuator.model import Actuator, field
from controller.stability.plant import Array


def critical_manifold(y2: ArrayLike, u: ArrayLike, gamma: ArrayLike) -> tuple[Array, Array]:
    """Pressures y3, y4 at which stiff oil lets the piston move at y2 (5.17)."""
    r = np.asarray(y2) / (np.asarray(gamma) * u)
    drop = r * np.abs(r)
    return np.where(np.asarray(u) > 0.0, 1.0 - drop, drop), np.where(np.asarray(u) > 0.0, drop, 1.0 - drop)


def layer_rates(y1: ArrayLike, y2: ArrayLike, u: ArrayLike, gamma: ArrayLike, alpha: ArrayLike) -> tuple[Array, Array]:
    """Eigenvalues of the pressures on the manifold, -(gamma u)^2/(2 alpha (1 +- y1) |y2|) (5.19); always negative."""
    y1, drive = np.asarray(y1, float), np.asarray(gamma, float) * np.asarray(u, float)
    rate = -(drive**2) / (2.0 * np.asarray(alpha, float) * np.abs(np.asarray(y2, float)))
    return rate / (1.0 + y1), rate / (1.0 - y1)


def reduced_rates(y2: ArrayLike, u: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike) -> tuple[Array, Array]:
    """y1', y2' on the manifold."""
    y3, y4 = critical_manifold(y2, u, gamma)
    speed = np.asarray(y2, float)
    return speed, np.asarray(alpha, float) * (y3 - y4) - np.asarray(k, float) * speed


def slides(
    y2: ArrayLike, s: ArrayLike, d: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike
) -> NDArray[np.bool_]:
    """Does the reduced relay loop stay on h = 0? Where u = 1 (h < 0) raises h and u = -1 (h > 0) lowers it."""
    moves = (reduced_rates(y2, u, k, gamma, alpha) for u in (1.0, -1.0))
    up, down = (np.asarray(s) * speed + np.asarray(d) * rate for speed, rate in moves)
    return (up > 0.0) & (down < 0.0)


def full_rates(y: Array, u: float, k: float, gamma: float, alpha: float) -> Array:
    """y1' .. y4' of the whole actuator with the valve held at u, (5.7), (5.8)."""
    return np.asarray(field(y, u, Actuator(alpha, gamma, k)), float)
