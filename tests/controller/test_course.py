"""Courses of numbers: each shape by its closed form, one on top of the other, the corners to the right."""

import math

import pytest

from controller.course import NEVER, Act, Course, Point, Pulse, Ramp, Sine, Step, Table

S = 1_000_000_000


def course(*acts: Act) -> Course:
    """Plain value 2 t, slope 2."""
    return Course(lambda t: Point(2.0 * t / S, 2.0), acts)


@pytest.mark.parametrize(
    ("act", "t", "value", "slope"),
    [
        (Act(3 * S, Step(7.0)), 3 * S - 1, 6.0, 2.0),
        (Act(3 * S, Step(7.0)), 3 * S, 7.0, 0.0),
        (Act(S, Ramp(4.0, 2 * S)), S, 2.0, 1.0),
        (Act(S, Ramp(4.0, 2 * S)), 2 * S, 3.0, 1.0),
        (Act(S, Ramp(4.0, 2 * S)), 3 * S, 4.0, 0.0),
        (Act(S, Pulse(9.0, S)), 2 * S - 1, 9.0, 0.0),
        (Act(S, Pulse(9.0, S)), 2 * S, 4.0, 2.0),
        (Act(S, Sine(3.0, 0.25, NEVER)), 2 * S, 7.0, 2.0),
        (Act(S, Sine(3.0, 0.25, NEVER)), S, 2.0, 2.0 + 1.5 * math.pi),
        (Act(S, Sine(3.0, 0.25, 2 * S)), 3 * S, 6.0, 2.0),
        (Act(S, Table((0, S, 3 * S), (1.0, 5.0, 3.0))), 2 * S, 5.0, -1.0),
        (Act(S, Table((0, S, 3 * S), (1.0, 5.0, 3.0))), 9 * S, 3.0, 0.0),
    ],
)
def test_a_shape_is_its_closed_form(act: Act, t: int, value: float, slope: float):
    assert course(act).at(t) == pytest.approx((value, slope), abs=1e-8)


def test_what_comes_later_stands_on_what_went_before():
    """A ramp begins within a ramp, a pulse lies over both, a sine over the pulse."""
    both = course(Act(0, Ramp(10.0, 10 * S)), Act(4 * S, Ramp(0.0, 2 * S)))
    assert both.at(4 * S).value == pytest.approx(4.0)
    assert both.at(5 * S) == pytest.approx((2.0, -2.0))
    both.add(Act(5 * S, Pulse(7.0, S // 2)))
    both.add(Act(5 * S, Sine(1.0, 1.0, NEVER)))
    assert both.at(5 * S + S // 4).value == pytest.approx(8.0)
    assert both.at(5 * S + 3 * S // 4).value == pytest.approx(0.5 - 1.0)


def test_what_is_added_before_a_ramp_changes_where_that_begins():
    late = course(Act(4 * S, Ramp(0.0, 2 * S)))
    assert late.at(5 * S).value == pytest.approx(4.0)
    late.add(Act(3 * S, Step(2.0)))
    assert late.at(5 * S).value == pytest.approx(1.0)


def test_a_thousand_ramps_in_a_row_follow_one_another():
    """Each begins within the last one: a hand on a lever."""
    lever = Course(lambda _: Point(0.0, 0.0))
    for k in range(3000):
        lever.add(Act(k * S // 100, Ramp(float(k + 1), S)))
        lever.at(k * S // 100)
    assert lever.at(40 * S) == Point(3000.0, 0.0)


def test_the_next_instant_and_the_motion_are_known():
    own = course(Act(S, Ramp(4.0, 2 * S)), Act(5 * S, Pulse(1.0, S)))
    assert [own.next(t) for t in (0, S, 3 * S, 5 * S, 6 * S)] == [S, 3 * S, 5 * S, 6 * S, NEVER]
    assert [own.moves(t) for t in (0, S, 3 * S - 1, 3 * S, 5 * S)] == [False, True, True, False, False]
