"""The band of gains that settle about a loop's own gain, and where to look for its edges: by few, coarse runs.

Above a band louder loops swing. Below it there is a second edge where a law does more than answer the error: with a
fixed integral a small proportional gain swings slowly, and widely. So the band is sought from the own gain outwards,
first downwards, by APART from gain to gain, until ENOUGH in a row settle.
"""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import NamedTuple

from controller.stability.amplitude.edges import Interval

APART, ENOUGH = 1.6, 3
LEAST, MOST = 1e-2, 64.0  # of the own gain, how far is searched
Settles = Callable[[float], bool]  # does a gain?


class Band(NamedTuple):
    """Gains that were seen to settle, one next to the other."""

    bottom: float
    top: float
    swings_below: float  # the next gain that swings below it; 0.0: none was seen

    @property
    def inside(self) -> float:
        """The gain from which edges are sought."""
        return math.sqrt(self.bottom * self.top) if self.swings_below else self.bottom


class Outlook(NamedTuple):
    """Where the scan of a step begins."""

    near: float  # where the upper edge is expected
    inside: float = 0.0  # a gain above a lower edge that is expected; 0.0: none is
    below: float = 0.0  # where gains that swing below the band are sought first; 0.0: there are none
    expected: Interval | None = None  # the upper edge by a cheaper model


def band_about(settles: Settles, own: float, one_sided: bool) -> Band | None:
    """The band about a gain, or the one next to it; one_sided: small gains never swing. None: no gain settles."""
    runs = {own: settles(own)}
    for ratio in (1.0 / APART,) if one_sided else (1.0 / APART, APART):
        if _walked(settles, runs, own, ratio):
            break
    if not one_sided and runs[min(runs)]:
        _descended(settles, runs)
    return band_among(runs, own)


def _walked(settles: Settles, runs: dict[float, bool], own: float, ratio: float) -> bool:
    """Run gains from the own one on, until ENOUGH in a row settle: did they?"""
    gain, quiet = own, 0
    while LEAST * own <= gain <= MOST * own:
        if gain not in runs:
            runs[gain] = settles(gain)
        quiet = quiet + 1 if runs[gain] else 0
        if quiet == ENOUGH:
            return True
        gain *= ratio
    return False


def _descended(settles: Settles, runs: dict[float, bool]) -> None:
    """Run gains below those that settle, further apart, until one swings."""
    bottom = min(runs)
    gain = bottom / APART**2
    while gain >= LEAST * bottom and runs[min(runs)]:
        runs[gain] = settles(gain)
        gain /= APART**2


def band_among(runs: Mapping[float, bool], own: float) -> Band | None:
    """The widest stretch of gains that settle, up to ENOUGH of them, of these the nearest; None where none does."""
    bands: list[tuple[int, float, Band]] = []
    stretch: list[float] = []
    before = 0.0
    for gain, after in pairwise([*sorted(runs), math.inf]):
        if runs[gain]:
            stretch.append(gain)
        else:
            before, stretch = gain, []
        if stretch and not runs.get(after, False):
            away = max(0.0, math.log(stretch[0] / own), math.log(own / stretch[-1]))
            bands.append((-min(len(stretch), ENOUGH), away, Band(stretch[0], stretch[-1], before)))
    return min(bands)[2] if bands else None
