"""Residuals that are far out count less, or not at all: a rod that sticks where the rig's slides decides nothing."""

import numpy as np

from bridge.studies.identification.data import Array

FAR_OUT = 5.0  # deviations from which on a residual counts less


def tamed(residual: Array, blind: bool = False) -> Array:
    """The residual r as one whose square grows only with abs(r) far out: pseudo-Huber, 2 c^2 (sqrt(1 + (r/c)^2) - 1).

    A rod that sticks where the other slides is off by hundreds of deviations for a moment and says little of the
    numbers; noise is left as it is. blind: its square does not grow at all, Welsch, c^2 (1 - exp(-(r/c)^2)): where a
    rod that sticks all but breaks away, pressures are off until it moves again, and would pull numbers that are right
    otherwise.
    """
    if blind:
        return np.sign(residual) * FAR_OUT * np.sqrt(-np.expm1(-((residual / FAR_OUT) ** 2)))
    return np.sign(residual) * FAR_OUT * np.sqrt(2.0 * (np.hypot(1.0, residual / FAR_OUT) - 1.0))


def taming(residual: Array, blind: bool = False) -> Array:
    """Slope of `tamed`."""
    small = np.abs(residual) < 1e-3
    own = np.where(small, 1.0, np.abs(tamed(residual, blind)))
    if blind:
        return np.where(small, 1.0, np.abs(residual) * np.exp(-((residual / FAR_OUT) ** 2)) / own)
    return np.where(small, 1.0, np.abs(residual) / (np.hypot(1.0, residual / FAR_OUT) * own))
