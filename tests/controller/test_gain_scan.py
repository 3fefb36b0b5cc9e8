"""A scan over the gain: of loops whose islands of gains that swing are known."""

import math
from itertools import pairwise
from types import MappingProxyType

import pytest

from controller.stability.amplitude.band import APART, LEAST, MOST, Outlook, band_about
from controller.stability.amplitude.edges import SCAN, Interval, smallest_swinging
from controller.stability.amplitude.gain_scan import (
    ABOVE,
    COARSE,
    COVER,
    FINE,
    QUIET,
    RUNG,
    SHARP,
    Runs,
    next_gain,
    scanned,
)
from controller.stability.amplitude.swing import LARGEST, MARGIN, Swing

SIZE = 20e-3


def swing_of(gain: float, islands: tuple[tuple[float, float], ...]) -> Swing:
    """Of a loop that swings at the gains of some islands, at a frequency that says where."""
    swings = any(low <= gain <= high for low, high in islands)
    return Swing(2.0 * LARGEST, gain) if swings else Swing(0.5 * LARGEST, 0.0)


def scan_of(
    islands: tuple[tuple[float, float], ...], near: float, look: Outlook | None = None, had: Runs = MappingProxyType({})
) -> dict[float, Swing]:
    """All runs of a scan that begins at a gain, and those that there had been."""
    runs = dict(had)
    while (gain := next_gain(runs, look or Outlook(near))) is not None:
        assert gain not in runs
        runs[gain] = swing_of(gain, islands)
    return runs


@pytest.mark.parametrize("near", [0.1, 0.9, 1.0, 3.0, 9.0])
def test_a_sharp_edge_is_found_from_anywhere_in_few_runs(near):
    runs = scan_of(((1.0, math.inf),), near)
    found = scanned(SIZE, runs, Outlook(1.0))
    assert found.low <= 1.0 <= found.high
    assert found.high <= found.low * SHARP * ABOVE * FINE
    assert found.frequency == pytest.approx(1.0, rel=FINE - 1.0)
    assert len(runs) <= 32


ISLANDS = ((1.0, 1.15), (1.3, 1.45), (1.7, math.inf))


@pytest.mark.parametrize("start", [0.3, 0.37, 0.45, 0.52])
@pytest.mark.parametrize("ratio", [1.05, 1.25, 1.6, 2.0])
def test_a_search_from_anywhere_ends_in_the_interval(start, ratio):
    """One that is coarse steps over an island, and ends at the shore of another."""
    found = scanned(SIZE, scan_of(ISLANDS, 1.2), Outlook(1.0))
    edge = smallest_swinging(lambda gain: swing_of(gain, ISLANDS), start, SCAN._replace(ratio=ratio))
    assert found.low <= edge.swings
    assert edge.settles <= found.high
    assert found.high <= 2.0 * found.low
    assert len(found.islands) == 3


def test_gains_are_as_near_as_is_said():
    """Fine over a rung below the lowest that swings, a quiet one at another, coarse up to COVER times it."""
    gains = sorted(scan_of(((1.0, math.inf),), 0.9))
    lowest = next(gain for gain in gains if gain >= 1.0)
    for below, gain in pairwise(gains):
        if lowest / RUNG < below * 0.999 and gain <= lowest:
            assert gain <= below * FINE * 1.001
        elif lowest <= below and gain <= COVER * lowest:
            assert gain <= below * COARSE * 1.001
    assert gains[0] * QUIET <= lowest * 1.001
    assert gains[-1] >= COVER * lowest * 0.999


def test_where_most_gains_settle_above_the_edge_the_interval_goes_on():
    islands = ((1.0, 1.05), (1.4, 1.43), (2.6, math.inf))
    found = scanned(SIZE, scan_of(islands, 1.0), Outlook(1.0))
    assert found.low < 1.0
    assert found.high >= 2.4


def test_a_loop_that_swings_at_no_gain_has_no_edge():
    runs = scan_of((), 1.0)
    found = scanned(SIZE, runs, Outlook(1.0))
    assert (found.low, found.high, found.islands) == (math.inf, math.inf, ())
    assert MOST / RUNG <= found.tried[1] <= MOST


def test_a_loop_that_swings_at_all_gains_settles_at_none():
    runs = scan_of(((0.0, math.inf),), 1.0)
    found = scanned(SIZE, runs, Outlook(1.0))
    assert found.low == 0.0
    assert found.high <= 2.0 * LEAST
    assert found.islands == ((min(runs), max(runs)),)


def test_a_scan_that_is_cut_short_has_an_interval_as_wide_as_its_gap():
    runs = {gain: swing_of(gain, ISLANDS) for gain in (0.5, 1.1)}
    found = scanned(SIZE, runs, Outlook(1.0))
    assert found.low == 0.5
    assert found.high >= 1.1


def expecting(low: float, high: float) -> Interval:
    """What a cheaper model gives."""
    return Interval(SIZE, low, high, 1.0, (1.0, 1.0), (LARGEST, LARGEST))


def test_the_interval_holds_what_a_cheaper_model_expects_within_twice_its_low_end():
    runs = scan_of(((1.0, math.inf),), 1.0)
    found = [
        scanned(SIZE, runs, Outlook(1.0, expected=expecting(*pair)))
        for pair in ((0.7, 1.3), (0.7, 3.0), (1.2, 1.25), (0.3, math.inf))
    ]
    assert [(step.low, step.high) for step in found[:2]] == [(0.7, 1.3), (0.7, pytest.approx(1.4))]
    assert found[2].low == scanned(SIZE, runs, Outlook(1.0)).low
    assert found[2].high >= 1.25
    assert found[3].low >= 0.5
    assert found[3].high == pytest.approx(2.0 * found[3].low)
    assert all(step.low <= 1.0 <= step.high for step in found)


LOWER = 0.3  # small gains swing up to here
BAND = ((0.0, LOWER), (1.0, 1.15), (1.3, math.inf))


@pytest.mark.parametrize("own", [0.02, 0.1, 0.35, 0.6, 1.05, 5.0, 30.0])
def test_the_band_that_settles_is_found_from_anywhere(own):
    """Of a loop that swings below and above it, by few runs, which may step over the island at its upper edge."""
    runs = 0

    def settles(gain: float) -> bool:
        nonlocal runs
        runs += 1
        return not swing_of(gain, BAND).counts

    found = band_about(settles, own, one_sided=False)
    assert found is not None
    assert LOWER < found.bottom <= LOWER * APART**2
    assert found.bottom < found.inside < 1.0
    assert 0.0 < found.swings_below <= LOWER
    assert runs <= 20


def test_a_loop_that_only_louder_gains_make_swing_has_a_band_down_to_any_gain():
    found = [band_about(lambda gain: gain < 1.0, 3.0, one) for one in (True, False)]
    assert all(band is not None and band.swings_below == 0.0 and band.top < 1.0 for band in found)
    assert band_about(lambda gain: False, 3.0, one_sided=False) is None


@pytest.mark.parametrize(
    "look",
    [
        Outlook(1.0, inside=0.55, below=0.2),  # as a cheaper model says
        Outlook(1.4, inside=0.25, below=0.2),  # it expects the band where gains swing
        Outlook(1.0, inside=0.55, below=0.4),  # and its lower edge too high
        Outlook(1.0, below=0.01),  # or knows of none
        Outlook(0.02, below=2e-4),  # nor of a band; then the own gain, that was run, is above it
    ],
)
def test_both_edges_of_a_band_are_found_whatever_a_cheaper_model_expects(look):
    """Every search from the middle of the band ends in the interval, upwards and downwards."""
    runs = scan_of(BAND, 1.0, look, {5.0: swing_of(5.0, BAND)})
    found = scanned(SIZE, runs, look)
    assert found.beneath[0] <= LOWER <= found.beneath[1]
    assert found.beneath[1] <= found.beneath[0] * 1.6
    assert found.low <= 1.0
    assert 1.3 <= found.high <= 2.0 * found.low
    assert found.islands[0][1] <= LOWER
    assert found.tried == (min(runs), max(runs))
    assert len(runs) <= 50


def test_gains_whose_swing_is_marginal_lie_in_the_interval_as_far_as_it_is_narrow():
    """Here one that settles by little below the edge; and one too far below to count."""
    runs = scan_of(((1.0, math.inf),), 1.0)
    sharp = scanned(SIZE, runs, Outlook(1.0))
    below, far = (max(gain for gain in runs if gain < limit) for limit in (0.9, 0.5))
    almost = Swing(1.01 * LARGEST / MARGIN, 0.0)
    found = scanned(SIZE, runs | {below: almost, far: almost}, Outlook(1.0))
    assert far < found.low < below < sharp.low
    assert found.high == sharp.high
