"""How much of a measured signal is noise and rounding, and which of its samples say nothing.

The noise of a signal that nobody has stated is estimated from its third differences: a smooth motion leaves little in
them, white noise of variance s^2 leaves 20 s^2. The median over windows leaves out those in which something happens.
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
WINDOW = 50  # samples
THIRD = 20.0  # 1 + 9 + 9 + 1
MEDIAN = 1.0 - 2.0 / (9.0 * WINDOW)  # of chi squared over its mean, Wilson and Hilferty, cubed
ROUNDING = 1.0 / math.sqrt(12.0)  # deviation of a rounding error, in steps
NEAR = 10  # samples on either side of one at an end of the range


def stated(step: float, noise: float, quantised: bool) -> float:
    """Deviation of noise [LSB rms] and rounding on a card with a step [SI]."""
    return step * math.hypot(noise, ROUNDING if quantised else 0.0)


def estimated(value: Array) -> float:
    """Deviation of the noise in a signal, rounding included."""
    sound = value[np.isfinite(value)]
    if len(sound) < 4 * WINDOW:
        raise ValueError(f"{len(sound)} samples are too few to estimate the noise; at least {4 * WINDOW}")
    jumps = np.diff(sound, 3)
    squares = (jumps[: len(jumps) // WINDOW * WINDOW].reshape(-1, WINDOW) ** 2).mean(axis=1) / THIRD
    return max(math.sqrt(float(np.median(squares)) / MEDIAN**3), ROUNDING * resolution(sound))


def resolution(value: Array) -> float:
    """The step of a rounded signal: the least difference of its values; 0.0 where there is none."""
    levels = np.unique(value[np.isfinite(value)])
    gaps = np.diff(levels)
    return float(gaps.min()) if len(gaps) else 0.0


def counted(value: Array, low: float, high: float) -> NDArray[np.bool_]:
    """Samples that tell how great the signal was: not absent, and none near one at an end of the range.

    Dropping only those at the end would keep the noise of one sign of their neighbours.
    """
    with np.errstate(invalid="ignore"):
        bad = ~np.isfinite(value) | (value <= low) | (value >= high)
    spread = np.convolve(bad.astype(float), np.ones(2 * NEAR + 1), "same") > 0.5
    return ~spread
