"""Orifice: the Borutzky law, explicit both ways."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import circuit, valve_of
from twin.oil import Oil
from twin.orifice import Orifice, area_for, flow, flow_slopes, quadratic_flow, resistance

OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
SHARP = Orifice(0.61, 9.33)
DROP = st.floats(-4e7, 4e7)
AREA = st.floats(1e-9, 1e-3)


@given(DROP, AREA)
def test_flow_solves_its_own_equation_and_is_odd(drop: float, area: float):
    q = flow(drop, area, SHARP, OIL)
    a, b = resistance(area, SHARP, OIL)
    assert a * q * abs(q) + b * q == pytest.approx(drop, rel=1e-12)
    assert flow(-drop, area, SHARP, OIL) == -q


@pytest.mark.parametrize(("reynolds", "coefficient"), [(1, 0.18979), (10, 0.43875), (100, 0.58339), (1000, 0.60717)])
def test_discharge_coefficient_over_reynolds(reynolds: float, coefficient: float):
    """Cd = Q/(A sqrt(2 dp/rho)), for the hole of 0.6 mm."""
    area = math.pi / 4.0 * 0.6e-3**2
    a, b = resistance(area, SHARP, OIL)
    q = reynolds * area * OIL.viscosity / 0.6e-3
    assert q / (area * math.sqrt(2.0 * (a * q * q + b * q) / OIL.density)) == pytest.approx(coefficient, abs=5e-6)
    assert flow(a * q * q + b * q, area, SHARP, OIL) == pytest.approx(q, rel=1e-12)


def test_slope_at_zero_is_the_laminar_one():
    """Q = 2 c^2 A D dp/(rho nu Re_t)."""
    area, drop = 1e-5, 1e-6
    laminar = 2.0 * 0.61**2 * area * math.sqrt(4.0 * area / math.pi) / (878.0 * 40e-6 * 9.33)
    assert flow(drop, area, SHARP, OIL) / drop == pytest.approx(laminar, rel=1e-6)
    assert flow_slopes(0.0, area, SHARP, OIL)[0] == pytest.approx(laminar, rel=1e-12)


def test_far_from_transition_it_is_the_square_root_law():
    area, drop = 1e-5, 50e5
    assert flow(drop, area, SHARP, OIL) == pytest.approx(0.61 * area * math.sqrt(2.0 * drop / 878.0), rel=5e-3)


@given(st.floats(1e3, 1e7), st.floats(1e-7, 1e-4), st.sampled_from([1.0, -1.0]))
def test_slopes_are_those_of_the_flow(size: float, area: float, sign: float):
    drop = sign * size
    by_drop, by_area = flow_slopes(drop, area, SHARP, OIL)
    d, e = 1e-4 * drop, 1e-4 * area  # central differences: relative error 1e-8
    assert by_drop == pytest.approx((flow(drop + d, area, SHARP, OIL) - flow(drop - d, area, SHARP, OIL)) / (2 * d))
    assert by_area == pytest.approx((flow(drop, area + e, SHARP, OIL) - flow(drop, area - e, SHARP, OIL)) / (2 * e))


def test_a_shut_orifice_passes_nothing():
    assert flow(1e7, 0.0, SHARP, OIL) == 0.0
    assert quadratic_flow(0.0, 1e12, 0.0) == 0.0


@given(st.floats(1e-7, 1e-3), st.floats(1e3, 1e7))
def test_area_for_is_the_inverse_of_the_flow(rated: float, drop: float):
    assert flow(drop, area_for(rated, drop, SHARP, OIL), SHARP, OIL) == pytest.approx(rated, rel=1e-9)


def test_open_valve_passes_30_l_per_min_at_10_bar_over_both_lands():
    c = circuit()
    valve = valve_of(c)
    assert flow(5e5, valve.area, valve.orifice, c.parts.oil) * 6e4 == pytest.approx(30.0, rel=1e-12)
