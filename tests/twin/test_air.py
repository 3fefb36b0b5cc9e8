"""Entrained air: its law against its own volumes, and chambers that hold it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR
from twin.actuator import chamber_cavities, chamber_pressures, chamber_volumes, fill_chambers, stored_oil
from twin.air import (
    ATMOSPHERE,
    Air,
    NoAir,
    compressibility,
    compression,
    effective_bulk_modulus,
    pressure_at,
)
from twin.cylinder import Chambers, Cylinder
from twin.integration import integrate
from twin.port import Port

B, VAPOUR, H = 1.17e9, -0.95 * BAR, 50e-6
AIRS = st.builds(Air, st.floats(1e-5, 0.2), st.floats(1.0, 1.4))
PRESSURE = st.floats(VAPOUR, 300 * BAR)


def cylinder(air: Air | NoAir, leak: float = 1e-13) -> Cylinder:
    return Cylinder(1.159e-3, 1.963e-3, 11.6e-6, 19.6e-6, 0.27, leak, B, VAPOUR, air)


@given(AIRS, PRESSURE)
def test_volumes_of_oil_and_bubbles_add_up(air: Air, p: float):
    """A unit at atmospheric pressure: (1 - alpha) of oil, 1 + p/B denser, and alpha that follows p v^n = const."""
    bubbles = air.share * (ATMOSPHERE / (ATMOSPHERE + p)) ** (1.0 / air.exponent)
    assert compression(air, B, p) == pytest.approx(1.0 / ((1.0 - air.share) / (1.0 + p / B) + bubbles), rel=1e-12)
    assert compression(air, B, 0.0) == pytest.approx(1.0, rel=1e-15)


@given(AIRS, st.floats(-0.9 * BAR, 300 * BAR))
def test_the_effective_modulus_is_the_slope(air: Air, p: float):
    """B_eff = S/V / (d(S/V)/dp) against differences, 1e-4 of r; below that of oil without air, and near it high up."""
    d = 1e-4 * (ATMOSPHERE + p)
    slope = (compression(air, B, p + d) - compression(air, B, p - d)) / (2.0 * d)
    assert compressibility(air, B, p) == pytest.approx(slope, rel=1e-5)
    assert effective_bulk_modulus(air, B, p) == pytest.approx(compression(air, B, p) / slope, rel=1e-5)
    assert effective_bulk_modulus(air, B, p) <= (B + p) * (1.0 + 1e-12)


def test_one_percent_of_air_at_10_bar_halves_the_modulus():
    """By hand, isothermal: 1/B_eff = (0.99/B + 0.01/(p_0 r^2)) V_0/V, r = 10.87."""
    by_hand = (0.99 / (B * (1.0 + 1e6 / B) ** 2) + 0.01 / (ATMOSPHERE * 10.869**2)) / (0.99 / (1.0 + 1e6 / B) + 9.2e-4)
    assert 1.0 / effective_bulk_modulus(Air(0.01, 1.0), B, 1e6) == pytest.approx(by_hand, rel=1e-4)
    assert effective_bulk_modulus(Air(0.01, 1.0), B, 1e6) == pytest.approx(0.503 * B, rel=2e-3)
    assert effective_bulk_modulus(NoAir(), B, 1e6) == B


@given(st.one_of(AIRS, st.just(NoAir())), PRESSURE)
def test_a_pressure_is_found_from_what_a_volume_holds(air: Air | NoAir, p: float):
    share = compression(air, B, p)
    assert pressure_at(air, B, share, VAPOUR) == pytest.approx(p, abs=1e-2)
    assert pressure_at(air, B, 0.5 * compression(air, B, VAPOUR), VAPOUR) == VAPOUR


@given(AIRS, st.tuples(PRESSURE, PRESSURE), st.tuples(*[st.floats(-200 * BAR, 300 * BAR)] * 2), st.floats(0.0, 0.27),
       st.floats(-14.0, -8.0))  # fmt: skip
def test_a_step_solves_the_trapezoidal_rule(air: Air, p, c, x: float, leak: float):
    """Oil to the last bit, pressures those of the oil within 1 Pa and never below vapour, whatever the step."""
    own, before, inflow = cylinder(air, 10.0**leak), Chambers(*p), Chambers(2e-4, -3e-4)
    stored, z = stored_oil(before, x, own), 3e9
    then, after, _ = fill_chambers(stored, before, inflow, Port(c[0], z), Port(c[1], z), x, own, H)
    leaked = own.leakage * (p[0] - p[1] + after.lower - after.upper)
    for old, new, flow, free, at, sign in zip(stored, then, inflow, c, after, (-1.0, 1.0), strict=True):
        assert new - old == pytest.approx(0.5 * H * (flow + (free - at) / z + sign * leaked), rel=1e-9, abs=1e-18)
    assert min(after) >= VAPOUR
    assert chamber_pressures(then, x, own) == pytest.approx(after, rel=1e-6, abs=1.0)


@given(AIRS, st.floats(0.05, 0.95))
def test_a_cavity_is_what_oil_and_bubbles_leave_free(air: Air, filled: float):
    """S + V_cav = V S/V(p_v): what would fill the place of the vapour, beside air that has expanded."""
    own, volume = cylinder(air), chamber_volumes(0.1, cylinder(air))
    thinnest = compression(air, B, VAPOUR)
    stored = Chambers(volume.lower * thinnest * filled, volume.upper)
    assert chamber_pressures(stored, 0.1, own).lower == VAPOUR
    assert chamber_cavities(stored, 0.1, own).lower == pytest.approx(volume.lower * thinnest * (1.0 - filled), rel=1e-9)


def test_a_filling_chamber_is_of_second_order():
    """From 0.5 bar below atmosphere to 40 bar through 2e10 Pa s/m^3, against scipy: 2 % of air, adiabatic."""
    air, x, z = Air(0.02, 1.4), 0.1, 2e10
    own = cylinder(air, 0.0)
    volume = chamber_volumes(x, own).lower

    def free(t: float) -> float:
        return 40 * BAR * math.sin(100.0 * t) ** 2 - 0.5 * BAR * math.cos(100.0 * t) ** 2

    def rate(t: float, p: np.ndarray) -> np.ndarray:
        return (free(t) - p) / z / (volume * compressibility(air, B, float(p[0])))

    right = integrate(rate, (0.0, 0.02), [-0.5 * BAR], "Radau", most=200_000, rtol=1e-10, atol=1e-2).y[0, -1]

    def miss(step: float) -> float:
        p = Chambers(-0.5 * BAR, 0.0)
        stored, flow = stored_oil(p, x, own), 0.0
        for k in range(1, round(0.02 / step) + 1):
            port = Port(free(k * step), z)
            stored, p, _ = fill_chambers(stored, p, Chambers(flow, 0.0), port, Port(0.0, math.inf), x, own, step)
            flow = (port.free - p.lower) / z
        return abs(p.lower - right)

    assert math.log2(miss(100e-6) / miss(50e-6)) == pytest.approx(2.0, abs=0.15)
