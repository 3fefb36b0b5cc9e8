"""End stops: the instant of an impact, restitution, and rest."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.contact import Stops, stopped, travel

STOPS = Stops(stroke=0.27, restitution=0.2, rest_speed=1e-3)


def test_free_travel_is_plain():
    assert travel(0.1, 0.5, STOPS, 1e-3) == (0.1 + 0.5e-3, 0.5)


@pytest.mark.parametrize(("position", "speed", "sign"), [(0.27 - 2e-4, 0.5, 1.0), (2e-4, -0.5, -1.0)])
def test_an_impact_happens_at_its_own_instant(position: float, speed: float, sign: float):
    """0.2 mm at 0.5 m/s take 0.4 ms of the 1 ms; the other 0.6 ms go back at a fifth of the speed."""
    there, rebound = travel(position, speed, STOPS, 1e-3)
    stop = 0.27 if sign > 0.0 else 0.0
    assert rebound == pytest.approx(-0.2 * speed, rel=1e-15)
    assert there == pytest.approx(stop - sign * 0.1 * 0.6e-3, abs=1e-17 / 1e-3)


def test_a_slow_impact_is_dead_and_the_stop_holds():
    assert travel(1e-8, -0.9e-3, STOPS, 1e-3) == (0.0, 0.0)
    assert stopped(0.0, -1.0, STOPS) == 0.0
    assert stopped(0.0, 1.0, STOPS) == 1.0
    assert stopped(0.27, 1.0, STOPS) == 0.0
    assert stopped(0.1, -1.0, STOPS) == -1.0


@given(st.floats(0.0, 0.27), st.floats(-5.0, 5.0), st.floats(1e-6, 1e-3))
def test_nothing_leaves_the_stroke_nor_gains_speed(position: float, speed: float, time: float):
    there, then = travel(position, speed, STOPS, time)
    assert 0.0 <= there <= 0.27
    assert abs(then) <= abs(speed)


def test_a_dropped_mass_bounces_to_rest_in_the_time_of_the_series():
    """From 0.1 m: impacts at v1 = sqrt(2 g h), then bounces of 2 v_n/g with v_n = e^n v1, down to the rest speed."""
    h, x, v, t = 1e-5, 0.1, 0.0, 0.0
    while not (x == 0.0 and v == 0.0):
        v = stopped(x, v - 0.5 * h * 9.81, STOPS)
        x, v = travel(x, v, STOPS, h)
        v = stopped(x, v - 0.5 * h * 9.81, STOPS)
        t += h
        assert t < 1.0
    first = (2.0 * 9.81 * 0.1) ** 0.5
    flights = sum(2.0 * 0.2**n * first / 9.81 for n in range(1, 5))  # 0.2^5 v1 < 1 mm/s < 0.2^4 v1
    assert t == pytest.approx(first / 9.81 + flights, abs=1e-4)
