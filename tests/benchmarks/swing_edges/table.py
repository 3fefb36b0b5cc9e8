"""The rows of the table: the interval of a case beside the edges of its map, and shares over many rows."""

import csv
import itertools
import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import binomtest

from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.search import WORK, Deadline
from bridge.studies.stability.twin_range import scans, search_of
from controller.stability.amplitude.swing import LARGEST, MARGIN
from tests.benchmarks.swing_edges.cases import LAWS, MASSES, STEPS, Case, scenario_of
from tests.benchmarks.swing_edges.gain_map import Edges, GainMap, edges_of

EVERY = ("all",)
ROUNDING = 1e-3  # of a width, of gains with five figures
HEADS = ("law", "mass", "edges", "inside", "in doubt", "on half of the map", "lower edge inside", "width <= 2")
HEADS += ("width: 10, 50, 80, 90, 100 %", "frequency within 20 %", "no edge")


class Expected(NamedTuple):
    """What `advise` says of a case, gains in the unit of the law's free gain."""

    low: float  # 0.0: all gains swing
    high: float  # inf: no gain swings
    least_low: float  # of the lower edge; 0.0: there is none
    least_high: float
    frequency: float  # [Hz]
    runs: int  # of the twin
    seconds: float  # of the processor

    @property
    def width(self) -> float:
        """Of the interval, as a factor."""
        return self.high / self.low if self.low > 0.0 else math.inf


class Row(NamedTuple):
    """One line of the table."""

    case: Case
    expected: Expected
    edges: Edges
    quiet: Edges  # of a limit on the swing that is lower by MARGIN
    loud: Edges  # of one that is higher
    halves: tuple[Edges, ...]  # of every other gain of the map

    @property
    def has_edge(self) -> bool:
        """Do some gains settle, and others swing?"""
        return self.edges.settles > 0.0 and math.isfinite(self.edges.swings)

    @property
    def has_lower(self) -> bool:
        """Is there a lower edge, or is one said to be?"""
        return self.edges.least_swings > 0.0 or self.expected.least_high > 0.0

    @property
    def inside(self) -> bool:
        """Is the edge in its interval?"""
        return within(self.expected, self.edges)

    @property
    def in_doubt_inside(self) -> bool:
        """Is an edge of a limit within MARGIN in the interval?"""
        return self.expected.low <= self.loud.swings and self.quiet.settles <= self.expected.high

    @property
    def least_inside(self) -> bool:
        """Is the lower edge in its interval, or is there none as is said?"""
        below = self.expected.least_low <= self.edges.least_settles or self.edges.least_swings == 0.0
        return below and self.edges.least_swings <= self.expected.least_high

    @property
    def often(self) -> bool:
        """Is the frequency within 20 %?"""
        return abs(self.expected.frequency - self.edges.frequency) <= 0.2 * self.edges.frequency


def within(expected: Expected, edges: Edges) -> bool:
    """Does an edge lie in an interval?"""
    return expected.low <= edges.swings and edges.settles <= expected.high


def row_of(case: Case, expected: Expected, found: GainMap) -> Row:
    """A line, of what was recorded."""
    gains = sorted(found.runs)
    halves = (found._replace(runs={gain: found.runs[gain] for gain in gains[k::2]}) for k in (0, 1))
    edges, quiet, loud = (edges_of(found, limit) for limit in (LARGEST, LARGEST / MARGIN, LARGEST * MARGIN))
    return Row(case, expected, edges, quiet, loud, tuple(edges_of(half) for half in halves))


def asked(case: Case) -> Expected:
    """Ask `advise` about one step, in its share of the time that all take."""
    scenario, begun = scenario_of(case), time.process_time()
    unit = free_gain(scenario).per_unit
    search = search_of(scenario, [case.size * 1e-3])
    search.until = Deadline(time.process_time() + WORK / len(STEPS))
    (found,) = scans(scenario, search)
    low, high, least_low, least_high = (gain / unit for gain in (found.low, found.high, *found.beneath))
    seconds = time.process_time() - begun
    return Expected(low, high, least_low, least_high, found.frequency, len(search.found), seconds)


def known(path: Path) -> dict[Case, Expected]:
    """What a file has."""
    if not path.exists():
        return {}
    with path.open() as file:
        rows = [row for row in csv.reader(file) if row]
    return {Case(row[0], *map(float, row[1:5])): _expected(row[5:]) for row in rows}


def _expected(words: Sequence[str]) -> Expected:
    low, high, least_low, least_high, frequency, runs, seconds = words
    numbers = float(low), float(high), float(least_low), float(least_high), float(frequency)
    return Expected(*numbers, int(runs), float(seconds))


def write(path: Path, case: Case, expected: Expected) -> None:
    """Append to a file."""
    numbers = (f"{value:.5g}" for value in expected[:5])
    with path.open("a", newline="") as file:
        csv.writer(file).writerow([*case, *numbers, expected.runs, f"{expected.seconds:.1f}"])


def joined(intervals: Mapping[Case, Expected], maps: Mapping[Case, GainMap]) -> list[Row]:
    """The lines of all cases that have both."""
    return [row_of(case, intervals[case], maps[case]) for case in maps if case in intervals]


def print_shares(rows: Sequence[Row]) -> None:
    """For each law and mass."""
    print(" | ".join(HEADS))
    for law, mass in itertools.product((*LAWS, *EVERY), (*MASSES, *EVERY)):
        of = [row for row in rows if law in (row.case.law, *EVERY) and mass in (row.case.mass, *EVERY)]
        if any(row.has_edge for row in of):
            print(" | ".join((law, f"{mass}", *_shares(of))))


def _shares(rows: Sequence[Row]) -> tuple[str, ...]:
    of = [row for row in rows if row.has_edge]
    width = np.array([row.expected.width for row in of])
    halves = [within(row.expected, edges) for row in of for edges in row.halves]
    return (
        f"{len(of)}",
        share([row.inside for row in of]),
        share([row.in_doubt_inside for row in of]),
        share(halves),
        share([row.least_inside for row in of if row.has_lower]),
        share([row.expected.width <= 2.0 + ROUNDING for row in of]),
        ", ".join(f"{w:.2f}" for w in np.percentile(width, (10, 50, 80, 90, 100), method="higher")),
        share([row.often for row in of if row.edges.frequency > 0.0]),
        f"{len(rows) - len(of)}",
    )


def share(what: Sequence[bool]) -> str:
    """How many of them, and Wilson's interval."""
    if not what:
        return "-"
    limits = binomtest(sum(what), len(what)).proportion_ci(method="wilson")
    return f"{sum(what)} of {len(what)} ({100.0 * limits.low:.0f} to {100.0 * limits.high:.0f} %)"


def print_rows(rows: Sequence[Row]) -> None:
    """Each case on a line."""
    for row in rows:
        edges, expected = row.edges, row.expected
        words = "" if row.inside or not row.has_edge else "MISSED"
        lower = "" if row.least_inside or not row.has_lower else "MISSED"
        swing = f"{edges.frequency:.3g} Hz, {edges.peak_to_peak * 1e3:.2g} mm"
        found = f"edge {edges.settles:.4g} to {edges.swings:.4g}, {swing}"
        said = f"interval {expected.low:.4g} to {expected.high:.4g}, {expected.frequency:.3g} Hz"
        least = f"lower edge {edges.least_swings:.4g} to {edges.least_settles:.4g}"
        about = f"interval {expected.least_low:.4g} to {expected.least_high:.4g}"
        print(*row.case, f"{found}; {said} {words}; {least}; {about} {lower}")
