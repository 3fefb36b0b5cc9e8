"""At which gain a step leaves the loop swinging: an interval, since noise, friction and the smallest chance decide.

The edge is the smallest gain at which a run swings: the gain rises from one that settles, by a small factor, until a
run swings, and the last interval is bisected. Near an edge the piston sticks and breaks loose irregularly: one gain
settles with one noise of the card and swings with another, so each noise has its own edge. A coarser search would meet
the edge later and with more scatter. The edges of some noises have a mean and a standard deviation, in the logarithm of
the gain, and these give the interval.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from controller.stability.amplitude.drive import Drive, DriveState
from controller.stability.amplitude.linear_law import LinearLaw
from controller.stability.amplitude.run import Card, Course, Decide, run_asking, run_linear
from controller.stability.amplitude.swing import LARGEST, Swing, last_third

SECONDS, PERIODS, DELAYS = 20.0, 200.0, 10.0  # of a run, the longest of them
LONGEST, LEAST = 100.0, 20.0  # but at most so many seconds, or so many periods
SLOWEST = 5.0  # [s], a sampling period: LEAST of them are a longest run
BACK = 0.4  # of a rough edge with one noise, where the search starts with each: theirs may be much lower
SEEDS = tuple(range(1, 7))  # of the card's noise, whose edges span an interval
SPREAD = 1.3  # standard deviations of an edge on both sides of the mean
WIDER = 1.05  # beyond that, for what the reduction leaves out
TOLERANT = 1  # noises without an edge that do not count


class Scan(NamedTuple):
    """How gains are searched, all as ratios of gains."""

    ratio: float  # from one run of the scan to the next
    tolerance: float  # between settling and swinging
    up: float  # times the first gain, how far is searched
    down: float  # the first gain over this, how far back
    back: float  # from one run to the next on the way down


SCAN = Scan(ratio=1.05, tolerance=1.02, up=300.0, down=10.0, back=0.8)
ROUGH = Scan(ratio=1.25, tolerance=1.04, up=300.0, down=10.0, back=0.7)  # for charts


class Loop(NamedTuple):
    """A reduced drive under a law."""

    drive: Drive
    start: DriveState
    law: Callable[[float], LinearLaw | Decide]  # the law afresh, at a gain
    when: Course
    card: Card


class Edge(NamedTuple):
    """The edge with one noise."""

    settles: float  # largest gain below the edge that settles; 0.0: none does
    swings: float  # smallest that swings; inf: none does
    frequency: float  # [Hz], there
    peak_to_peak: float  # [m], there


class Interval(NamedTuple):
    """Where the edge of a step is expected."""

    size: float  # of the step [m], upwards positive
    low: float  # settles below
    high: float  # swings above; inf: never
    frequency: float  # [Hz], of the swing at the edge, the median; 0.0: irregular
    frequencies: tuple[float, float]  # [Hz], least and greatest
    peaks: tuple[float, float]  # [m], peak to peak there


def lasting(period: float, delay: float) -> float:
    """Length [s] of a run, whole sampling periods. Raises ValueError for a period beyond SLOWEST."""
    if period > SLOWEST:
        raise ValueError(f"a sampling period of {period:g} s is beyond the theory, which ends at {SLOWEST:g} s")
    wanted = max(SECONDS, PERIODS * period, DELAYS * delay)
    return period * math.ceil(round(min(wanted, max(LONGEST, LEAST * period)) / period, 6))


def swing(loop: Loop, gain: float, size: float, seed: int = SEEDS[0]) -> Swing:
    """The last third after a step of a size [m] at a gain, with one noise of the card."""
    law = loop.law(gain)
    if isinstance(law, LinearLaw):
        return last_third(*run_linear(loop.drive, loop.start, law, size, loop.when, loop.card, seed))
    return last_third(*run_asking(loop.drive, loop.start, law, size, loop.when, loop.card, seed))


def edge(loop: Loop, size: float, seed: int, first: float, scan: Scan = SCAN, largest: float = LARGEST) -> Edge:
    """The smallest gain that swings with one noise, searched upwards from a gain `first` or from what settles below.

    largest: peak to peak [m] up to which a run counts as settled.
    """
    return smallest_swinging(lambda gain: swing(loop, gain, size, seed), first, scan, largest)


def smallest_swinging(swing_at: Callable[[float], Swing], first: float, scan: Scan, largest: float = LARGEST) -> Edge:
    """The edge of what `swing_at` does at a gain: down from `first` until it settles, up until it swings, bisected.

    Raises ValueError for a first gain that no search can start from.
    """
    if not 0.0 < first < math.inf:
        raise ValueError(f"a search for an edge starts from a finite gain above 0, not from {first:g}")
    low, high, found = 0.0, first, swing_at(first)
    while found.peak_to_peak > largest and high > first / scan.down:
        high *= scan.back
        found = swing_at(high)
    if found.peak_to_peak > largest:
        return Edge(0.0, high, found.frequency, found.peak_to_peak)
    while found.peak_to_peak <= largest:
        low, high = high, high * scan.ratio
        if high > first * scan.up:
            return Edge(low, math.inf, 0.0, 0.0)
        found = swing_at(high)
    return _bisected(swing_at, Edge(low, high, found.frequency, found.peak_to_peak), scan.tolerance, largest)


def _bisected(swing_at: Callable[[float], Swing], found: Edge, tolerance: float, largest: float) -> Edge:
    """An edge with its gains nearer to each other."""
    while found.swings > found.settles * tolerance:
        middle = math.sqrt(found.settles * found.swings)
        between = swing_at(middle)
        if between.peak_to_peak > largest:
            found = Edge(found.settles, middle, between.frequency, between.peak_to_peak)
        else:
            found = found._replace(settles=middle)
    return found


def nearer(found: Edge, first: float) -> float:
    """Where the search with the other noises starts."""
    return max(first, BACK * found.swings) if math.isfinite(found.swings) else first


def spanned(size: float, found: Sequence[Edge]) -> Interval:
    """The interval that the edges of some noises give."""
    swinging = [one for one in found if math.isfinite(one.swings)]
    low, high = _reach([one.swings for one in swinging])
    if len(found) - len(swinging) > TOLERANT or not swinging:
        high = math.inf
    often = [one.frequency for one in swinging if one.frequency > 0.0] or [0.0]
    peaks = [one.peak_to_peak for one in swinging] or [0.0]
    return Interval(size, low, high, float(np.median(often)), (min(often), max(often)), (min(peaks), max(peaks)))


def _reach(gains: Sequence[float]) -> tuple[float, float]:
    """Below and above which another noise's edge is not expected."""
    if not gains:
        return math.inf, math.inf
    logarithms = np.log(gains)
    middle, spread = float(logarithms.mean()), float(logarithms.std(ddof=1)) if len(gains) > 1 else 0.0
    reach = SPREAD * spread + math.log(WIDER)
    return math.exp(middle - reach), math.exp(middle + reach)
