"""Which gains settle, where each run is one of the twin: a few gains with all steps at each, in a bounded time.

The gains form a ladder, by RUNG from the scenario's own. It goes down until IN_A_ROW of them settle, then up: by two
rungs while all settle, back to the one between where some swing, on until all swing by more than WIDE. From the first
rung that swings on each step is scanned; the gain from which any swings by more than WIDE is bisected. When the time
is up, what is known then is the answer: with wider intervals, and less of it.
"""

import math
import time
from collections.abc import Callable, Sequence

from bridge.scenario import Scenario
from bridge.studies.stability.amplitude import (
    LEAST,
    ROUGHLY,
    PictureRow,
    SwingRange,
    picture_row,
)
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.search import LONGEST, WORK, Deadline, Search
from bridge.studies.stability.twin_loop import twin_loop
from controller.stability.amplitude.swing import LARGEST, WIDE

IN_A_ROW = 2  # rungs that settle, on the way down
RUNG, TOLERANCE, MOST = 1.6, 1.06, 300.0  # from gain to gain, of what is bisected, and over the own gain
ROWS = 5  # of the picture


def search_of(scenario: Scenario, sizes: Sequence[float]) -> Search:
    """A search for steps up and down [m] whose time begins when all is compiled."""
    search = Search(twin_loop(scenario), sizes, Deadline())
    search.at(free_gain(scenario).own, sizes[:1])
    search.until = Deadline(time.process_time() + WORK, time.monotonic() + LONGEST)
    return search


def twin_range(search: Search, own: float) -> SwingRange:
    """Which gains settle after the steps of a search."""
    _ladder(search, own)
    steps = search.scans(dict.fromkeys(search.sizes, own), {})
    low, high = min(step.low for step in steps), max(step.swings_from for step in steps)
    wide = _bisected(search, WIDE) / ROUGHLY if math.isfinite(low) else math.inf
    return SwingRange(low, high, wide, tuple(steps), tuple(_rows(search, own)) if math.isfinite(low) else ())


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
