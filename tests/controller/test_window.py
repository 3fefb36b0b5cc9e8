"""Bands on a part of a run: statistics between moments, and how they are written."""

import math

import numpy as np
import pytest

from bridge.scenario.bands import parse_band
from controller.bands import Moment, WindowBand
from controller.window import judge_window

TIME = np.arange(1001) * 1e-3
RAMP = TIME * 10.0


@pytest.mark.parametrize(
    ("statistic", "value"), [("mean", 3.0), ("least", 2.0), ("greatest", 4.0), ("rms", math.sqrt(9.0 + 1.0 / 3.0))]
)
def test_statistics_of_a_ramp_between_two_moments(statistic: str, value: float):
    band = WindowBand(statistic, "x", Moment("contact", 0.1), Moment("contact", 0.3), "<=", 3.0)
    verdict = judge_window(band, TIME, RAMP, {"contact": 0.1})
    assert verdict.value == pytest.approx(value, rel=1e-3)  # rms: the sum for the integral
    assert verdict.passed == (value <= 3.0 + 1e-12)


def test_a_moment_that_never_came_and_an_empty_window_pass_nothing():
    band = WindowBand("mean", "x", Moment("impact", 0.0), Moment("end", 0.0), "<=", 1e9)
    assert not judge_window(band, TIME, RAMP, {"impact": math.nan, "end": 1.0}).passed
    assert not judge_window(band, TIME, RAMP, {"impact": 2.0, "end": 1.0}).passed


def test_bands_in_words():
    assert parse_band("mean p1 from impact + 300 ms to end >= 66 bar") == WindowBand(
        "mean", "p1", Moment("impact", 0.3), Moment("end", 0.0), ">=", 66e5
    )
    assert parse_band("greatest cavity_upper from 0.5 s to contact - 5 ms <= 2 cm^3") == WindowBand(
        "greatest", "cavity_upper", Moment("start", 0.5), Moment("contact", -0.005), "<=", 2e-6
    )
    assert parse_band("least p_t >= -1 bar") == WindowBand(
        "least", "p_t", Moment("start", 0.0), Moment("end", 0.0), ">=", -1e5
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mean p5 >= 1 bar", "no signal 'p5' \\(valid: position"),
        ("mean p1 >= 1 mm", "unit 'mm' does not fit here"),
        ("mean p1 from impct to end >= 1 bar", "no moment 'impct'; did you mean 'impact'"),
        ("mean p1 from 1 parsec to end >= 1 bar", "unit 'parsec' does not fit here"),
        ("median p1 >= 1 bar", "no metric 'median p1'"),
    ],
)
def test_a_mistake_is_named(text: str, said: str):
    with pytest.raises(ValueError, match=said):
        parse_band(text)
