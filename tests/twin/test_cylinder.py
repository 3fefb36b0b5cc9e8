"""Chambers at their lines: the trapezoidal step against its own equations, with and without cavities."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR
from twin.actuator import chamber_cavities, chamber_pressures, chamber_volumes, counted, fill_chambers, stored_oil
from twin.cylinder import Chambers, Cylinder
from twin.port import Port

H = 50e-6
CYLINDER = Cylinder(1.159e-3, 1.963e-3, 11.6e-6, 19.6e-6, 0.27, 1e-12, 1.17e9, -BAR)
PRESSURE = st.floats(0.0, 200 * BAR)
FREE = st.floats(-200 * BAR, 300 * BAR)
Z = st.floats(1e9, 2e10)
LEAK = st.floats(-14.0, -8.0).map(lambda exponent: 10.0**exponent)


@given(st.tuples(PRESSURE, PRESSURE), st.tuples(FREE, FREE), st.tuples(Z, Z), LEAK, st.floats(0.0, 0.27))
def test_a_step_solves_the_trapezoidal_rule_with_no_pressure_below_vapour(p, c, z, leak, x):
    """S' - S = h/2 (flows at the start + flows at the end), p = max(p_v, B (S/V - 1)) at the end."""
    cylinder = CYLINDER._replace(leakage=leak)
    before, inflow = Chambers(*p), Chambers(2e-4, -3e-4)
    stored = stored_oil(before, x, cylinder)
    then, after, _ = fill_chambers(stored, before, inflow, Port(c[0], z[0]), Port(c[1], z[1]), x, cylinder, H)
    leaked = leak * (p[0] - p[1]) + leak * (after.lower - after.upper)
    for old, new, flow, port, at, sign in zip(
        stored, then, inflow, (Port(c[0], z[0]), Port(c[1], z[1])), after, (-1.0, 1.0), strict=True
    ):
        mean = 0.5 * (flow + (port.free - at) / port.impedance + sign * leaked)
        assert new - old == pytest.approx(H * mean, rel=1e-9, abs=1e-18)
    assert min(after) >= -BAR
    assert chamber_pressures(then, x, cylinder) == pytest.approx(after, rel=1e-9, abs=1e-7 * 1.17e9 * 1e-6)


@given(st.floats(0.0, 0.27), st.floats(-0.5, 0.5))
def test_a_cavity_is_what_the_oil_leaves_free(x: float, filled: float):
    """Where p > p_v there is none; else S + V_cav = V (1 + p_v/B)."""
    volume = chamber_volumes(x, CYLINDER)
    stored = Chambers(volume.lower * (1.0 + filled), volume.upper)
    p, hollow = chamber_pressures(stored, x, CYLINDER), chamber_cavities(stored, x, CYLINDER)
    if p.lower > -BAR:
        assert hollow.lower == 0.0
    else:
        assert stored.lower + hollow.lower == pytest.approx(volume.lower * (1.0 - BAR / 1.17e9), rel=1e-12)


def test_the_volumes_are_those_of_table_2_1():
    """Piston at the lower stop: the dead volume below, 270 mm of the full bore above."""
    volume = chamber_volumes(0.0, CYLINDER)
    assert volume == (11.6e-6, pytest.approx(19.6e-6 + 0.27 * 1.963e-3))


@pytest.mark.parametrize("by_mass", [1.0, 0.0])
def test_a_pressure_stays_when_the_piston_makes_room_for_what_flows_in(by_mass):
    """By volume A v at the chamber's pressure, by mass A v (1 + p/B); rounding of stored oil is 1e-16 of it."""
    cylinder, p = CYLINDER._replace(by_mass=by_mass), Chambers(100 * BAR, 40 * BAR)
    before, then = 0.10, 0.13
    inflow = [
        sign * area * (then - before) * (1.0 + by_mass * pressure / cylinder.bulk_modulus)
        for sign, area, pressure in zip((1.0, -1.0), (cylinder.area_lower, cylinder.area_upper), p, strict=True)
    ]
    held = counted(cylinder, stored_oil(p, before, cylinder), p, before, then)
    filled = Chambers(held.lower + inflow[0], held.upper + inflow[1])
    assert chamber_pressures(filled, then, cylinder) == pytest.approx(p, rel=1e-9)
