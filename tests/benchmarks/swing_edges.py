"""The table of edges: what searches for the twin's edge find, beside the interval that `hydrotwin advise` gives.

    python -m tests.benchmarks.swing_edges edges.csv                  measure what is missing, then print shares
    python -m tests.benchmarks.swing_edges edges.csv --most 20        the first 20 cases of each law, both masses alike
    python -m tests.benchmarks.swing_edges edges.csv --seconds 500    stop after so long; the next call goes on
    python -m tests.benchmarks.swing_edges edges.csv --part 0/2       every other case, for two processes
    python -m tests.benchmarks.swing_edges edges.csv --shares         print the shares of what is there

Each row is one case: law, mass, sampling period, delay, step. Two searches look for its edge, each at gains of its own
and over the full length of a run: by 5 % upwards from below, as an edge is defined, and by doubling from far below. The
last pair of either is bisected to 2 %. Where small gains swing, too, they begin in the middle of the band, and a third
goes down from there by 5 %, to the lower edge. "In doubt" also counts the edges of a limit on the swing that is by
MARGIN lower and higher: as uncertain as the peak to peak of one run is. Cases come in a random but fixed order, so that
a table that is not finished is a fair sample. Two processes may append to the same file. Shares have Wilson's
intervals of 95 %.
"""

import argparse
import csv
import itertools
import math
import random
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import binomtest

from bridge.scenario import Scenario, load
from bridge.studies.stability.amplitude import is_one_sided, loop_of, scans_of
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.search import WORK, Deadline
from bridge.studies.stability.twin_edge import SCAN, twin_swing
from bridge.studies.stability.twin_range import search_of
from controller.stability.amplitude.band import LEAST
from controller.stability.amplitude.edges import smallest_swinging
from controller.stability.amplitude.gain_scan import RUNG, Scanned
from controller.stability.amplitude.swing import LARGEST, MARGIN, Swing

PERIODS = (1, 2, 5, 10, 20, 50, 100)  # [ms]
DELAYS = (0.0, 0.5, 1.0, 2.0, 4.0)  # [sampling periods]
MASSES = (120, 303)  # [kg]
STEPS = (2, -2, 20, -20, 60, -60)  # [mm]
LAWS: dict[str, tuple[str, ...]] = {
    "pd": (),
    "pd tachometer": ("controller.derivative=0.005",),
    "pd difference": ("controller.derivative=0.02", "controller.velocity=backward"),
    "pd filtered": ("controller.derivative=0.02", "controller.velocity=filtered"),
    "pid": ("controller.kind=pid", "controller.integral=0.05"),
    "python": ("controller.law=examples/my_law.py:law",),
    "dead band": ("controller.compensate_overlap=false",),
}
ALL = ("pd",)
EVERY = ("all",)
BELOW, FAR_BELOW = 0.5, 0.1  # of the interval's low end, where the searches begin, times up to DOUBLED by chance
DOUBLED = 2.0
ROUNDING = 1e-3  # of a width, of gains with five figures
BY_FIVE = SCAN._replace(down=16.0)
BY_DOUBLING = SCAN._replace(ratio=DOUBLED, down=16.0)


class Case(NamedTuple):
    """One row to fill."""

    law: str
    mass: float  # [kg]
    period: float  # [ms]
    delay: float  # [sampling periods]
    size: float  # [mm]


class Row(NamedTuple):
    """Gains in the unit of the law's free gain, lengths in mm."""

    case: Case
    settles: float  # the edge as it is defined
    swings: float  # inf: no gain swings
    frequency: float
    peak: float
    low: float  # 0.0: all gains swing
    high: float
    predicted: float  # [Hz]
    doubled_settles: float  # by doubling
    doubled_swings: float
    quiet_settles: float  # of a limit on the swing that is lower by MARGIN
    loud_swings: float  # of one that is higher
    least_swings: float  # the lower edge; 0.0: there is none
    least_settles: float
    least_low: float  # its interval
    least_high: float

    @property
    def inside(self) -> bool:
        """Is the edge in its interval, as far as both are known?"""
        return self.low <= self.swings and self.settles <= self.high

    @property
    def doubled_inside(self) -> bool:
        """The same of the search by doubling."""
        return self.low <= self.doubled_swings and self.doubled_settles <= self.high

    @property
    def in_doubt_inside(self) -> bool:
        """Is an edge of a limit within MARGIN in the interval?"""
        return self.low <= self.loud_swings and self.quiet_settles <= self.high

    @property
    def least_inside(self) -> bool:
        """Is the lower edge in its interval, or is there none as is said?"""
        return self.least_low <= self.least_settles and self.least_swings <= self.least_high

    @property
    def has_edge(self) -> bool:
        """Do some gains settle, and others swing?"""
        return self.settles > 0.0 and math.isfinite(self.swings)

    @property
    def width(self) -> float:
        """Of the interval, as a factor."""
        return self.high / self.low if self.low > 0.0 else math.inf

    @property
    def often(self) -> bool:
        """Is the frequency within 20 %?"""
        return abs(self.predicted - self.frequency) <= 0.2 * self.frequency


def cases(laws: tuple[str, ...]) -> list[Case]:
    """All of the table, in a fixed random order."""
    found = [Case(*numbers) for numbers in itertools.product(laws, MASSES, PERIODS, DELAYS, STEPS)]
    random.Random(1).shuffle(found)
    return found


def first_of_each(laws: tuple[str, ...], most: int) -> list[Case]:
    """So many cases of each law, half of them of each mass."""
    count: dict[tuple[str, float], int] = {}
    found = []
    for case in cases(laws):
        kind = (case.law, case.mass)
        count[kind] = count.get(kind, 0) + 1
        if 2 * count[kind] <= most:
            found.append(case)
    return found


def scenario_of(case: Case) -> Scenario:
    """The loop of a case."""
    delay = round(case.delay * case.period * 1e-3 / 50e-6) * 50e-6
    times = [f"loop.sample_period={case.period * 1e-3!r}", f"loop.delay={delay!r}"]
    timeout = f"loop.command_timeout={max(0.1, case.period * 1e-2)!r}"
    return load("step", [*times, timeout, f"rig.load.mass={case.mass}", *LAWS[case.law]])


def measured(case: Case) -> Row:
    """The interval, and the edges that searches find."""
    scenario = scenario_of(case)
    free, size, on = free_gain(scenario), case.size * 1e-3, stand_of(scenario)
    search = search_of(scenario, [size])
    search.until = Deadline(time.process_time() + WORK / len(STEPS))  # its share of the time that `advise` takes
    (expected,) = scans_of(scenario, loop_of(scenario), search)
    swing_at = cache(lambda gain: twin_swing(scenario, gain, size, on))
    first, far = begins(expected, random.Random(repr(case)))
    found, quiet, loud = (
        smallest_swinging(swing_at, first, BY_FIVE, limit) for limit in (LARGEST, LARGEST / MARGIN, LARGEST * MARGIN)
    )
    doubled = smallest_swinging(swing_at, far, BY_DOUBLING)
    least = (0.0, 0.0) if is_one_sided(scenario) else lower_edge(swing_at, expected, max(first, far), free.own)
    gains = (found.settles, found.swings, expected.low, expected.high, doubled.settles, doubled.swings)
    settles, swings, low, high, *others = (gain / free.per_unit for gain in gains)
    more = (gain / free.per_unit for gain in (quiet.settles, loud.swings, *least, *expected.beneath))
    about = found.frequency, found.peak_to_peak * 1e3, low, high, expected.frequency
    return Row(case, settles, swings, *about, *others, *more)


def begins(expected: Scanned, chance: random.Random) -> tuple[float, float]:
    """Where the two searches begin, inside the band."""
    about = expected.low if 0.0 < expected.low < math.inf else expected.tried[1]
    middle = math.sqrt(expected.beneath[1] * about)
    first, far = (max(middle, about * share * DOUBLED ** chance.random()) for share in (BELOW, FAR_BELOW))
    return first, far


def lower_edge(swing_at: Callable[[float], Swing], expected: Scanned, first: float, own: float) -> tuple[float, float]:
    """The greatest gain below a first one that swings, and the next that settles; coarsely where none is said to be."""
    ratio, furthest = BY_FIVE.ratio if expected.beneath[1] else RUNG, first / own / LEAST
    scan = BY_FIVE._replace(ratio=ratio, up=furthest)
    found = smallest_swinging(lambda over: swing_at(1.0 / over), 1.0 / first, scan)
    return 1.0 / found.swings, 1.0 / found.settles if found.settles else math.inf


def known(path: Path) -> list[Row]:
    """The rows that a file has."""
    if not path.exists():
        return []
    with path.open() as file:
        rows = [row for row in csv.reader(file) if row and row[0] != "law"]
    return [Row(Case(r[0], *map(float, r[1:5])), *map(float, r[5:])) for r in rows]


def fill(path: Path, wanted: list[Case], part: int, parts: int, seconds: float) -> None:
    """Measure what is missing, until the time is up."""
    begun, have = time.monotonic(), {row.case for row in known(path)}
    for number, case in enumerate(wanted):
        if number % parts != part or case in have:
            continue
        if time.monotonic() - begun > seconds:
            return
        row = measured(case)
        with path.open("a", newline="") as file:
            csv.writer(file).writerow([*case, *(f"{value:.5g}" for value in row[1:])])


HEADS = ("law", "mass", "edges", "inside", "in doubt", "by doubling", "lower edge inside", "width <= 2")
HEADS += ("width: 10, 50, 80, 90, 100 %", "frequency within 20 %", "no edge")


def shares(rows: list[Row]) -> None:
    """Print them, for each law and mass."""
    print(" | ".join(HEADS))
    for law, mass in itertools.product((*LAWS, *EVERY), (*MASSES, *EVERY)):
        of = [row for row in rows if law in (row.case.law, *EVERY) and mass in (row.case.mass, *EVERY)]
        if any(row.has_edge for row in of):
            print(" | ".join((law, f"{mass}", *_shares(of))))


def _shares(rows: list[Row]) -> tuple[str, ...]:
    of = [row for row in rows if row.has_edge]
    doubled, periodic = [row for row in of if row.doubled_settles > 0.0], [row for row in of if row.frequency > 0.0]
    lower = [row for row in of if row.least_swings > 0.0 or row.least_high > 0.0]
    width = np.array([row.width for row in of])
    return (
        f"{len(of)}",
        share([row.inside for row in of]),
        share([row.in_doubt_inside for row in of]),
        share([row.doubled_inside for row in doubled]),
        share([row.least_inside for row in lower]),
        share([row.width <= 2.0 + ROUNDING for row in of]),
        ", ".join(f"{w:.2f}" for w in np.percentile(width, (10, 50, 80, 90, 100), method="higher")),
        share([row.often for row in periodic]),
        f"{len(rows) - len(of)}",
    )


def share(what: list[bool]) -> str:
    """How many of them, and Wilson's interval."""
    if not what:
        return "-"
    within = binomtest(sum(what), len(what)).proportion_ci(method="wilson")
    return f"{sum(what)} of {len(what)} ({100.0 * within.low:.0f} to {100.0 * within.high:.0f} %)"


def main() -> None:
    """Fill the table and print what it says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", type=Path)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--most", type=int)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--law", action="append", choices=LAWS)
    parser.add_argument("--shares", action="store_true")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    if not asked.shares:
        laws = tuple(asked.law or ALL)
        wanted = cases(laws) if asked.most is None else first_of_each(laws, asked.most)
        fill(asked.csv, wanted, part, parts, asked.seconds)
    shares(known(asked.csv))


if __name__ == "__main__":
    main()
