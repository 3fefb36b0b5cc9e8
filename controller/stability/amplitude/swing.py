"""How a position swings in the last third of a run: peak to peak, and how often."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LARGEST = 3e-4  # [m], peak to peak: what does not count as swinging
MARGIN = 1.15  # up and down: over the card's noise the peak to peak of one hunting loop scatters by 10 to 15 % (rms)
WIDE = 1e-3  # [m], peak to peak, assumed: more than the hunting of a piston that sticks and slips
PERIODS = 2.5  # that a swing must fit into the last third; slower ones are creep and jumps
Array = NDArray[np.float64]


class Swing(NamedTuple):
    """What the last third of a run holds."""

    peak_to_peak: float  # [m], of what goes both ways
    frequency: float  # [Hz], of the strongest line of its spectrum; 0.0: slower than can be told

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
    """Frequency [Hz] of the strongest line about the trend, between the bins by a parabola through three of them."""
    even = np.linspace(time[0], time[-1], len(time))
    x = np.interp(even, time, position)
    x = (x - np.polyval(np.polyfit(even, x, 1), even)) * np.hanning(len(x))
    power = np.abs(np.fft.rfft(x, 4 * len(x)))
    span = 4.0 * (time[-1] - time[0]) * len(x) / (len(x) - 1)
    first = int(np.ceil(PERIODS / (time[-1] - time[0]) * span))
    k = int(np.argmax(power))
    if not first < k < len(power) - 1:
        return 0.0
    low, top, high = power[k - 1 : k + 2]
    return float((k + 0.5 * (low - high) / (low - 2.0 * top + high)) / span)
