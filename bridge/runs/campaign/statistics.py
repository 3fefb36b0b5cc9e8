"""What some runs say of all that could be: intervals about the share that passes, and about quantiles of a metric.

Share: Wilson's interval (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927), which keeps within 0..1 and holds for few runs
and for shares near the ends. Quantile: the estimate is the linear one between order statistics (Hyndman and Fan 1996,
type 7); its interval lies between two order statistics x_(l), x_(u), of ranks such that the number of values below the
quantile, which is binomial, is beyond either with at most half of 1 - CONFIDENCE (Hahn and Meeker, Statistical
Intervals, 1991, 5.2). It holds for any distribution; where there are too few runs, an end is missing.
"""

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import NamedTuple

CONFIDENCE = 0.95
QUANTILES = (0.05, 0.5, 0.95)


class Share(NamedTuple):
    """How many of some runs passed."""

    passed: int
    runs: int
    low: float  # of the share of all
    high: float

    @property
    def share(self) -> float:
        """Of these runs."""
        return self.passed / self.runs

    @property
    def words(self) -> str:
        """For people."""
        return f"{self.share:.1%} ({self.low:.1%} to {self.high:.1%})"


class Quantile(NamedTuple):
    """A quantile of a metric."""

    share: float  # of the runs that lie below it
    value: float
    low: float | None  # None: too few runs for this end
    high: float | None


def wilson(passed: int, runs: int, confidence: float = CONFIDENCE) -> Share:
    """The share that passed, with Wilson's interval. runs >= 1."""
    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    share, within = passed / runs, z * z / runs
    centre = (share + 0.5 * within) / (1.0 + within)
    half = z * math.sqrt(share * (1.0 - share) / runs + 0.25 * within / runs) / (1.0 + within)
    low = 0.0 if passed == 0 else max(0.0, centre - half)
    high = 1.0 if passed == runs else min(1.0, centre + half)
    return Share(passed, runs, low, high)


def quantile(values: Sequence[float], share: float, confidence: float = CONFIDENCE) -> Quantile:
    """A quantile of at least one value, with its interval."""
    ordered = sorted(values)
    at = share * (len(ordered) - 1)
    below = math.floor(at)
    above = min(below + 1, len(ordered) - 1)
    value = ordered[below] + (at - below) * (ordered[above] - ordered[below])
    low, high = ranks(len(ordered), share, confidence)
    return Quantile(
        share, value, None if low is None else ordered[low - 1], None if high is None else ordered[high - 1]
    )


def ranks(count: int, share: float, confidence: float = CONFIDENCE) -> tuple[int | None, int | None]:
    """The ranks, from 1, of the order statistics that enclose a quantile; None where there are too few."""
    tail = 0.5 * (1.0 - confidence)
    below = _below(count, share)  # P(at most k values lie below the quantile), k = 0 .. count
    low = next((k + 1 for k in reversed(range(count)) if below[k] <= tail), None)
    high = next((k for k in range(1, count + 1) if below[k - 1] >= 1.0 - tail), None)
    return low, high


def _below(count: int, share: float) -> list[float]:
    """The distribution function of a binomial number."""
    logs = math.log(share), math.log1p(-share)
    total, found = 0.0, []
    for k in range(count + 1):
        ways = math.lgamma(count + 1) - math.lgamma(k + 1) - math.lgamma(count - k + 1)
        total += math.exp(ways + k * logs[0] + (count - k) * logs[1])
        found.append(min(total, 1.0))
    return found
