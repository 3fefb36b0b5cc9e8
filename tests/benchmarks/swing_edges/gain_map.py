"""A recorded map of the twin over the gain: which gains swing after a step, known before anything is said of edges.

The gains are a grid by RATIO from gain to gain, whose place is chance of the case. Runs begin COARSE rungs apart, from
the loudest gain downwards: to the least where small gains may swing, too, else until QUIET of them settle in a row.
Then the grid is filled where edges are: over the widest stretch that settles, or DOWN below the lowest that swings
where there is no lower edge, and MARGIN beyond. What swings there moves the edges, and they are filled anew.
"""

import json
import math
import random
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from bridge.studies.stability.amplitude import is_one_sided
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import free_gain
from bridge.studies.stability.twin_edge import twin_swing
from controller.stability.amplitude.swing import LARGEST, Swing
from tests.benchmarks.swing_edges.cases import Case, scenario_of

RATIO = 1.05  # from gain to gain, as an edge is defined
LEAST, LEAST_ONE_SIDED, MOST = 1e-2, 2e-5, 6.0  # of the grid, in the unit of the free gain
COARSE, QUIET = 8, 5
DOWN = 28  # gains below the lowest that swings: a factor of 4
MARGIN = 8
Swinging = Callable[[int], bool]


class GainMap(NamedTuple):
    """Runs of one case, by gain in the unit of its law, in rising order."""

    one_sided: bool  # small gains do not swing
    runs: dict[float, Swing]


class Edges(NamedTuple):
    """The ends of the band that settles."""

    least_swings: float  # the next gain below the band; 0.0: none swings
    least_settles: float
    settles: float
    swings: float  # the next above; inf: none swings
    frequency: float  # [Hz], of the quietest swing from there on that has one, up to twice the gain; 0.0: none has
    peak_to_peak: float  # [m], there


def edges_of(found: GainMap, largest: float = LARGEST) -> Edges:
    """The edges of a map; largest: peak to peak [m] up to which a run counts as settled."""
    gains = sorted(found.runs)
    low, high = band([found.runs[gain].peak_to_peak > largest for gain in gains], found.one_sided)
    below = gains[low - 1] if low > 0 and not found.one_sided else 0.0
    if high == len(gains) - 1:
        return Edges(below, gains[low], gains[high], math.inf, 0.0, 0.0)
    if high < low:
        return Edges(0.0, 0.0, 0.0, gains[low], *_swing(found, gains[low]))
    return Edges(below, gains[low], gains[high], gains[high + 1], *_swing(found, gains[high + 1]))


def _swing(found: GainMap, edge: float) -> tuple[float, float]:
    """Frequency [Hz] of the quietest swing that has one, up to twice an edge, and peak to peak [m] at the edge."""
    louder = (found.runs[gain] for gain in sorted(found.runs) if edge <= gain <= 2.0 * edge)
    often = (swing.frequency for swing in louder if swing.counts and swing.frequency > 0.0)
    return next(often, 0.0), found.runs[edge].peak_to_peak


def band(swings: list[bool], one_sided: bool) -> tuple[int, int]:
    """First and last place of the lowest stretch that settles, or of the longest; (0, -1): none does."""
    stretches: list[tuple[int, int]] = []
    for place, swinging in enumerate(swings):
        if swinging:
            continue
        if stretches and stretches[-1][1] == place - 1:
            stretches[-1] = stretches[-1][0], place
        else:
            stretches.append((place, place))
    if one_sided:
        return stretches[0] if stretches and stretches[0][0] == 0 else (0, -1)
    return max(stretches, key=lambda s: s[1] - s[0], default=(0, -1))


def record(case: Case, ratio: float = RATIO) -> GainMap:
    """Run the twin over the gains of a case."""
    scenario, size = scenario_of(case), case.size * 1e-3
    free, on, one_sided = free_gain(scenario), stand_of(scenario), is_one_sided(scenario)
    phase, rung = random.Random(repr(case)).random(), math.log(ratio)
    least = LEAST_ONE_SIDED if one_sided else LEAST
    last, stride = math.floor(math.log(MOST / least) / rung), round(COARSE * math.log(RATIO) / rung)
    gains = [least * ratio ** (k + phase) for k in range(last)]
    runs: dict[int, Swing] = {}

    def swings(k: int) -> bool:
        if k not in runs:
            runs[k] = twin_swing(scenario, gains[k] * free.per_unit, size, on)
        return runs[k].counts

    about = _descended(swings, last, stride, one_sided)
    fill(swings, about, last, one_sided, stride)
    return GainMap(one_sided, {gains[k]: runs[k] for k in sorted(runs)})


def _descended(swings: Swinging, last: int, stride: int, one_sided: bool) -> list[int]:
    """The places of the coarse runs, in rising order."""
    places, quiet = [], 0
    for k in range(last - 1, -1, -stride):
        places.append(k)
        quiet = 0 if swings(k) else quiet + 1
        if one_sided and quiet == QUIET:
            break
    return places[::-1]


def fill(swings: Swinging, known: Iterable[int], last: int, one_sided: bool, stride: int = COARSE) -> None:
    """Run what lies about the edges, until they stay where they are."""
    places = sorted(known)
    scale, before = stride // COARSE, None
    while True:
        first, end = band([swings(k) for k in places], one_sided)
        if one_sided:
            lowest = next((k for k in places if swings(k)), last)
            low, high = lowest - DOWN * scale, lowest + MARGIN * scale
        elif end < first:
            return
        else:
            low, high = places[first] - MARGIN * scale, places[end] + MARGIN * scale
        wanted = range(max(0, low), min(last, high + 1))
        if before == wanted:
            return
        before, places = wanted, sorted({*places, *wanted})


def write(path: Path, case: Case, found: GainMap) -> None:
    """Append a map to a file, one line for each case."""
    runs = [[round(gain, 8), swing.peak_to_peak, swing.frequency] for gain, swing in found.runs.items()]
    with path.open("a") as file:
        file.write(json.dumps({"case": case, "one_sided": found.one_sided, "runs": runs}) + "\n")


def read(path: Path) -> Mapping[Case, GainMap]:
    """The maps of a file."""
    if not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return {
        Case(*row["case"]): GainMap(row["one_sided"], {gain: Swing(peak, often) for gain, peak, often in row["runs"]})
        for row in rows
    }
