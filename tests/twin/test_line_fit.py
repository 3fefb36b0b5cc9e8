"""Wald's straight line: properties that hold for any data."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bridge.figures.oil.line_fit import fit_line

NUMBER = st.floats(-100.0, 100.0)
SCALE = st.floats(0.01, 100.0)
POINT = st.tuples(st.integers(-1000, 1000), NUMBER)
POINTS = st.lists(POINT, min_size=2, max_size=20, unique_by=lambda point: point[0])


def columns(points: list[tuple[int, float]]) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.array(points, float).T
    return x, y


@given(POINTS, NUMBER, NUMBER)
def test_exact_on_noise_free_lines(points: list[tuple[int, float]], slope: float, intercept: float):
    x, _ = columns(points)
    line = fit_line(x, slope * x + intercept)
    assert line[:2] == pytest.approx((slope, intercept), abs=1e-8)


@given(POINTS, st.integers(-1000, 1000), SCALE, SCALE)
def test_shift_leaves_the_slope_and_scaling_scales_it(points, shift: float, by_x: float, by_y: float):
    x, y = columns(points)
    plain, moved = fit_line(x, y, 0.1, 0.2), fit_line(by_x * (x + shift), by_y * y, 0.1 * by_x, 0.2 * by_y)
    assert moved.slope == pytest.approx(plain.slope * by_y / by_x, rel=1e-9, abs=1e-9)
    assert moved.slope_deviation == pytest.approx(plain.slope_deviation * by_y / by_x, rel=1e-9)
    assert moved.intercept == pytest.approx(by_y * (plain.intercept - plain.slope * shift), rel=1e-6, abs=1e-6)


@given(POINTS, st.randoms())
def test_order_of_the_points_does_not_matter(points, random):
    shuffled = random.sample(points, len(points))
    assert fit_line(*columns(points))[:2] == pytest.approx(fit_line(*columns(shuffled))[:2], rel=1e-9, abs=1e-9)


def test_five_points_by_hand():
    """Groups 0, 1 and 2, 3, 7: means (0.5, 1.5), (4, 5), of all (2.6, 3.6); 0.05 (1/2 + 1/3)/3.5^2 is sigma_b^2."""
    line = fit_line([3, 0, 7, 1, 2], [4, 1, 8, 2, 3], 0.1, 0.2)
    assert line == pytest.approx((1.0, 1.0, math.sqrt(0.05 * 5 / 6) / 3.5))


def test_repeated_measurements_predict_the_spread_of_the_slope():
    """4000 fits of the same 12 points with normal errors of y: their spread is the stated deviation, within 5 %."""
    x, noise = np.arange(12.0), np.random.default_rng(1).normal(0.0, 0.3, (4000, 12))
    slopes = [fit_line(x, 2.0 * x + n).slope for n in noise]
    assert np.std(slopes) == pytest.approx(fit_line(x, 2.0 * x, 0.0, 0.3).slope_deviation, rel=0.05)


@pytest.mark.parametrize(("x", "y"), [([1], [1]), ([1, 1], [0, 1]), ([1, 2], [1]), ([[1, 2]], [[1, 2]])])
def test_data_without_a_slope_are_refused(x, y):
    with pytest.raises(ValueError, match=r"x"):
        fit_line(x, y)
