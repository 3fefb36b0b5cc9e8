"""A curve through points against scipy's monotone cubic, its slope against differences, its ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from twin.table import MOST_POINTS, curve_through, value_and_slope

PLACES = st.lists(st.integers(0, 100), min_size=3, max_size=MOST_POINTS, unique=True).map(sorted)


@given(PLACES, st.data())
def test_it_is_the_monotone_cubic_of_scipy(places, data):
    values = data.draw(st.lists(st.integers(-50, 50), min_size=len(places), max_size=len(places)))
    curve = curve_through([(float(x), float(y)) for x, y in zip(places, values, strict=True)])
    scipy = PchipInterpolator(np.array(places, float), np.array(values, float))
    for x in np.linspace(places[0], places[-1], 17)[1:-1]:
        y, slope = value_and_slope(float(x), curve)
        assert y == pytest.approx(float(scipy(x)), abs=1e-9)
        assert slope == pytest.approx(float(scipy.derivative()(x)), abs=1e-9)


def test_it_stays_at_its_ends_and_meets_its_points():
    points = [(0.0, 100.0), (0.1, 130.0), (0.3, 90.0)]
    curve = curve_through(points)
    assert [value_and_slope(x, curve)[0] for x, _ in points] == pytest.approx([y for _, y in points])
    assert value_and_slope(-1.0, curve) == (100.0, 0.0)
    assert value_and_slope(7.0, curve) == (90.0, 0.0)


def test_two_points_are_a_line_and_one_is_a_constant():
    assert value_and_slope(0.25, curve_through([(0.0, 1.0), (1.0, 3.0)])) == pytest.approx((1.5, 2.0))
    assert value_and_slope(0.25, curve_through([(0.0, 7.0)])) == (7.0, 0.0)
