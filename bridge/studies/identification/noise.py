"""How much of a measured signal is noise and rounding, and which of its samples say nothing.

The noise of a signal that nobody has stated is estimated from its third differences: a smooth motion leaves little in
them, white noise of variance s^2 leaves 20 s^2. The median over windows leaves out those in which something happens.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.scenario.units import quantity, shown, split

Array = NDArray[np.float64]
WINDOW = 50  # samples
FEWEST = 4 * WINDOW  # that are known, for an estimate
THIRD = 20.0  # 1 + 9 + 9 + 1
MEDIAN = 1.0 - 2.0 / (9.0 * WINDOW)  # of chi squared over its mean, Wilson and Hilferty, cubed
ROUNDING = 1.0 / math.sqrt(12.0)  # deviation of a rounding error, in steps
NEAR = 10  # samples on either side of one at an end of the range
FLOOR = 1e-4  # of a signal's span, assumed: the least deviation, where none is stated


class Deviation(NamedTuple):
    """Of the noise in a signal [SI], or none; and what whoever reads the result should know of it."""

    value: float | None
    note: str = ""


def stated(step: float, noise: float, quantised: bool) -> float:
    """Deviation of noise [LSB rms] and rounding on a card with a step [SI]."""
    return step * math.hypot(noise, ROUNDING if quantised else 0.0)


def stated_by_hand(name: str, text: str, unit: str) -> tuple[float, str]:
    """A deviation such as "0.05 bar" [SI], and a note where it has no unit. Raises ValueError.

    It is a difference: no unit's zero point counts.
    """
    written = split(text)[1]
    found = quantity(text, unit) - quantity(f"0 {written}".strip(), unit)
    if not 0.0 < found < math.inf:
        raise ValueError(f"{text!r}: must be above 0, and finite")
    return found, "" if written else f"{name} has a noise of {found:g} {unit}: --noise names no unit".rstrip()


def deviation_of(value: Array, known: float, is_stated: bool, unit: str) -> Deviation:
    """Deviation of the noise in a measured signal, by what is known of its sensor; none where nothing can be."""
    sound = value[np.isfinite(value)]
    span = float(np.ptp(sound)) if len(sound) else 0.0
    if not span > 0.0:
        return Deviation(None, "never changes, and says nothing")
    if known > 0.0 and is_stated:
        return Deviation(known)
    if not known > 0.0 and len(sound) < FEWEST:
        return Deviation(
            None, f"has {len(sound)} samples, and to estimate its noise takes {FEWEST}: state it in the map"
        )
    found = known or estimated(value)
    if found >= FLOOR * span:
        return Deviation(found)
    factor, name = shown(unit)
    words = f"has hardly any noise; {FLOOR * span * factor:.2g} {name} is assumed, {FLOOR:g} of its span"
    return Deviation(FLOOR * span, f"{words}: --noise says better")


def estimated(value: Array) -> float:
    """Deviation of the noise in a signal of FEWEST samples or more, rounding included."""
    sound = value[np.isfinite(value)]
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
