"""The table of edges: the twin's edge of each step beside the interval that the theory gives for it.

    python -m tests.benchmarks.swing_edges edges.csv                  measure what is missing, then print shares
    python -m tests.benchmarks.swing_edges edges.csv --seconds 500    stop after so long; the next call goes on
    python -m tests.benchmarks.swing_edges edges.csv --part 0/2       every other case, for two processes
    python -m tests.benchmarks.swing_edges edges.csv --shares         print the shares of what is there

Each row is one case: law, mass, sampling period, delay, step. Cases come in a random but fixed order, so that a table
that is not finished is a fair sample. Two processes may append to the same file.
"""

import argparse
import csv
import itertools
import math
import random
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bridge.scenario import Scenario, load
from bridge.studies.stability.amplitude import loop_of
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.twin_edge import step_edge
from controller.stability.amplitude.edges import interval

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
TRAVEL = 0.055  # V/% s: about the velocity that a gain of 1 V/% gives, as a first guess of an edge
LAG = 0.012  # [s], of spool and load
SILENT = 0.06  # of that guess, where the search starts: louder gains may settle above quieter ones that swing
SLOWEST = 0.03  # V/%: with less a step of 60 mm is still on its way in the last third
BELOW = 0.7  # of the interval's low end, where the scan of the twin starts


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
    settles: float
    swings: float
    frequency: float
    peak: float
    low: float
    high: float
    predicted: float  # [Hz]

    @property
    def inside(self) -> bool:
        """Is the edge in its interval, as far as both are known?"""
        return self.low <= self.swings and self.settles <= self.high

    @property
    def width(self) -> float:
        """Of the interval, as a factor."""
        return self.high / self.low

    @property
    def often(self) -> bool:
        """Is the frequency within 20 %?"""
        return abs(self.predicted - self.frequency) <= 0.2 * self.frequency


def cases(laws: tuple[str, ...]) -> list[Case]:
    """All of the table, in a fixed random order."""
    found = [Case(*numbers) for numbers in itertools.product(laws, MASSES, PERIODS, DELAYS, STEPS)]
    random.Random(1).shuffle(found)
    return found


def scenario_of(case: Case) -> Scenario:
    """The loop of a case."""
    delay = round(case.delay * case.period * 1e-3 / 50e-6) * 50e-6
    times = [f"loop.sample_period={case.period * 1e-3!r}", f"loop.delay={delay!r}"]
    timeout = f"loop.command_timeout={max(0.1, case.period * 1e-2)!r}"
    return load("step", [*times, timeout, f"rig.load.mass={case.mass}", *LAWS[case.law]])


def measured(case: Case) -> Row:
    """The twin's edge and the theory's interval."""
    scenario = scenario_of(case)
    free, size = free_gain(scenario), case.size * 1e-3
    guess = TRAVEL / (0.5e-3 * case.period + 1e-3 * case.delay * case.period + LAG)
    first = max(SLOWEST, SILENT * guess)
    expected = interval(loop_of(scenario), size, first if free.is_factor else first * free.per_unit)
    found = step_edge(scenario, size, BELOW * expected.low)
    gains = (found.settles, found.swings, expected.low, expected.high)
    settles, swings, low, high = (gain / free.per_unit for gain in gains)
    return Row(case, settles, swings, found.frequency, found.peak_to_peak * 1e3, low, high, expected.frequency)


def known(path: Path) -> list[Row]:
    """The rows that a file has."""
    if not path.exists():
        return []
    with path.open() as file:
        rows = [row for row in csv.reader(file) if row and row[0] != "law"]
    return [Row(Case(r[0], *map(float, r[1:5])), *map(float, r[5:])) for r in rows]


def fill(path: Path, laws: tuple[str, ...], part: int, parts: int, seconds: float) -> None:
    """Measure what is missing, until the time is up."""
    begun, have = time.monotonic(), {row.case for row in known(path)}
    for number, case in enumerate(cases(laws)):
        if number % parts != part or case in have:
            continue
        if time.monotonic() - begun > seconds:
            return
        row = measured(case)
        with path.open("a", newline="") as file:
            csv.writer(file).writerow([*case, *(f"{value:.5g}" for value in row[1:])])


def shares(rows: list[Row]) -> None:
    """Print them, for each law."""
    print("law              edges  inside  width <= 2  width: 10 %, 50 %, 80 %, 90 %, 100 %   frequency within 20 %")
    for law in LAWS:
        of: list[Any] = [row for row in rows if row.case.law == law and math.isfinite(row.swings + row.high)]
        if not of:
            continue
        width = np.array([row.width for row in of])
        periodic = [row for row in of if row.frequency > 0.0]
        spread = ", ".join(f"{w:.2f}" for w in np.percentile(width, (10, 50, 80, 90, 100)))
        inside, often = np.mean([row.inside for row in of]), np.mean([row.often for row in periodic])
        print(
            f"{law:15}  {len(of):5}  {inside:6.3f}  {np.mean(width <= 2.0):10.3f}  {spread:37}"
            f"  {often:.3f} of {len(periodic)}"
        )


def main() -> None:
    """Fill the table and print what it says."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", type=Path)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--law", action="append", choices=LAWS)
    parser.add_argument("--shares", action="store_true")
    asked = parser.parse_args()
    part, parts = map(int, asked.part.split("/"))
    if not asked.shares:
        fill(asked.csv, tuple(asked.law or ALL), part, parts, asked.seconds)
    shares(known(asked.csv))


if __name__ == "__main__":
    main()
