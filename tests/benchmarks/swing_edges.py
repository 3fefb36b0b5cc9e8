"""The table of edges: what searches for the twin's edge find, beside the interval that `hydrotwin advise` gives.

    python -m tests.benchmarks.swing_edges edges.csv                  measure what is missing, then print shares
    python -m tests.benchmarks.swing_edges edges.csv --most 20        the first 20 cases of each law, both masses alike
    python -m tests.benchmarks.swing_edges edges.csv --seconds 500    stop after so long; the next call goes on
    python -m tests.benchmarks.swing_edges edges.csv --part 0/2       every other case, for two processes
    python -m tests.benchmarks.swing_edges edges.csv --shares         print the shares of what is there

Each row is one case: law, mass, sampling period, delay, step. Two searches look for its edge, each at gains of its own
and over the full length of a run: by 5 % upwards from below, as an edge is defined, and by doubling from far below. The
last pair of either is bisected to 2 %. Cases come in a random but fixed order, so that a table that is not finished is
a fair sample. Two processes may append to the same file.
"""

import argparse
import csv
import itertools
import math
import random
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bridge.scenario import Scenario, load
from bridge.studies.stability.amplitude import loop_of, scans_of
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.search import WORK, Deadline
from bridge.studies.stability.twin_edge import SCAN, step_edge
from bridge.studies.stability.twin_range import search_of

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

    @property
    def inside(self) -> bool:
        """Is the edge in its interval, as far as both are known?"""
        return self.low <= self.swings and self.settles <= self.high

    @property
    def doubled_inside(self) -> bool:
        """The same of the search by doubling."""
        return self.low <= self.doubled_swings and self.doubled_settles <= self.high

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
    """The interval, and the edges that two searches find."""
    scenario = scenario_of(case)
    free, size, chance = free_gain(scenario), case.size * 1e-3, random.Random(repr(case))
    search = search_of(scenario, [size])
    search.until = Deadline(time.process_time() + WORK / len(STEPS))  # its share of the time that `advise` takes
    (expected,) = scans_of(loop_of(scenario), search, free.own)
    about = expected.low if 0.0 < expected.low < math.inf else expected.loudest
    begin = [about * share * DOUBLED ** chance.random() for share in (BELOW, FAR_BELOW)]
    found = step_edge(scenario, size, begin[0], BY_FIVE)
    doubled = step_edge(scenario, size, begin[1], BY_DOUBLING)
    gains = (found.settles, found.swings, expected.low, expected.high, doubled.settles, doubled.swings)
    settles, swings, low, high, *others = (gain / free.per_unit for gain in gains)
    return Row(case, settles, swings, found.frequency, found.peak_to_peak * 1e3, low, high, expected.frequency, *others)


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


def shares(rows: list[Row]) -> None:
    """Print them, for each law and mass."""
    print(
        "law              mass  edges  inside  by doubling  width <= 2  width: 10 %, 50 %, 80 %, 90 %, 100 %   "
        "frequency within 20 %  no edge"
    )
    for law, mass in itertools.product((*LAWS, *EVERY), (*MASSES, *EVERY)):
        of = [row for row in rows if law in (row.case.law, *EVERY) and mass in (row.case.mass, *EVERY)]
        if any(row.has_edge for row in of):
            print(f"{law:15}  {mass:>4}  {_shares(of)}")


def _shares(rows: list[Row]) -> str:
    of = [row for row in rows if row.has_edge]
    doubled, periodic = [row for row in of if row.doubled_settles > 0.0], [row for row in of if row.frequency > 0.0]
    width = np.array([row.width for row in of])
    spread = ", ".join(f"{w:.2f}" for w in np.percentile(width, (10, 50, 80, 90, 100)))
    inside, again = np.mean([row.inside for row in of]), np.mean([row.doubled_inside for row in doubled])
    often = f"{np.mean([row.often for row in periodic]):.3f}" if periodic else "-"
    return (
        f"{len(of):5}  {inside:6.3f}  {again:11.3f}  {np.mean(width <= 2.0):10.3f}  {spread:37}  "
        f"{often} of {len(periodic):<14} {len(rows) - len(of)}"
    )


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
