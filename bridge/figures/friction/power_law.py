"""The friction test brought to one curve: g over z, and the power law found in it.

Source: 2.3, (2.13), (2.14). F_f = g(z) p_w b pi (D + d), z = mu v/(p_w b), p_w = |p_l - p_u|; g = alpha |z|^beta by
least squares on log |g| over log |z|, below the limit. Downwards the force is `seal.downward` times that, so that both
directions fall on one curve.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.canvas import Array
from bridge.figures.friction.constant_speed import Readings
from twin.seal import Seal

BELOW_LIMIT = 0.95  # share of g_max above which a point may lie on the plateau


class PowerLaw(NamedTuple):
    """g = alpha |z|^beta."""

    alpha: float
    beta: float


def factor(test: Readings, seal: Seal) -> tuple[Array, Array]:
    """z and g of the readings."""
    per_width = test.sealing * seal.width
    g = test.force / (per_width * seal.perimeter * _share(test.speed, seal))
    return seal.viscosity * test.speed / per_width, g


def _share(speed: Array, seal: Seal) -> Array:
    """Friction at speeds [m/s] over that upwards."""
    return np.where(speed < 0.0, seal.downward, 1.0)


def on_slope(test: Readings, seal: Seal) -> NDArray[np.bool_]:
    """Which readings the power law is fitted to: speed constant, friction against the motion and below its limit."""
    z, g = factor(test, seal)
    return test.steady & (z * g > 0.0) & (np.abs(g) < BELOW_LIMIT * seal.limit)


def fit_power_law(test: Readings, seal: Seal) -> PowerLaw:
    """Least squares on log |g| over log |z|."""
    used = on_slope(test, seal)
    z, g = factor(test, seal)
    beta, log_alpha = np.polyfit(np.log(np.abs(z[used])), np.log(np.abs(g[used])), 1)
    return PowerLaw(float(np.exp(log_alpha)), float(beta))


def limited(z: Array, law: PowerLaw, limit: float) -> Array:
    """g of a power law cut at its limit; odd in z."""
    size = np.maximum(np.abs(z), 1e-30)  # at z = 0 the power is infinite and the limit holds
    return np.sign(z) * np.minimum(limit, law.alpha * size**law.beta)


def law_force(speed: Array, sealing: Array, seal: Seal) -> Array:
    """F_f [N] of the rig's own law at speeds [m/s] and sealing pressures [Pa]."""
    per_width = sealing * seal.width
    law = PowerLaw(seal.alpha, seal.beta)
    g = limited(seal.viscosity * speed / per_width, law, seal.limit)
    return g * per_width * seal.perimeter * _share(speed, seal)
