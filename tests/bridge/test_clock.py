"""Pacing with a fake clock: nobody waits."""

from itertools import islice

from bridge.machine.clock import Overruns, ticks


class FakeClock:
    """Time that passes only when somebody sleeps, looks, or works."""

    def __init__(self, look: int = 100):
        self.time, self.look = 1_000, look

    def now(self) -> int:
        self.time += self.look
        return self.time

    def sleep(self, seconds: float) -> None:
        self.time += round(seconds * 1e9)


def test_deadlines_are_multiples_of_the_period_and_delays_do_not_add_up():
    clock = FakeClock()
    pace = ticks(1_000_000.0, clock.now, clock.sleep)
    first = next(pace)
    clock.time += 400_000
    rest = list(islice(pace, 999))
    assert [tick.due - first.due for tick in rest] == [k * 1_000_000 for k in range(1, 1000)]
    assert all(0 <= tick.lateness <= 200 for tick in rest)


def test_scaled_periods_round_each_deadline_not_the_period():
    clock = FakeClock()
    tick = list(islice(ticks(1_000_000 / 3.0, clock.now, clock.sleep), 3000))[-1]
    assert abs(tick.due - 1_100 - 1_000_000_000) <= 1


def test_missed_ticks_come_back_to_back_with_their_own_lateness():
    clock = FakeClock(look=1)
    pace = ticks(1_000_000.0, clock.now, clock.sleep)
    next(pace)
    clock.time += 4_500_000
    late = [next(pace).lateness for _ in range(5)]
    assert [round(value / 1e6, 1) for value in late] == [3.5, 2.5, 1.5, 0.5, 0.0]


def test_ticks_that_are_skipped_leave_the_rest_on_the_grid_of_the_clock():
    """4.5 periods late: the next one comes half a period later, and no tick is left out."""
    clock = FakeClock(look=1)
    pace = ticks(1_000_000.0, clock.now, clock.sleep, skip=True)
    first = next(pace)
    clock.time += 5_500_000
    late, *rest = islice(pace, 4)
    assert round(late.lateness / 1e6, 1) == 4.5
    assert [(tick.number, tick.skipped) for tick in rest] == [(3, 4), (4, 4), (5, 4)]
    assert [tick.due - first.due for tick in rest] == [k * 1_000_000 for k in (6, 7, 8)]
    assert all(tick.lateness < 10 for tick in rest)


def test_a_run_ends_when_more_or_longer_ones_came_than_it_may_have():
    overruns = Overruns(period_ns=1_000, grace_ns=0)
    overruns.add(3_500, elapsed=1)
    assert [overruns.beyond(1, 4_000), overruns.beyond(0.5, 4_000), overruns.beyond(1, 3_000)] == [False, True, True]


def test_an_overrun_is_counted_once_with_its_length_and_burst():
    overruns = Overruns(period_ns=1_000, grace_ns=0)
    for lateness in (0, 3_500, 2_500, 1_500, 500, 0, 1_200, 0):
        overruns.add(lateness, elapsed=1)
    assert (overruns.count, overruns.ticks, overruns.worst, overruns.burst) == (2, 4, 3_500, 3)


def test_the_start_has_its_grace():
    overruns = Overruns(period_ns=1_000, grace_ns=10_000)
    overruns.add(50_000, elapsed=9_000)
    overruns.add(50_000, elapsed=11_000)
    assert overruns.count == 1
