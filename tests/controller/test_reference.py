"""References: values and slopes in closed form, corners that belong to the right, CSV errors that say where."""

import math
from itertools import pairwise

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from controller.reference import (
    Chirp,
    Constant,
    Ramp,
    Reference,
    Sine,
    Square,
    Step,
    Table,
    Target,
    evaluate,
    table_from_csv,
)

TABLE = Table((0.5, 1.0, 3.0), (0.10, 0.20, 0.05))
CHIRP = Chirp(mean=0.135, amplitude=0.02, start_frequency=0.5, end_frequency=4.5, at=1.0, duration=8.0)
CORNERS: list[tuple[Reference, tuple[float, ...]]] = [
    (Constant(0.1), ()),
    (Step(0.10, 0.15, at=1.0), (1.0,)),
    (Square(0.1, 0.02, period=2.0, at=1.0), tuple(float(t) for t in range(1, 11))),
    (Ramp(0.05, 0.20, at=1.0, rate=0.05), (1.0, 4.0)),
    (Ramp(0.20, 0.05, at=1.0, rate=0.05), (1.0, 4.0)),
    (Sine(0.1, 0.03, frequency=0.7, at=1.0), (1.0,)),
    (CHIRP, (1.0, 9.0)),
    (TABLE, TABLE.times),
]


@pytest.mark.parametrize(("reference", "corners"), CORNERS)
@given(t=st.floats(0.0, 10.0))
def test_velocity_is_the_slope_of_the_position(reference: Reference, corners: tuple[float, ...], t: float):
    h = 1e-6
    if all(abs(t - corner) > 2 * h for corner in corners):
        slope = (evaluate(reference, t + h).position - evaluate(reference, t - h).position) / (2 * h)
        assert evaluate(reference, t).velocity == pytest.approx(slope, abs=1e-8)  # rounding: 1e-16 * 0.1 m / h


@pytest.mark.parametrize(
    ("reference", "t", "target"),
    [
        (Constant(-0.4), 7.0, Target(-0.4, 0.0)),
        (Step(0.10, 0.15, at=1.0), 0.999999999, Target(0.10, 0.0)),
        (Step(0.10, 0.15, at=1.0), 1.0, Target(0.15, 0.0)),
        (Square(0.1, 0.02, period=2.0, at=1.0), 0.0, Target(0.1, 0.0)),
        (Square(0.1, 0.02, period=2.0, at=1.0), 1.0, Target(0.12, 0.0)),
        (Square(0.1, 0.02, period=2.0, at=1.0), 2.0, Target(0.08, 0.0)),
        (Square(0.1, 0.02, period=2.0, at=1.0), 3.0, Target(0.12, 0.0)),
        (Ramp(0.05, 0.20, at=1.0, rate=0.05), 1.0, Target(0.05, 0.05)),
        (Ramp(0.05, 0.20, at=1.0, rate=0.05), 2.0, Target(0.10, 0.05)),
        (Ramp(0.20, 0.05, at=1.0, rate=0.05), 2.0, Target(0.15, -0.05)),
        (Ramp(0.20, 0.05, at=1.0, rate=0.05), 4.0, Target(0.05, 0.0)),
        (Sine(0.1, 0.03, frequency=0.5, at=1.0), 0.9, Target(0.1, 0.0)),
        (Sine(0.1, 0.03, frequency=0.5, at=1.0), 1.0, Target(0.1, 0.03 * math.pi)),
        (Sine(0.1, 0.03, frequency=0.5, at=1.0), 1.5, Target(0.13, 0.0)),
        (CHIRP, 1.0, Target(0.135, 0.02 * math.pi)),
        (CHIRP, 9.0, Target(0.135, 0.0)),
        (TABLE, 0.0, Target(0.10, 0.0)),
        (TABLE, 0.5, Target(0.10, 0.2)),
        (TABLE, 2.0, Target(0.125, -0.075)),
        (TABLE, 3.0, Target(0.05, 0.0)),
        (TABLE, 9.0, Target(0.05, 0.0)),
    ],
)
def test_values_at_and_beside_the_corners(reference: Reference, t: float, target: Target):
    assert evaluate(reference, t) == pytest.approx(target, abs=1e-15)


@given(at_ms=st.integers(0, 10_000), half_period_ms=st.integers(1, 500), n=st.integers(0, 100))
def test_square_switches_on_the_very_tick_in_spite_of_rounding(at_ms: int, half_period_ms: int, n: int):
    """0.3 s is not a binary number: a stamp of whole nanoseconds must still find its corner."""
    square = Square(0.0, 1.0, period=2 * half_period_ms * 1e-3, at=at_ms * 1e-3)
    corner_ns = (at_ms + n * half_period_ms) * 1_000_000
    assert evaluate(square, corner_ns * 1e-9).position == (1.0 if n % 2 == 0 else -1.0)
    assert evaluate(square, (corner_ns - 1) * 1e-9).position == (0.0 if n == 0 else 1.0 if n % 2 else -1.0)


@given(at_ns=st.integers(0, 10**11))
@example(300_000)  # 300 000 * 1e-9 > 300 000 / 1e9
def test_step_is_taken_on_the_very_nanosecond(at_ns: int):
    for at, now in ((at_ns * 1e-9, at_ns / 1e9), (at_ns / 1e9, at_ns * 1e-9)):
        step = Step(0.0, 1.0, at)
        assert evaluate(step, now).position == 1.0
        assert evaluate(step, now - 1e-9).position == 0.0


def test_held_ends_are_exact():
    """A held reference must be one number: metrics look for stretches of equal samples."""
    for reference in (Ramp(0.1, 0.3, at=0.3, rate=0.07), CHIRP):
        assert len({evaluate(reference, 9.0 + 0.01 * k).position for k in range(1000)}) == 1
    assert evaluate(Ramp(0.1, 0.3, at=0.3, rate=0.07), 9.0).position == 0.3


def test_chirp_turns_as_often_as_its_mean_frequency_says():
    """8 s from 0.5 to 4.5 Hz are 20 turns, two sign changes each."""
    wave = [evaluate(CHIRP, 1.0 + 1e-3 * (k + 0.5)).position - CHIRP.mean for k in range(8000)]
    assert sum(a * b < 0.0 for a, b in pairwise(wave)) == 2 * 20 - 1
    first_half = wave[:4000]  # 4 s at a mean of 1.5 Hz: 6 turns
    assert sum(a * b < 0.0 for a, b in pairwise(first_half)) == 2 * 6 - 1


def test_what_is_no_reference_is_refused():
    with pytest.raises(TypeError, match=r"0\.3 at 1\.0 s is not a reference"):
        evaluate(0.3, 1.0)  # pyright: ignore[reportArgumentType, reportCallIssue]


@pytest.mark.parametrize(
    "text", ["time_s,position_m\n0,0.1\n1.5,0.2\n", "0,0.1\r\n1.5,0.2", "\ufefftime_s, position_m\n\n 0 ,1e-1\n1.5,.2"]
)
def test_csv_with_or_without_header_gives_the_table(text: str):
    assert table_from_csv(text) == Table((0.0, 1.5), (0.1, 0.2))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,0.1\n0,0.2", r"line 2: time 0\.0 s is not after 0\.0 s; times must increase"),
        ("time_s,position_m\n0,0.1\n\n1,0.2\n0.5,0.2", r"line 5: time 0\.5 s is not after 1\.0 s"),
        ("0,0.1\n1,high", r"line 2: position_m is 'high'; expected a finite number"),
        ("0,0.1\n1,nan", r"line 2: position_m is 'nan'; expected a finite number"),
        ("0,0.1\ninf,0.1", r"line 2: time_s is 'inf'; expected a finite number"),
        ("t,x\n0,0.1\n1,0.1", r"line 1: time_s is 't'; expected a finite number"),
        ("0 0.1\n1 0.2", r"line 1: 1 columns in '0 0\.1'; expected 2: time_s,position_m"),
        ("0,0.1,3", r"line 1: 3 columns"),
        ("time_s,position_m\n0,0.1", r"1 rows of numbers; a table needs at least 2"),
        ("", r"0 rows of numbers"),
    ],
)
def test_csv_errors_say_line_value_and_what_is_expected(text: str, message: str):
    with pytest.raises(ValueError, match=message):
        table_from_csv(text)
