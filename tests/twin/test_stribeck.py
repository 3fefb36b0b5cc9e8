"""Coulomb, Stribeck and viscous friction: the curve, exact rest, loss of energy, order of the step."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.mechanics import SLOT
from twin.friction import friction_force, largest_at_rest, slide
from twin.integration import integrate
from twin.stribeck import Stribeck, stribeck_force

CURVE = Stribeck(300.0, 400.0, 0.01, 1000.0, 0.0, 1.0)
ABRUPT = CURVE._replace(stribeck_speed=0.0)  # of the comparison circuit: 300 N sliding, 400 N static, 1000 N s/m
NONE = np.zeros(SLOT)
STEP = 25e-6


def after(v: float, drive: float, kind: Stribeck = CURVE, mass: float = 200.0, time: float = STEP) -> float:
    return slide(kind, v, drive, mass, 0.0, NONE, time)


@pytest.mark.parametrize("v", [1e-4, 0.01, 0.3])
def test_the_curve_falls_from_static_to_sliding_and_rises_with_speed(v: float):
    """300 + 100 exp(-(v/v_s)^2) + 1000 v, in both directions."""
    expected = 300.0 + 100.0 * math.exp(-((v / 0.01) ** 2)) + 1000.0 * v
    assert stribeck_force(v, 0.0, CURVE) == pytest.approx(expected, rel=1e-12)
    assert friction_force(CURVE, -v, 0.0, 0.0, NONE) == pytest.approx(expected, rel=1e-12)


def test_pressure_adds_to_both_and_a_share_multiplies_the_negative_direction():
    kind = Stribeck(300.0, 400.0, 0.01, 1000.0, 1e-5, 0.5)
    assert largest_at_rest(kind, 1.0, 50e5) == pytest.approx(450.0)
    assert largest_at_rest(kind, -1.0, 50e5) == pytest.approx(225.0)
    assert stribeck_force(-0.2, 50e5, kind) == pytest.approx(0.5 * stribeck_force(0.2, 50e5, kind))
    assert stribeck_force(0.2, 50e5, kind) == pytest.approx(550.0, rel=1e-9)


@given(st.floats(-1.0, 1.0))
def test_inside_the_static_limit_a_mass_at_rest_stays_exactly_at_rest(share: float):
    assert after(0.0, share * 399.999) == 0.0
    assert friction_force(CURVE, 0.0, share * 399.999, 0.0, NONE) == -share * 399.999


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_breaks_away_feels_the_sliding_friction(sign: float):
    """401 N against 300 N where the fall is abrupt, against 400 N where it is not: m dv = (401 - F) dt."""
    assert after(0.0, sign * 401.0, ABRUPT) == pytest.approx(sign * STEP * 101.0 / 200.0, rel=1e-4)
    assert after(0.0, sign * 401.0) == pytest.approx(sign * STEP * 1.0 / 200.0, rel=1e-4)


def test_viscous_and_coulomb_friction_alone_have_a_closed_form():
    """m v' = F - F_c - b v: v = v_inf (1 - exp(-b t/m)), at a step of 5 % of m/b within its square."""
    v, h = 0.0, 0.01
    for _ in range(40):
        v = after(v, 900.0, ABRUPT, 200.0, h)
    assert v == pytest.approx(0.6 * (1.0 - math.exp(-2.0)), rel=3e-4)


@given(st.floats(-1.0, 1.0), st.floats(1.0, 1e3), st.floats(1e-6, 1e-2))
def test_friction_alone_dissipates_and_never_turns_the_motion_round(v: float, mass: float, time: float):
    then = after(v, 0.0, CURVE, mass, time)
    assert 0.0 <= then * math.copysign(1.0, v) <= abs(v)


@given(st.floats(-1.0, 1.0), st.floats(-1e4, 1e4), st.floats(1.0, 1e3), st.floats(1e-6, 1e-3))
def test_kinetic_energy_grows_by_no_more_than_the_work_of_the_drive(v: float, drive: float, mass: float, time: float):
    """m (v'^2 - v^2)/2 <= t F (v + v')/2; once it turns round it is not faster than without friction."""
    then = after(v, drive, CURVE, mass, time)
    if then * v > 0.0:
        work = 0.5 * time * drive * (v + then)
        assert 0.5 * mass * (then * then - v * v) <= work + 1e-12 * (abs(work) + mass * (v * v + then * then))
    else:
        assert abs(then) <= abs(v + time * drive / mass) * (1.0 + 1e-12)


def test_sliding_is_of_second_order():
    """1000 N from 2 mm/s through the falling part of the curve, against scipy."""
    exact = integrate(
        lambda _, v: [(1000.0 - stribeck_force(v[0], 0.0, CURVE)) / 200.0],
        (0.0, 0.02), [0.002], "DOP853", most=20_000, rtol=1e-12, atol=1e-15,
    ).y[0, -1]  # fmt: skip

    def error(steps: int) -> float:
        v = 0.002
        for _ in range(steps):
            v = after(v, 1000.0, CURVE, 200.0, 0.02 / steps)
        return abs(v - exact)

    assert math.log2(error(40) / error(80)) == pytest.approx(2.0, abs=0.15)
