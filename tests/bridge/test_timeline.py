"""When messages of a replay are due: pure arithmetic, with a clock of the test's own."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge.replay.timeline import Timeline

MS = 1_000_000
TIMES = st.lists(st.integers(0, 50), min_size=1, max_size=60).map(lambda ticks: sorted(t * MS for t in ticks))


def play(line: Timeline, now: int, most: int = 10_000) -> list[tuple[int, int]]:
    """(wall time, message) of all that is due one after the other, a clock jumping from one to the next."""
    sent = []
    while (due := line.due(now)) is not None and len(sent) < most:
        now = max(now, due)
        sent += [(now, index) for index in line.take(now)]
    return sent


@given(TIMES, st.sampled_from([0.25, 1.0, 3.0]))
def test_each_message_goes_out_at_its_own_time_in_its_own_order(times, speed):
    sent = play(Timeline(times, 7, speed), 7)
    assert [index for _, index in sent] == list(range(len(times)))
    for wall, index in sent:
        assert 0 <= wall - 7 - (times[index] - times[0]) / speed <= 1


@given(TIMES, st.lists(st.tuples(st.integers(0, 20), st.sampled_from([0.5, 1.0, 2.0, math.inf])), max_size=6))
def test_changes_of_speed_neither_jump_nor_lose_a_message(times, changes):
    """The recorded time reached is the same just before and just after a change: it is anchored anew."""
    line, now, sent = Timeline(times, 0), 0, []
    for wait, speed in changes:
        now += wait * MS
        while (due := line.due(now)) is not None and due <= now and not math.isinf(line.speed):
            sent += line.take(now)
        before = line.time(now)
        line.set_speed(speed, now)
        assert line.time(now) == before
    sent += [index for _, index in play(line, now)]
    assert sent == list(range(len(times)))


def test_a_pause_shifts_what_follows_by_its_length():
    line = Timeline([0, 10 * MS, 20 * MS], 0)
    assert list(line.take(0)) == [0]
    line.pause(4 * MS)
    assert line.due(100 * MS) is None
    assert line.time(100 * MS) == 4 * MS
    line.resume(100 * MS)
    assert line.due(100 * MS) == 106 * MS


def test_a_step_is_all_of_one_instant_and_leaves_it_paused():
    line = Timeline([0, 0, 5, 5, 5, 9], 0)
    assert list(line.step(1)) == [0, 1]
    assert list(line.step(2)) == [2, 3, 4]
    assert line.paused
    assert line.time(99) == 5


def test_seeking_goes_to_the_first_message_from_there_on():
    line = Timeline([0, 10, 10, 20], 0)
    line.seek(10, 1000)
    assert line.index == 1
    assert line.due(1000) == 1000
    line.seek(11, 1000)
    assert line.due(1000) == 1009
    line.seek(-5, 1000)
    assert line.index == 0
    line.seek(10**12, 1000)
    assert line.time(1000) == 20


@given(TIMES, st.sampled_from([1.0, math.inf]))
def test_in_a_loop_time_goes_back_only_from_one_to_the_next(times, speed):
    line, now, seen = Timeline(times, 0, speed, loop=True), 0, []
    while line.loops < 3:
        now = max(now, line.due(now) or 0)
        before = line.loops
        seen += [(before, times[index]) for index in line.take(now)]
    for turn in range(3):
        assert [time for loop, time in seen if loop == turn] == times


def test_a_speed_must_be_above_zero():
    with pytest.raises(ValueError, match="greater than 0"):
        Timeline([0], 0).set_speed(0.0, 0)
