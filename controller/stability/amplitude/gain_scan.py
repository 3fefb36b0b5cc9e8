"""Which gains leave a step swinging, where every run costs much: the gain to run next, and what the runs say.

Gains that swing are islands: a louder loop may settle, and one louder still swing again. So a search by halves ends at
the shore of any of them, and where it began decides of which. Here the gains are scanned: FINE apart over a rung below
the lowest that is known to swing, with a quiet one a rung further down, and COARSE apart from there up to COVER times
that gain, or up to FURTHER where most of them settle. A scan still misses single gains that swing, so the interval
also holds what the edges of some noises of a cheaper model say, and gains whose swing is marginal.

Where small gains swing, too, the band is the widest stretch between two gains that swing. Its widest gap is halved
until all are COARSE near its edges and twice as much in its middle, since any gain in it that swings makes it narrower
and may leave another stretch the widest. Then its upper edge is looked at as above.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import groupby, pairwise
from typing import NamedTuple

from controller.stability.amplitude.band import LEAST, MOST, Outlook
from controller.stability.amplitude.edges import Interval
from controller.stability.amplitude.swing import Swing

RUNG = 1.5  # between gains while none is known to swing, and on the way down
FINE, COARSE = RUNG**0.125, RUNG**0.25
QUIET = RUNG**2  # below the lowest that swings, how far is scanned
COVER, FURTHER = 2.0, 3.0  # above it
MOSTLY = 0.7  # share of the gains up to COVER, of those that settle
CLOSE, SHARP, RAGGED, SCATTERED = 1.12, 1.15, 1.25, 1.4  # below the lowest that swings, where the interval begins
ABOVE, BEYOND = 1.15, 1.1  # above it at least, and above the loudest that settles
OUTWARDS = 12  # gains on either side of one that should settle and does not, RUNG**0.5 apart
DEEPER, HIGHER = 1.25, 1.25  # below the greatest gain that swings under the band, and above it, its interval
ROUNDING = 1.0 + 1e-9
Runs = Mapping[float, Swing]  # by gain


class Scanned(NamedTuple):
    """The band in which a step settles, and all that was seen."""

    size: float  # of the step [m], upwards positive
    low: float  # every gain of the band below settles; 0.0: all that were tried swing; inf: none does
    high: float  # a search for the upper edge ends below
    beneath: tuple[float, float]  # where a search for the lower edge ends; 0.0: there is none
    frequency: float  # [Hz], of the quietest swing above the band that has one; 0.0: irregular
    frequencies: tuple[float, float]  # [Hz], least and greatest up to `high`
    peaks: tuple[float, float]  # [m], peak to peak, up to `high`
    islands: tuple[tuple[float, float], ...]  # gains that swing, from the first to the last in a row
    settling: float  # the loudest gain that was seen to settle; 0.0: none was
    tried: tuple[float, float]  # least and greatest gain that was run

    @property
    def swings_from(self) -> float:
        """From here on every gain that was run swings; inf: none does."""
        return max(self.high, self.settling * BEYOND)


def next_gain(runs: Runs, look: Outlook) -> float | None:
    """Where to run next; None: enough is known.

    First roughly on both sides of the lowest that swings, so that a search that is cut short knows both, then finely.
    """
    if look.near not in runs:
        return look.near
    if (gain := _inside(runs, look) or _first_below(runs, look)) is not None:
        return gain
    base = base_of(runs, look)
    above, floor = runs_above(runs, base, look), look.near * LEAST
    lowest, least = lowest_swinging(above), min(above, default=look.near)
    if math.isinf(lowest):
        louder = max(above, default=look.near) * RUNG
        return louder if louder <= look.near * MOST else _filled(runs, base, math.inf)
    if not base and least * QUIET > lowest * ROUNDING and least / RUNG > floor:
        return least / RUNG
    if look.below and all(swing.counts for swing in runs.values()):
        return _widest_gap(runs)
    rough = _filled(runs, base, lowest) or _between(above, lowest, RUNG, COARSE) or _louder(above, lowest)
    return rough or _between(above, lowest, RUNG, FINE)


def base_of(runs: Runs, look: Outlook) -> float:
    """A gain that settles between the lower edge and the upper one; 0.0: no lower edge is known."""
    if not look.inside and not (look.below in runs and runs[look.below].counts):
        return 0.0
    above = 0.0 if look.inside else look.below
    low, high = max(_stretches(runs, above), key=lambda ends: ends[1] / ends[0], default=(0.0, 0.0))
    settling = [gain for gain in runs if low < gain < high]
    return min(settling, key=lambda gain: abs(math.log(gain * gain / (low * high))), default=0.0)


def _stretches(runs: Runs, above: float) -> Iterator[tuple[float, float]]:
    """Neighbouring gains that swing, with some between them that settle; the least and greatest run count as such."""
    ends = sorted({min(runs), max(runs), *(gain for gain, swing in runs.items() if swing.counts)})
    for low, high in pairwise(ends):
        first, last = low if runs[low].counts else low / ROUNDING, high if runs[high].counts else high * ROUNDING
        if any(max(first, above) < gain < last and not runs[gain].counts for gain in runs):
            yield first, last


def runs_above(runs: Runs, base: float, look: Outlook) -> Runs:
    """Those that count for the upper edge."""
    return {gain: swing for gain, swing in runs.items() if gain >= base and (base or gain > look.below)}


def _inside(runs: Runs, look: Outlook) -> float | None:
    """The next gain to find one that settles inside the band, from where one is expected outwards."""
    if not look.inside or any(not swing.counts for swing in runs.values()):
        return look.inside if look.inside and look.inside not in runs else None
    places = (look.inside * RUNG ** (0.5 * sign * k) for k in range(OUTWARDS + 1) for sign in (-1.0, 1.0))
    return next((gain for gain in places if gain not in runs), None)


def _first_below(runs: Runs, look: Outlook) -> float | None:
    """The first gain below the band, and where that settles but a lower edge is expected, the next."""
    if not look.below:
        return None
    if look.below not in runs:
        return look.below
    least = min(runs)
    expected = look.inside and not runs[least].counts and least / QUIET > look.near * LEAST
    return least / QUIET if expected else None


def _widest_gap(runs: Runs) -> float | None:
    """Its middle, where the band may be that was not met."""
    low, high = max(pairwise(sorted(runs)), key=lambda pair: pair[1] / pair[0], default=(1.0, 1.0))
    return math.sqrt(low * high) if high > low * QUIET else None


def _filled(runs: Runs, base: float, lowest: float) -> float | None:
    """The middle of the widest gap inside the band; one near an edge counts twice, so these are filled first."""
    if not (greatest := _greatest_below(runs, base)):
        return None

    def weight(gap: tuple[float, float]) -> float:
        low, high = gap
        return math.log(high / low) * (2.0 if high * QUIET > lowest or low < greatest * RUNG else 1.0)

    gaps = pairwise(sorted(gain for gain in runs if greatest <= gain <= lowest))
    widest = max(gaps, key=weight, default=(1.0, 1.0))
    return math.sqrt(math.prod(widest)) if weight(widest) > 2.0 * math.log(COARSE * ROUNDING) else None


def _greatest_below(runs: Runs, base: float) -> float:
    """The greatest gain below the band that swings; 0.0: none does."""
    return max((gain for gain, swing in runs.items() if gain < base and swing.counts), default=0.0)


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


def scanned(size: float, runs: Runs, look: Outlook) -> Scanned:
    """What the runs of a step of a size [m] say, and what a cheaper model gives for it, if there is one."""
    base = base_of(runs, look)
    above = runs_above(runs, base, look)
    low, high = _interval(above)
    if look.expected is not None and 0.0 < low < math.inf:
        low, high = _widened(low, high, above, look.expected)
    low, high = _with_marginal(low, high, above)
    swinging = [swing for gain, swing in sorted(above.items()) if swing.counts and gain <= high]
    often = [swing.frequency for swing in swinging if swing.frequency > 0.0] or [0.0]
    peaks = [swing.peak_to_peak for swing in swinging] or [0.0]
    spans = (min(often), max(often)), (min(peaks), max(peaks))
    settling = max((gain for gain, swing in above.items() if not swing.counts), default=0.0)
    tried = min(runs), max(runs)
    return Scanned(size, low, high, _beneath(runs, base), often[0], *spans, tuple(_islands(runs)), settling, tried)


def _with_marginal(low: float, high: float, runs: Runs) -> tuple[float, float]:
    """The interval with the gains around it whose swing is marginal, as far as it then spans no more than COVER."""
    marginal = [gain for gain, swing in runs.items() if swing.is_marginal]
    low = min([low, *(gain / FINE for gain in marginal if gain * COVER > high * FINE)])
    return low, max([high, *(gain for gain in marginal if gain <= low * COVER)])


def _beneath(runs: Runs, base: float) -> tuple[float, float]:
    """Where a search downwards from the band is expected to end, if possible within COVER; 0.0: nowhere."""
    if not (greatest := _greatest_below(runs, base)):
        return 0.0, 0.0
    settles = min(gain for gain in runs if gain > greatest)
    marginal = [gain for gain, swing in runs.items() if swing.is_marginal and greatest / COVER < gain <= base]
    louder = max(gain * HIGHER for gain in (greatest, *marginal))
    high = max(settles, min(louder, COVER * greatest / DEEPER))
    return min(greatest / DEEPER, max(high / COVER, min([greatest, *marginal]))), high


def _interval(runs: Runs) -> tuple[float, float]:
    """Where any search for the edge is expected to end.

    The loudest gain that settles bounds it, but it spans no more than COVER unless most of the gains settle there: then
    it begins less far below the lowest that swings.
    """
    lowest, scattered = lowest_swinging(runs), mostly_settling(runs)
    if math.isinf(lowest):
        return math.inf, math.inf
    top = lowest * (FURTHER if scattered else COVER) * ROUNDING
    settling = [gain for gain, swing in runs.items() if lowest < gain <= top and not swing.counts]
    if not settling:
        return _low(runs, lowest, SHARP), ABOVE * lowest
    high = max(BEYOND * max(settling), ABOVE * lowest)
    if scattered:
        return _low(runs, lowest, SCATTERED), high
    low = _low(runs, lowest, min(RAGGED, max(CLOSE, COVER * lowest / high)))
    return low, min(high, COVER * lowest / CLOSE)


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
    for island in _in_a_row(runs, swinging=True):
        yield island[0], island[-1]


def _in_a_row(runs: Runs, swinging: bool) -> list[list[float]]:
    """Gains with none between them that does the opposite."""
    rows = groupby(sorted(runs), key=lambda gain: runs[gain].counts)
    return [list(gains) for swings, gains in rows if swings == swinging]
