"""Which gains settle, where each run is one of the twin: a few gains with all steps at each, in a bounded time.

The gains form a ladder, by RUNG from the scenario's own. It goes down until IN_A_ROW of them settle, then up: by two
rungs while all settle, back to the one between where some swing, on until all swing by more than WIDE. Between the
last rung that settles and the first that swings each step's edge is bisected; so is the gain from which any swings by
more than WIDE. When the time is up, what is known then is the answer: with wider intervals, and less of it.
"""

import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

from bridge.scenario import Scenario
from bridge.studies.stability.amplitude import (
    LEAST,
    ROUGHLY,
    PictureRow,
    SwingRange,
    picture_row,
    room_for,
    threaded,
)
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.twin_loop import TwinLoop, twin_loop
from controller.stability.amplitude.edges import SEEDS, Edge, spanned
from controller.stability.amplitude.swing import LARGEST, WIDE, Swing

IN_A_ROW = 2  # rungs that settle, on the way down
WORK, LONGEST = 45.0, 90.0  # [s] of processor and of wall time for the search; what runs then comes to its end
RUNG, TOLERANCE, MOST = 1.6, 1.06, 300.0  # from gain to gain, of an edge, and over the own gain
ROWS = 5  # of the picture
OUT_OF_TIME = (
    f"the search ended for time, {WORK:g} s of the processor or {LONGEST:g} s in all: what it left out is not said, "
    "and intervals may be wider than 6 %"
)


class Deadline(NamedTuple):
    """When a search is to end, by two clocks [s]."""

    work: float = math.inf  # time.process_time
    wall: float = math.inf  # time.monotonic

    def over(self) -> bool:
        """Is the time up?"""
        return time.process_time() > self.work or time.monotonic() > self.wall


class Search:
    """Runs of a loop that are kept, until the time is up."""

    def __init__(self, loop: TwinLoop, sizes: Sequence[float], until: Deadline) -> None:
        self._loop, self.sizes, self.until = loop, sizes, until
        self.found: dict[tuple[float, float], Swing] = {}
        self.cut_short = False

    def late(self) -> bool:
        """Is the time up? Then something is left out."""
        self.cut_short |= self.until.over()
        return self.cut_short

    def at(self, gain: float, sizes: Sequence[float] | None = None) -> list[Swing]:
        """What the loop does at a gain, after all steps [m] or some."""
        asked = self.sizes if sizes is None else sizes
        missing = [size for size in asked if (gain, size) not in self.found]
        runs = threaded(lambda size: self._loop.swing(gain, size, SEEDS[0]), missing)
        self.found |= {(gain, size): swing for size, swing in zip(missing, runs, strict=True)}
        return [self.found[gain, size] for size in asked]

    def any_beyond(self, gain: float, largest: float) -> bool:
        """Does any step leave a swing of more than this [m]?"""
        return any(swing.peak_to_peak > largest for swing in self.at(gain))

    @property
    def rungs(self) -> list[float]:
        """The gains that were run with all steps."""
        gains = {gain for gain, _ in self.found}
        return sorted(gain for gain in gains if all((gain, size) in self.found for size in self.sizes))


def search_of(scenario: Scenario, sizes: Sequence[float]) -> Search:
    """A search whose time begins when all is compiled. Raises ScenarioError where no step has room."""
    sizes = room_for(scenario, sizes)
    search = Search(twin_loop(scenario), sizes, Deadline())
    search.at(free_gain(scenario).own, sizes[:1])
    search.until = Deadline(time.process_time() + WORK, time.monotonic() + LONGEST)
    return search


def twin_range(search: Search, own: float) -> SwingRange:
    """Which gains settle after the steps of a search."""
    _ladder(search, own)
    by_size = {size: spanned(size, [_edge(search, size)]) for size in search.sizes}
    low, high = min(i.low for i in by_size.values()), max(i.high for i in by_size.values())
    wide = _bisected(search, WIDE) / ROUGHLY if math.isfinite(low) else math.inf
    return SwingRange(low, high, wide, tuple(by_size.values()), tuple(_rows(search, own)) if math.isfinite(low) else ())


def _ladder(search: Search, own: float) -> None:
    """Run the rungs that matter, all steps at each."""
    gain, quiet = own, 0
    while quiet < IN_A_ROW and gain > LEAST * own and not search.late():
        quiet = 0 if search.any_beyond(gain, LARGEST) else quiet + 1
        gain /= RUNG
    rung = 0
    while RUNG**rung < MOST and not all(s.peak_to_peak > WIDE for s in search.at(own * RUNG**rung)):
        if search.late():
            return
        calm = not search.any_beyond(own * RUNG**rung, LARGEST)
        if calm and search.any_beyond(own * RUNG ** (rung + 2), LARGEST):
            search.at(own * RUNG ** (rung + 1))
        rung += 2 if calm else 1


def _edge(search: Search, size: float) -> Edge:
    """The smallest gain that swings after a step, above which the ladder found none that settles below."""
    swings = {gain: search.found[gain, size] for gain in search.rungs}
    first = next((gain for gain, swing in swings.items() if swing.peak_to_peak > LARGEST), math.inf)
    settles = max((gain for gain in swings if gain < first), default=0.0)
    if math.isinf(first):
        return Edge(settles, math.inf, 0.0, 0.0)
    while settles > 0.0 and first > settles * TOLERANCE and not search.late():
        middle = math.sqrt(settles * first)
        (found,) = search.at(middle, [size])
        settles, first = (settles, middle) if found.peak_to_peak > LARGEST else (middle, first)
    at = search.found[first, size]
    return Edge(settles, first, at.frequency, at.peak_to_peak)


def _bisected(search: Search, largest: float) -> float:
    """The smallest gain at which any step leaves a swing of more than this [m]; inf where none was found."""
    rungs = search.rungs
    first = next((gain for gain in rungs if search.any_beyond(gain, largest)), math.inf)
    settles = max((gain for gain in rungs if gain < first), default=0.0)
    if math.isinf(first):
        return first
    while settles > 0.0 and first > settles * TOLERANCE and not search.late():
        middle = math.sqrt(settles * first)
        settles, first = (settles, middle) if search.any_beyond(middle, largest) else (middle, first)
    return first


def _rows(search: Search, own: float) -> list[PictureRow]:
    """The own gain and those about the edges, as far as they were run."""
    rungs = search.rungs
    loud = next((i for i, gain in enumerate(rungs) if search.any_beyond(gain, LARGEST)), len(rungs))
    near = [gain for gain in rungs[max(0, loud - 2) : loud - 2 + ROWS] if gain != own]
    shown = sorted({own, *near} & set(rungs))
    return [picture_row(gain, search.sizes, search.at(gain)) for gain in shown]


def twin_wide_later(scenario: Scenario, search: Search, wide: float) -> float:
    """At most `wide`: below which gain no step swings by more than WIDE with one more period of delay; NaN: no time."""
    if not math.isfinite(wide):
        return wide
    times = {"delay": scenario.loop.delay + scenario.loop.sample_period}
    later = scenario.model_copy(update={"loop": scenario.loop.model_copy(update=times)})
    delayed = Search(twin_loop(later), search.sizes, search.until)
    return _descended(lambda gain: delayed.any_beyond(gain, WIDE), wide, search.late)


def _descended(swings: Callable[[float], bool], first: float, late: Callable[[], bool]) -> float:
    """The largest gain up to `first` that does not swing, within TOLERANCE; NaN where the time did not reach."""
    high, low = first, first
    while not late():
        if not swings(low):
            break
        high, low = low, low / RUNG
        if low < LEAST * first:
            return low
    else:
        return math.nan
    while high > low * TOLERANCE and not late():
        middle = math.sqrt(low * high)
        low, high = (low, middle) if swings(middle) else (middle, high)
    return low
