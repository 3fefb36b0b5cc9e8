"""How a position swings in the last third of a run: peak to peak, and how often."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LARGEST = 3e-4  # [m], peak to peak: what does not count as swinging
MARGIN = 1.15  # up and down: over the card's noise the peak to peak of one hunting loop scatters by 10 to 15 % (rms)
WIDE = 1e-3  # [m], peak to peak, assumed: more than the hunting of a piston that sticks and slips
PERIODS = 2.5  # that a swing must fit into the last third; slower ones are creep and jumps
NEAR, SHARE = (
    1.2,
    0.5,
)  # of the power about the trend this share lies within a ratio of the frequency, or it is irregular
LINE = 2  # bins on either side that a single line fills under the window
REFINED = 4  # places of the spectrum in a bin
Array = NDArray[np.float64]


class Swing(NamedTuple):
    """What the last third of a run holds."""

    peak_to_peak: float  # [m], of what goes both ways
    frequency: float  # [Hz], of the strongest line of its spectrum; 0.0: irregular, or slower than can be told

    @property
    def counts(self) -> bool:
        """Is it more than LARGEST?"""
        return self.peak_to_peak > LARGEST

    @property
    def is_marginal(self) -> bool:
        """May another noise of the card put it on the other side of LARGEST?"""
        return LARGEST / MARGIN < self.peak_to_peak <= LARGEST * MARGIN


def last_third(time: Array, position: Array) -> Swing:
    """The swing of a run that starts at time 0."""
    late = time >= 2.0 / 3.0 * time[-1]
    peak = to_and_fro(position[late])
    return Swing(peak, strongest(time[late], position[late]) if peak > LARGEST else 0.0)


def to_and_fro(position: Array) -> float:
    """Peak to peak [m] of what goes both ways: the lesser of the greatest rise and the greatest fall.

    So a loop of small gain, still on its way to the reference in the end, does not swing.
    """
    rise = position - np.minimum.accumulate(position)
    fall = np.maximum.accumulate(position) - position
    return float(min(rise.max(), fall.max()))


def strongest(time: Array, position: Array) -> float:
    """Frequency [Hz] of the strongest line about the trend, between the bins by a parabola; 0.0 of an irregular swing.

    A piston that sticks and hops at moments of chance has a strongest line, too, but little of its power is there.
    """
    even = np.linspace(time[0], time[-1], len(time))
    x = np.interp(even, time, position)
    x = (x - np.polyval(np.polyfit(even, x, 1), even)) * np.hanning(len(x))
    size = np.abs(np.fft.rfft(x, REFINED * len(x)))
    span = REFINED * (time[-1] - time[0]) * len(x) / (len(x) - 1)
    first = int(np.ceil(PERIODS / (time[-1] - time[0]) * span))
    k = int(np.argmax(size))
    if not first < k < len(size) - 1 or _share_near(size**2, k) < SHARE:
        return 0.0
    low, top, high = size[k - 1 : k + 2]
    return float((k + 0.5 * (low - high) / (low - 2.0 * top + high)) / span)


def _share_near(power: Array, k: int) -> float:
    """The share of the power within NEAR of a place of the spectrum, or within its line."""
    low, high = math.floor(min(k / NEAR, k - LINE * REFINED)), math.ceil(max(k * NEAR, k + LINE * REFINED))
    return float(power[max(0, low) : high + 1].sum() / power.sum())
