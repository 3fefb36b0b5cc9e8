"""The search for the gains that settle by few runs of the twin: here of a loop whose edges are known."""

import math
from typing import Any

import pytest

from bridge.studies.stability.search import Deadline, Search
from bridge.studies.stability.twin_range import TOLERANCE, _descended, twin_range
from controller.stability.amplitude.gain_scan import ABOVE, COARSE, FINE, HIGHER, SHARP
from controller.stability.amplitude.swing import LARGEST, WIDE, Swing

SIZES = (2e-3, -2e-3, 20e-3, -20e-3, 60e-3, -60e-3)


class Known:
    """A loop that swings from an edge for each size on, by a width that grows with the gain."""

    def __init__(self, edges: dict[float, float], wide: float) -> None:
        self.edges, self.wide, self.runs = edges, wide, 0

    def swing(self, gain: float, size: float, _: int) -> Swing:
        self.runs += 1
        if gain < self.edges[size]:
            return Swing(0.0, 0.0)
        return Swing(1.2 * (WIDE if gain >= self.wide * self.edges[size] else LARGEST), 10.0)


def searched(loop: Known, until: Deadline) -> Search:
    kind: Any = loop
    return Search(kind, SIZES, until)


@pytest.mark.parametrize("own", [0.5, 15.0, 60.0])
@pytest.mark.parametrize("wide", [1.0, 1.8])
def test_edges_are_found_from_below_at_and_above_them(own, wide):
    """Each within what a scan leaves, the range over all, and the gain of wide swings; by at most 260 runs."""
    edges = {size: 17.0 + 3.0 * i for i, size in enumerate(SIZES)}
    loop = Known(edges, wide)
    found = twin_range(searched(loop, Deadline()), own, one_sided=True)
    for step in found.steps:
        assert step.low <= edges[step.size] <= step.high
        assert step.high <= step.low * SHARP * ABOVE * FINE
    assert found.low <= 17.0
    assert found.high >= 32.0
    assert found.wide * 1.15 == pytest.approx(wide * 17.0, rel=TOLERANCE - 1.0)
    assert own in [row.gain for row in found.rows]
    assert loop.runs <= 260


class WithLowerEdge(Known):
    """One that swings below a gain, too."""

    def swing(self, gain: float, size: float, _: int) -> Swing:
        return Swing(20.0 * WIDE, 0.0) if gain < 5.0 else super().swing(gain, size, _)


@pytest.mark.parametrize("own", [1.0, 8.0, 60.0])
def test_a_band_is_found_between_its_edges(own):
    """From below, inside and above it."""
    found = twin_range(searched(WithLowerEdge(dict.fromkeys(SIZES, 17.0), 1.8), Deadline()), own, one_sided=False)
    assert 5.0 <= found.least <= 5.0 * HIGHER * COARSE
    assert found.low <= 17.0 <= found.high
    assert found.wide * 1.15 == pytest.approx(1.8 * 17.0, rel=TOLERANCE - 1.0)
    assert all(step.beneath[0] <= 5.0 <= step.beneath[1] for step in found.steps)


def test_a_loop_that_never_swings_has_no_edges():
    found = twin_range(searched(Known(dict.fromkeys(SIZES, math.inf), 1.0), Deadline()), 1.0, one_sided=True)
    assert (found.low, found.high, found.wide) == (math.inf, math.inf, math.inf)


def test_a_search_without_time_says_so_and_answers_with_what_it_knows():
    """One rung down and one up, all steps at each."""
    search = searched(loop := Known(dict.fromkeys(SIZES, 5.0), 1.0), Deadline(wall=-1.0))
    found = twin_range(search, 1.0, one_sided=True)
    assert search.cut_short
    assert loop.runs <= 3 * len(SIZES)
    assert len(found.steps) == len(SIZES)


@pytest.mark.parametrize("edge", [0.05, 0.7, 2.0])
def test_the_gain_that_tolerates_a_delay_is_sought_downwards(edge):
    found = _descended(lambda gain: gain > edge, 1.0, lambda: False)
    assert found == pytest.approx(min(1.0, edge), rel=TOLERANCE - 1.0)
    assert found <= edge
    assert math.isnan(_descended(lambda gain: True, 1.0, lambda: True))
