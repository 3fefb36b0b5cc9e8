"""Which commands a plant takes."""

import math

import pytest

from bridge.loop.safety import Gate, Watchdog
from bridge.wire.codec import ValveCommand
from controller.grid import NS, sampling

RUN, OWNER, OTHER, MS = 7, 11, 12, 1_000_000
GRID = sampling(50e-6, 1e-3, 10e-3, 0.0, 5e-3)


def command(sequence: int = 0, stamp: int = 0, apply_at: int = 5 * MS, spool: float = 0.5, source=OWNER, run=RUN):
    return ValveCommand(run, source, sequence, stamp, apply_at, spool)


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (command(spool=math.nan), "not finite"),
        (command(spool=math.inf), "not finite"),
        (command(spool=1e300), "out of range"),
        (command(spool=-1.0000001), "out of range"),
        (command(run=8), "foreign run"),
        (command(apply_at=5 * MS + 1), "off the grid"),
        (command(apply_at=11 * NS), "far future"),
        (command(stamp=2 * MS), "impossible time"),
        (command(stamp=0, apply_at=-MS), "impossible time"),
    ],
)
def test_nonsense_is_refused_by_its_name_and_leaves_no_trace(bad, reason):
    gate = Gate(RUN, GRID)
    refusal = gate.check(bad, now=MS)
    assert refusal is not None
    assert refusal.reason == reason
    assert gate.refused == {reason: 1}
    assert gate.owner is None
    assert gate.check(command(), now=MS) is None


def test_an_earlier_instant_may_still_replace_a_later_one_that_has_not_acted():
    gate = Gate(RUN, GRID)
    assert gate.check(command(0, apply_at=9 * NS), now=0) is None
    assert gate.check(command(1, apply_at=10 * MS), now=0) is None
    assert gate.last_apply == 10 * MS


def test_an_answer_to_an_older_sample_is_stale():
    gate = Gate(RUN, GRID)
    assert gate.check(command(0, stamp=10 * MS, apply_at=20 * MS), now=10 * MS) is None
    older = gate.check(command(1, stamp=0, apply_at=20 * MS), now=10 * MS)
    assert older is not None
    assert older.reason == "stale"


def test_limits_themselves_are_taken():
    gate = Gate(RUN, GRID)
    assert gate.check(command(0, spool=1.0), now=0) is None
    assert gate.check(command(1, spool=-1.0, apply_at=10 * NS), now=0) is None


def test_order_is_by_sequence_and_by_time_of_action():
    gate = Gate(RUN, GRID)
    assert gate.check(command(5, apply_at=20 * MS), now=0) is None
    gate.in_force = 20 * MS
    again, older = gate.check(command(5, apply_at=30 * MS), now=0), gate.check(command(6, apply_at=10 * MS), now=0)
    assert again is not None
    assert older is not None
    assert (again.reason, older.reason) == ("out of order", "stale")
    assert gate.check(command(6, apply_at=20 * MS), now=0) is None  # for the very instant since which the one acts


def test_the_first_valid_controller_owns_the_plant_until_released():
    gate = Gate(RUN, GRID)
    assert gate.check(command(), now=0) is None
    second = gate.check(command(0, source=OTHER), now=0)
    assert second is not None
    assert second.reason == "second controller"
    gate.release(0)
    assert gate.check(command(0, source=OTHER), now=0) is None
    assert gate.owner == OTHER


def test_patience_ends_a_timeout_after_the_next_command_was_due():
    dog = Watchdog(timeout=int(0.1 * NS), grid=GRID, latching=True)
    assert dog.trip_at(15 * MS) == 15 * MS + 100 * MS


@pytest.mark.parametrize(
    ("wrong", "answers"), [({"spool": math.nan}, True), ({"spool": 2.0}, True), ({"run": 8}, False)]
)
def test_a_command_refused_for_what_it_says_is_an_answer_all_the_same(wrong, answers):
    """Lockstep waits for answers; another run's command is none, nor one that another controller gives."""
    gate = Gate(RUN, GRID)
    assert gate.check(command(0), now=0) is None
    for source, expected in ((OTHER, 0), (OWNER, 10 * MS if answers else 0)):
        gate.check(command(1, stamp=10 * MS, apply_at=15 * MS, source=source, **wrong), now=10 * MS)
        assert gate.answered == expected
