"""Is a sensor to be believed, and are the innovations what a right model makes: white and of variance 1?

A reading that is more than `SUSPECT` deviations away counts less, by as much as makes it that far. Where one channel is
farther away than `GATE` and no other is, the first such reading is left out, and so is a channel that stays so, until
it has been back for a while; where several are, the model is wrong, and all count. So one channel at a time is left
out: two that are bad at once cannot be told from a wrong model. A channel of a card with noise that repeats one value
for `STUCK` scans is stuck; at the end of its range it may. All numbers are assumed.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.estimation.quantities import Use

SUSPECT = 3.0
GATE = 8.0
BAD, GOOD = 20, 50  # readings in a row after which a channel is left out, and taken again
STUCK = 150  # readings: with a noise of a third of a step or more, by chance one time in 1e9
LEAST_NOISE = 0.3  # [LSB]
WINDOW = 1000  # readings of a channel that are judged together
FEWEST = 50


MOST_ALIKE = 0.9
LEAST_SQUARE = 0.05  # of the mean square of innovations that a deviation is stated by


class Verdict(NamedTuple):
    """Of a channel, over the window."""

    nis: float  # mean square of the whitened innovations, 1 as long as the model is right; NaN: too few
    whiteness: float  # their correlation from one to the next, 0 as long as it is right; NaN: too few, or all are 0
    readings: int

    @property
    def square(self) -> float:
        """Mean square of as many innovations as are independent (Bayley, Hammersley 1946); NaN: too few."""
        alike = min(max(self.whiteness, 0.0), MOST_ALIKE)
        return self.nis * (1.0 + alike) / (1.0 - alike)


def stated(spread: NDArray[np.float64], prior: NDArray[np.float64], square: float) -> NDArray[np.float64]:
    """The deviation to be stated of quantities of which an ensemble has a spread, and had one before any reading.

    square: mean square of the independent innovations, whitened. The errors that the filter allows its model are those
    of a rig at the worst; how large they are on this one the innovations say, whose mean square is the factor by which
    variances are too large: the variance of unit weight of an adjustment (Koch 1999, 3.2), of filters Mehra 1970.
    What was known beforehand owes nothing to these errors, so only the information that has come since is scaled; what
    spreads wider than beforehand (friction does, of a piston that may stick or not) is stated as it spreads. A square
    above 1 widens the whole.
    """
    if square >= 1.0:
        return spread * math.sqrt(square)
    with np.errstate(divide="ignore", invalid="ignore"):
        before = np.where(prior > 0.0, prior**-2.0, 0.0)
        since = np.maximum(spread**-2.0 - before, 0.0)
        found = (before + since / max(square, LEAST_SQUARE)) ** -0.5
    return np.where(since > 0.0, np.minimum(found, spread), spread)


class Watch:
    """One channel."""

    def __init__(self, noise: float, ends: tuple[float, float]) -> None:
        self.use = Use.MISSING
        self.left_out = False  # for longer than a reading, be it there or missing
        self._noisy = noise >= LEAST_NOISE
        self._ends = ends
        self._last, self._same, self._bad, self._good = math.nan, 0, 0, 0
        self._missed, self._readings = np.zeros(WINDOW), 0  # the newest last, and how many there are
        self._verdict: Verdict | None = None  # on them

    def look(self, reading: float, away: float, alone: bool) -> float:
        """How much of a reading's variance counts more than stated; NaN where it is left out.

        away: the innovation over its deviation; alone: no other channel is as far away.
        """
        self._same = self._same + 1 if reading == self._last else 0
        self._last = reading
        if math.isnan(reading):
            self.use = Use.MISSING
            return math.nan
        inside = self._ends[0] < reading < self._ends[1]
        stuck = self._noisy and self._same >= STUCK and inside
        far = alone and abs(away) > GATE
        self._bad, self._good = (self._bad + 1, 0) if far else (0, self._good + 1)
        if stuck:
            self.use = Use.STUCK
        elif self._bad >= BAD or (self.left_out and self._good < GOOD):
            self.use = Use.OFF
        else:
            self.use = Use.SPIKE if self._bad == 1 else Use.USED  # one alone is a spike; more may be the model's fault
        self.left_out = self.use in (Use.OFF, Use.STUCK)
        if self.use != Use.USED:
            return math.nan
        return max(0.0, (away / SUSPECT) ** 2 - 1.0)

    def note(self, missed: NDArray[np.float64]) -> None:
        """Take whitened innovations of readings that were used."""
        used = missed[~np.isnan(missed)][-WINDOW:]
        if count := len(used):
            self._missed[:-count] = self._missed[count:]
            self._missed[-count:] = used
            self._readings, self._verdict = min(WINDOW, self._readings + count), None

    def verdict(self) -> Verdict:
        """Over the last second or so."""
        if self._verdict is None:
            self._verdict = _verdict(self._missed[WINDOW - self._readings :])
        return self._verdict


def _verdict(missed: NDArray[np.float64]) -> Verdict:
    if len(missed) < FEWEST:
        return Verdict(math.nan, math.nan, len(missed))
    square = float((missed * missed).mean())
    if square == 0.0:  # what is read and what is expected lie at the same end of a range
        return Verdict(0.0, math.nan, len(missed))
    return Verdict(square, float((missed[1:] * missed[:-1]).mean()) / square, len(missed))
