"""The relay loop u = -sign(s y1 + d y2), smoothed to u = -tanh(h/eps): polynomial and Hopf point for any eps.

Source: 5.3.2, (5.20) to (5.22). With g = gamma/(sqrt2 alpha) the difference of pressures obeys

    lambda^3 + (k + g) lambda^2 + (2 + k g + sqrt2 gamma d/eps) lambda + sqrt2 gamma s/eps.

Smoothing makes the rest that the relay itself has not; as eps -> 0 the edge stays and the frequency grows without
bound. There is no sliding: h' = s y2 + d y2' is the same on both sides of h = 0.
"""

import numpy as np
from numpy.typing import ArrayLike

from controller.stability.actuator.model import Actuator, Drive
from controller.stability.plant import SQRT2, Array, Plant


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


def critical_derivative_time(drive: Drive) -> float:
    """(5.22) of the relay in SI: T_d = D/P [s] below which the loop oscillates, d_H/(s omega).

    1/T_d = K_q B/(A L) + K/m: how fast the open valve lets the pressures decay, K_q = Q_max/sqrt(2)/(p_s - p_r)
    being its slope [m^3/(s Pa)] at half the pressure, and how fast friction lets the speed decay. Neither mass nor gain
    nor the size of the swing is in it; a hold, a delay and the valve's switching time are not either.
    """
    slope = drive.flow / (SQRT2 * (drive.supply - drive.relief))
    return 1.0 / (slope * drive.modulus / (drive.area * drive.length) + drive.friction / drive.mass)


def open_actuator(actuator: Actuator) -> Plant:
    """The actuator about half the supply at an open valve, u = +-1: states y1, y2, a = alpha (y3 - y4).

    The valve lets a decay by g = gamma/(sqrt2 alpha), which the actuator about its shut valve lacks: a' = -2 y2 - g a
    + sqrt2 gamma u. Its polynomial under h = s y1 + d y2 with u = -h/eps is that of `relay_polynomial`.
    """
    alpha, gamma, k = actuator
    g = gamma / (SQRT2 * alpha)
    a = np.array([[0.0, 1.0, 0.0], [0.0, -k, 1.0], [0.0, -2.0, -g]])
    return Plant(a, np.array([0.0, 0.0, SQRT2 * gamma]), np.eye(3)[0], np.eye(3)[1])


def relay_frequency(s: ArrayLike, k: ArrayLike, gamma: ArrayLike, alpha: ArrayLike, eps: ArrayLike) -> Array:
    """omega_H of the smoothed relay, from omega_H^2 = sqrt2 gamma s/(eps (k + g)); eps > 0."""
    gamma = np.asarray(gamma, float)
    g = gamma / (SQRT2 * np.asarray(alpha))
    return np.sqrt(SQRT2 * gamma * s / (np.asarray(eps) * (np.asarray(k) + g)))
