"""Which gains leave a step swinging, where every run costs much: the gain to run next, and what the runs say.

Gains that swing are islands: a louder loop may settle, and one louder still swing again. So a search by halves ends at
the shore of any of them, and where it began decides of which. Here the gains are scanned: FINE apart over a rung below
the lowest that is known to swing, with a quiet one a rung further down, and COARSE apart from there up to COVER times
that gain, or up to FURTHER where most of them settle. A scan still misses single gains that swing, so the interval
also holds what the edges of some noises of a cheaper model say.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import groupby, pairwise
from typing import NamedTuple

from controller.stability.amplitude.edges import Interval
from controller.stability.amplitude.swing import Swing

RUNG = 1.5  # between gains while none is known to swing, and on the way down
FINE, COARSE = RUNG**0.125, RUNG**0.25
QUIET = RUNG**2  # below the lowest that swings, how far is scanned
COVER, FURTHER = 2.0, 3.0  # above it
MOSTLY = 0.7  # share of the gains up to COVER, of those that settle
MOST, LEAST = 64.0, 1e-2  # of the gain it begins with, how far is searched
SHARP, RAGGED, SCATTERED = 1.08, 1.1, 1.4  # below the lowest that swings, where the interval begins
ABOVE, BEYOND = 1.15, 1.1  # above it at least, and above the loudest that settles
ROUNDING = 1.0 + 1e-9
Runs = Mapping[float, Swing]  # by gain


class Scanned(NamedTuple):
    """Where a step begins to swing, and all that was seen."""

    size: float  # of the step [m], upwards positive
    low: float  # every gain below settles; 0.0: all that were tried swing; inf: none does
    high: float  # a search for the edge ends below
    frequency: float  # [Hz], of the quietest swing that has one; 0.0: irregular
    frequencies: tuple[float, float]  # [Hz], least and greatest up to `high`
    peaks: tuple[float, float]  # [m], peak to peak, up to `high`
    islands: tuple[tuple[float, float], ...]  # gains that swing, from the first to the last in a row
    settling: float  # the loudest gain that was seen to settle; 0.0: none was
    loudest: float  # gain that was run

    @property
    def swings_from(self) -> float:
        """From here on every gain that was run swings; inf: none does."""
        return max(self.high, self.settling * BEYOND)


def next_gain(runs: Runs, near: float) -> float | None:
    """Where to run next, beginning at a gain `near`; None: enough is known.

    First roughly on both sides of the lowest that swings, so that a search that is cut short knows both, then finely.
    """
    if near not in runs:
        return near
    lowest, least = lowest_swinging(runs), min(runs)
    if math.isinf(lowest):
        return max(runs) * RUNG if max(runs) * RUNG <= near * MOST else None
    if least * QUIET > lowest * ROUNDING and least / RUNG > near * LEAST:
        return least / RUNG
    return _between(runs, lowest, RUNG, COARSE) or _louder(runs, lowest) or _between(runs, lowest, RUNG, FINE)


def _louder(runs: Runs, lowest: float) -> float | None:
    """The next gain above the lowest that swings."""
    top = lowest * (FURTHER if mostly_settling(runs) else COVER)
    for gain in sorted(gain for gain in runs if gain >= lowest):
        further = min(gain * COARSE, top)
        if gain * ROUNDING < top and not any(gain < other <= further * ROUNDING for other in runs):
            return further
    return None


def _between(runs: Runs, lowest: float, depth: float, ratio: float) -> float | None:
    """The middle of the nearest gap below the lowest that swings, no deeper than a ratio and wider than another."""
    below = sorted(gain for gain in runs if gain <= lowest)
    gaps = [(a, b) for a, b in pairwise(below) if b * depth > lowest * ROUNDING and b > a * ratio * ROUNDING]
    return math.sqrt(math.prod(gaps[-1])) if gaps else None


def lowest_swinging(runs: Runs) -> float:
    """The smallest gain that swings; inf: none does."""
    return min((gain for gain, swing in runs.items() if swing.counts), default=math.inf)


def mostly_settling(runs: Runs) -> bool:
    """Do most of the gains up to COVER times the lowest that swings settle?"""
    lowest = lowest_swinging(runs)
    louder = [swing for gain, swing in runs.items() if lowest < gain <= COVER * lowest * ROUNDING]
    return bool(louder) and sum(not swing.counts for swing in louder) >= MOSTLY * len(louder)


def scanned(size: float, runs: Runs, expected: Interval | None) -> Scanned:
    """What the runs of a step of a size [m] say, and what a cheaper model gives for it, if there is one."""
    low, high = _interval(runs)
    if expected is not None and 0.0 < low < math.inf:
        low, high = _widened(low, high, runs, expected)
    swinging = [swing for gain, swing in sorted(runs.items()) if swing.counts and gain <= high]
    often = [swing.frequency for swing in swinging if swing.frequency > 0.0] or [0.0]
    peaks = [swing.peak_to_peak for swing in swinging] or [0.0]
    spans = (min(often), max(often)), (min(peaks), max(peaks))
    settling = max((gain for gain, swing in runs.items() if not swing.counts), default=0.0)
    return Scanned(size, low, high, often[0], *spans, tuple(_islands(runs)), settling, max(runs))


def _interval(runs: Runs) -> tuple[float, float]:
    """Where any search for the edge is expected to end.

    The loudest gain that settles bounds it, but it spans no more than COVER unless most of the gains settle there.
    """
    lowest, scattered = lowest_swinging(runs), mostly_settling(runs)
    if math.isinf(lowest):
        return math.inf, math.inf
    top = lowest * (FURTHER if scattered else COVER) * ROUNDING
    settling = [gain for gain, swing in runs.items() if lowest < gain <= top and not swing.counts]
    if not settling:
        return _low(runs, lowest, SHARP), ABOVE * lowest
    low = _low(runs, lowest, SCATTERED if scattered else RAGGED)
    high = max(BEYOND * max(settling), ABOVE * lowest)
    return low, high if scattered else min(high, COVER * lowest / RAGGED)


def _widened(low: float, high: float, runs: Runs, expected: Interval) -> tuple[float, float]:
    """The interval with an expected one in it; it spans no more than COVER, unless most of the gains settle there."""
    lowest, low = lowest_swinging(runs), min(low, expected.low)
    if mostly_settling(runs):
        return low, max(high, min(expected.high, COVER * low))
    low = max(low, ABOVE * lowest / COVER)
    return low, min(max(high, expected.high), COVER * low)


def _low(runs: Runs, lowest: float, margin: float) -> float:
    """The lower end: below the lowest that swings by a margin, or below the next that settles where none is nearer."""
    below = max((gain for gain in runs if gain < lowest), default=0.0)
    return min(below, lowest / margin)


def _islands(runs: Runs) -> Iterator[tuple[float, float]]:
    for swinging, gains in groupby(sorted(runs), key=lambda gain: runs[gain].counts):
        if swinging:
            island = list(gains)
            yield island[0], island[-1]
