"""Which gains settle, where each run is one of the twin: a few gains with all steps at each, in a bounded time.

The gains form a ladder, by RUNG from the scenario's own. It goes down until IN_A_ROW of them settle, then up until some
swing: by two rungs while all settle, back to the one between where some do not. From the first rung that swings on each
step is scanned, and what swings below the band that settles. Then the ladder goes on until all swing by more than WIDE;
the gain from which any does is bisected. When the time is up, what is known then is the answer: with wider intervals,
and less of it.
"""

import math
import time
from collections.abc import Callable, Sequence

from bridge.scenario import Scenario
from bridge.studies.stability.amplitude import (
    ROUGHLY,
    PictureRow,
    SwingRange,
    is_one_sided,
    loop_of,
    outlook,
    picture_row,
    scans_of,
    swing,
)
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.search import LONGEST, WORK, Deadline, Search
from bridge.studies.stability.twin_loop import runs_alone, twin_loop
from controller.stability.amplitude.band import LEAST, Outlook, band_among
from controller.stability.amplitude.gain_scan import Scanned
from controller.stability.amplitude.swing import LARGEST, WIDE, Swing

IN_A_ROW = 2  # rungs that settle, on the way down
RUNG, TOLERANCE, MOST = 1.6, 1.06, 300.0  # from gain to gain, of what is bisected, and over the own gain
ROWS = 5  # of the picture


def search_of(scenario: Scenario, sizes: Sequence[float]) -> Search:
    """A search for steps up and down [m] whose time begins when all is compiled."""
    search = Search(twin_loop(scenario), sizes, Deadline())
    own = free_gain(scenario).own
    search.at(own, sizes[:1])
    if not runs_alone(scenario):
        swing(loop_of(scenario), own, sizes[0])
    search.until = Deadline(time.process_time() + WORK, time.monotonic() + LONGEST)
    return search


def scans(scenario: Scenario, search: Search) -> list[Scanned]:
    """The band of each step of a search, whoever says where to look."""
    own, one_sided = free_gain(scenario).own, is_one_sided(scenario)
    if not runs_alone(scenario):
        return scans_of(scenario, loop_of(scenario), search)
    return _scans(search, own, one_sided, _lowered(search, own, one_sided))


def twin_range(search: Search, own: float, one_sided: bool) -> SwingRange:
    """Which gains settle after the steps of a search; one_sided: a gain can only be too high."""
    below = _lowered(search, own, one_sided)
    steps = _scans(search, own, one_sided, below)
    _raise(search, own, below, lambda swings: all(swing.peak_to_peak > WIDE for swing in swings))
    least = max(step.beneath[1] for step in steps)
    low, high = min(step.low for step in steps), max(step.swings_from for step in steps)
    rungs = [gain for gain in search.rungs if gain >= least]
    wide = _bisected(search, rungs, WIDE) / ROUGHLY if math.isfinite(low) else math.inf
    rows = tuple(_rows(search, rungs, own)) if math.isfinite(low) else ()
    return SwingRange(least, low, high, wide, tuple(steps), rows)


def _scans(search: Search, own: float, one_sided: bool, below: bool) -> list[Scanned]:
    """The scan of each step, from the first rung up that any swings at."""
    _raise(search, own, below, lambda swings: any(swing.counts for swing in swings))
    return search.scans({size: _outlook(search, size, own, one_sided) for size in search.sizes})


def _outlook(search: Search, size: float, own: float, one_sided: bool) -> Outlook:
    """Where the scan of a step begins: the next rung above the band that swings, or the last one."""
    runs = {gain: not swing.counts for gain, swing in search.runs_of(size).items()}
    band = band_among(runs, own)
    louder = [gain for gain, settles in runs.items() if band and gain > band.top and not settles]
    return outlook(min(louder, default=max(runs) if band else own), band, one_sided, None)


def _lowered(search: Search, own: float, one_sided: bool) -> bool:
    """Run the rungs from the own one down, all steps at each, until IN_A_ROW settle; does the last still swing?"""
    gain, quiet = own, 0
    while quiet < IN_A_ROW and gain > LEAST * own and not search.late():
        quiet = 0 if search.any_beyond(gain, LARGEST) else quiet + 1
        gain /= RUNG
    return not (one_sided or quiet)


def _raise(search: Search, own: float, below: bool, enough: Callable[[Sequence[Swing]], bool]) -> None:
    """Run the rungs from the own one up until what they do is enough; past what swings below a band, if any does."""
    rung = 0
    while RUNG**rung < MOST and (below or not enough(search.at(own * RUNG**rung))):
        if search.late():
            return
        calm = not search.any_beyond(own * RUNG**rung, LARGEST)
        below = below and not calm
        if calm and search.any_beyond(own * RUNG ** (rung + 2), LARGEST):
            search.at(own * RUNG ** (rung + 1))
        rung += 2 if calm else 1


def _bisected(search: Search, rungs: Sequence[float], largest: float) -> float:
    """The smallest of these gains at which any step leaves a swing of more than this [m]; inf where none was found."""
    first = next((gain for gain in rungs if search.any_beyond(gain, largest)), math.inf)
    settles = max((gain for gain in rungs if gain < first), default=0.0)
    if math.isinf(first):
        return first
    while settles > 0.0 and first > settles * TOLERANCE and not search.late():
        middle = math.sqrt(settles * first)
        settles, first = (settles, middle) if search.any_beyond(middle, largest) else (middle, first)
    return first


def _rows(search: Search, rungs: Sequence[float], own: float) -> list[PictureRow]:
    """The own gain and those of these about the edges, as far as they were run."""
    loud = next((i for i, gain in enumerate(rungs) if search.any_beyond(gain, LARGEST)), len(rungs))
    near = [gain for gain in rungs[max(0, loud - 2) : loud - 2 + ROWS] if gain != own]
    shown = sorted({own, *near} & set(search.rungs))
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
