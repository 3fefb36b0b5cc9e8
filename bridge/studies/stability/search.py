"""Runs of the twin after several steps at several gains, kept, in a bounded time, and scans over the gain."""

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

from bridge.studies.stability.twin_loop import TwinLoop
from controller.stability.amplitude.band import Outlook
from controller.stability.amplitude.edges import SEEDS
from controller.stability.amplitude.gain_scan import COARSE, Scanned, next_gain, scanned
from controller.stability.amplitude.swing import Swing

WORK, LONGEST = 45.0, 90.0  # [s] of processor and of wall time for the search; what runs then comes to its end
OUT_OF_TIME = (
    f"the search ended for time, {WORK:g} s of the processor or {LONGEST:g} s in all: what it left out is not said, "
    "and intervals may be wider"
)
THREADS = 2


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

    def run(self, jobs: Iterable[tuple[float, float]]) -> None:
        """Gains and steps [m], as far as they have not been run."""
        missing = [job for job in dict.fromkeys(jobs) if job not in self.found]
        runs = threaded(lambda job: self._loop.swing(job[0], job[1], SEEDS[0]), missing)
        self.found |= dict(zip(missing, runs, strict=True))

    def at(self, gain: float, sizes: Sequence[float] | None = None) -> list[Swing]:
        """What the loop does at a gain, after all steps [m] or some."""
        asked = self.sizes if sizes is None else sizes
        self.run((gain, size) for size in asked)
        return [self.found[gain, size] for size in asked]

    def any_beyond(self, gain: float, largest: float) -> bool:
        """Does any step leave a swing of more than this [m]?"""
        return any(swing.peak_to_peak > largest for swing in self.at(gain))

    def lowest_beyond(self, largest: float, above: Mapping[float, float]) -> float:
        """The smallest gain that was seen to leave a swing of more than this [m], of each step above a gain; or inf."""
        found = self.found.items()
        beyond = (g for (g, size), swing in found if swing.peak_to_peak > largest and g > above[size])
        return min(beyond, default=math.inf)

    def runs_of(self, size: float) -> dict[float, Swing]:
        """By gain, of one step [m]."""
        return {gain: swing for (gain, of), swing in self.found.items() if of == size}

    def nearest(self, gain: float, size: float) -> Swing | None:
        """What a step [m] left at a gain that was run, no further than COARSE from this one."""
        near = min(self.runs_of(size), key=lambda other: abs(math.log(other / gain)), default=math.inf)
        return self.found[near, size] if abs(math.log(near / gain)) <= math.log(COARSE) else None

    @property
    def rungs(self) -> list[float]:
        """The gains that were run with all steps."""
        gains = {gain for gain, _ in self.found}
        return sorted(gain for gain in gains if all((gain, size) in self.found for size in self.sizes))

    def scans(self, looks: Mapping[float, Outlook]) -> list[Scanned]:
        """The scan of each step [m], beginning where its outlook says, or among the gains that were run."""
        self.run((looks[size].near, size) for size in self.sizes if not self.runs_of(size))
        while not self.late():
            wanted = {size: next_gain(self.runs_of(size), looks[size]) for size in self.sizes}
            if not (jobs := [(gain, size) for size, gain in wanted.items() if gain is not None]):
                break
            self.run(jobs)
        return [scanned(size, self.runs_of(size), looks[size]) for size in self.sizes]


def threaded(function: Callable[[Any], Any], jobs: Iterable[Any]) -> list[Any]:
    """All results in order; those not begun are dropped when one fails or the user interrupts."""
    pool = ThreadPoolExecutor(THREADS)
    try:
        return list(pool.map(function, jobs))
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
