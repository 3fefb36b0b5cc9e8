"""The grid of times, and the hold on it."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.grid import is_sample, last_due, next_sample, number_due, sampling
from controller.hold import Hold, Segment

MS = 1_000_000


def test_times_are_whole_nanoseconds_of_their_grids():
    grid = sampling(50e-6, 1e-3, 20e-3, 3e-3, 50e-3)
    assert grid == (50_000, MS, 20 * MS, 3 * MS, 50 * MS)
    assert grid.steps == 20


@pytest.mark.parametrize(
    ("arguments", "nearest"),
    [
        ((50e-6, 1e-3, 1.5e-3, 0.0, 0.0), "0.001 or 0.002"),
        ((50e-6, 1e-3, 1e-3, 0.4e-3, 0.0), "0 or 0.001"),
        ((50e-6, 1e-3, 1e-3, 0.0, 60e-6), "5e-05 or 0.0001"),
        ((50e-6, 0.99e-4, 1e-3, 0.0, 0.0), "5e-05 or 0.0001"),
        ((50e-6, 1e-3, 0.0, 0.0, 0.0), "0.001 or 0.002"),
    ],
)
def test_what_is_off_the_grid_is_refused_with_its_neighbours(arguments, nearest):
    with pytest.raises(ValueError, match="not a whole number") as error:
        sampling(*arguments)
    assert f"nearest: {nearest}" in str(error.value)


def test_samples_fall_at_offset_plus_whole_periods():
    grid = sampling(50e-6, 1e-3, 10e-3, 3e-3, 0.0)
    assert [k for k in range(40) if is_sample(k * MS, grid)] == [3, 13, 23, 33]


@given(st.integers(1, 50), st.integers(0, 20), st.integers(0, 4000), st.integers(0, 200_000))
def test_last_due_is_the_last_sample_that_acts_before(period, offset, delay, steps):
    """By definition: offset + i T + delay < t for the largest such i."""
    grid = sampling(50e-6, 1e-3, period * 1e-3, offset * 1e-3, delay * 50e-6)
    time = steps * 50_000
    acting = [s for s in range(grid.offset, time + 1, grid.sample) if s + grid.delay < time]
    assert last_due(time, grid) == (acting[-1] if acting else None)
    assert number_due(time, grid) == len(acting)
    first = next_sample(time, grid)
    assert is_sample(first, grid)
    assert not any(is_sample(t, grid) for t in range(-(-time // grid.daq) * grid.daq, first, grid.daq))


def test_a_value_is_held_until_the_next_acts():
    hold = Hold(0.0)
    hold.put(150, 1.0)
    hold.put(250, 2.0)
    assert list(hold.segments(0, 100)) == [Segment(0, 100, 0.0)]
    assert list(hold.segments(100, 300)) == [Segment(100, 150, 0.0), Segment(150, 250, 1.0), Segment(250, 300, 2.0)]
    assert list(hold.segments(300, 400)) == [Segment(300, 400, 2.0)]


def test_a_late_value_acts_from_the_first_instant_left():
    hold = Hold(0.0)
    hold.put(50, 1.0)
    assert list(hold.segments(100, 200)) == [Segment(100, 200, 1.0)]


def test_a_value_for_the_same_instant_replaces_and_later_ones_give_way():
    hold = Hold(0.0)
    hold.put(150, 1.0)
    hold.put(180, 3.0)
    hold.put(150, 2.0)
    assert list(hold.segments(100, 200)) == [Segment(100, 150, 0.0), Segment(150, 200, 2.0)]


@given(st.lists(st.tuples(st.integers(0, 1000), st.floats(-1, 1)), max_size=20), st.integers(1, 100))
def test_segments_tile_the_time_without_gaps(commands, block):
    hold = Hold(0.0)
    for at, value in sorted(commands, key=lambda command: command[0]):
        hold.put(at, value)
    segments = [s for begin in range(0, 1000, block) for s in hold.segments(begin, begin + block)]
    assert segments[0].begin == 0
    assert all(a.end == b.begin for a, b in pairwise(segments))
    assert all(s.begin < s.end for s in segments)
