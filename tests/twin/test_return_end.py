"""Ends of the return line and the check valve of line 2: their laws at any port, and that they only take energy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.check_valve import CheckValve, NoCheck, before_check, passes
from twin.oil import Oil
from twin.orifice import Orifice, resistance
from twin.port import Port
from twin.return_end import CheckedEnd, OpenEnd, OrificeEnd, return_drop, return_flow, return_slope

BAR = 1e5
FLUID = Oil(870.0, 40e-6, 1.3e9, -1e5)
ORIFICE = OrificeEnd(*resistance(110e-6, Orifice(0.67, 0.0), FLUID))
CHECKED = CheckedEnd(3 * BAR, 1e11, 1e8)
FREE = st.floats(-2e7, 2e7)
Z = st.floats(7.0, 11.0).map(lambda exponent: 10.0**exponent)


def test_an_orifice_end_is_the_turbulent_law():
    """0.67 x 110 mm^2 at 1 bar: Q = 0.67 A sqrt(2 dp/rho) = 67.1 l/min; and its slope."""
    q = return_flow(ORIFICE, Port(1 * BAR, 0.0), FLUID)
    assert q == pytest.approx(-0.67 * 110e-6 * math.sqrt(2 * BAR / 870.0), rel=1e-12)
    assert return_drop(ORIFICE, -q) == pytest.approx(1 * BAR, rel=1e-12)
    assert return_slope(ORIFICE, -q) == pytest.approx(2 * BAR / -q, rel=1e-12)


@given(FREE, Z)
def test_an_open_end_is_at_the_pressure_of_the_tank(free: float, z: float):
    assert free + z * return_flow(OpenEnd(), Port(free, z), FLUID) == pytest.approx(0.0, abs=1e-7)


@given(FREE, Z)
def test_an_orifice_lets_oil_both_ways_and_takes_energy(free: float, z: float):
    q = return_flow(ORIFICE, Port(free, z), FLUID)
    p = max(FLUID.vapour_pressure, free + z * q)
    assert p * q <= 1e-100  # a drop of rounding
    assert return_drop(ORIFICE, -q) == pytest.approx(p, rel=1e-6, abs=1.0)


@given(FREE, Z)
def test_a_checked_end_is_exactly_shut_up_to_its_cracking_pressure(free: float, z: float):
    """Complementarity: shut at or below 3 bar, open with 3 bar and the orifice's drop above."""
    q = return_flow(CHECKED, Port(free, z), FLUID)
    if free <= 3 * BAR:
        assert q == 0.0
    else:
        assert q < 0.0
        assert return_drop(CHECKED, -q) == pytest.approx(free + z * q, rel=1e-6, abs=1.0)


def line_2(check: CheckValve | NoCheck, c: float, z: float, behind: Port) -> float:
    """Flow through the check valve out of a place p = c - Z q: the shut case first, then the open one."""
    if not passes(check, c, behind):
        return 0.0
    met = before_check(check, behind)
    return (c - met.free) / (z + met.impedance)


@given(FREE, Z, FREE, Z, st.floats(0.0, 1e6))
def test_a_check_valve_never_lets_oil_back(c: float, z: float, free: float, impedance: float, cracking: float):
    """q >= 0, drop <= p_c where q is 0, equal to it where it flows; the power taken is p_c q."""
    behind = Port(free, impedance)
    q = line_2(CheckValve(cracking), c, z, behind)
    drop = (c - z * q) - (free + impedance * q)
    assert q >= 0.0
    assert drop <= cracking + 1e-6 * (abs(c) + abs(free)) + 1e-6
    assert q == 0.0 or drop == pytest.approx(cracking, abs=1e-6 * (abs(c) + abs(free)) + 1e-6)


@given(FREE, Z, FREE, Z)
def test_without_one_line_2_is_open_both_ways(c: float, z: float, free: float, impedance: float):
    q = line_2(NoCheck(), c, z, Port(free, impedance))
    assert q == pytest.approx((c - free) / (z + impedance), rel=1e-12)
    assert np.sign(q) == np.sign(c - free)
