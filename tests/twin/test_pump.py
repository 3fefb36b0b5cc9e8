"""Gear pump: the figures of section 2.6 of the thesis, and the ripple of its teeth."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR, circuit, pump_of
from twin.pump import displacement, pump_flow, pumped_oil, ripple_flow, ripple_volume, speed_ratio, teeth_passed

PUMP = pump_of(circuit())
GEAR = (63e-3, 2.6e-3, 9.0, math.radians(20.0))
OMEGA = 2.0 * math.pi * 1230.0 / 60.0


def printed(time: float) -> float:
    """(2.104): B omega (m^2 (z + 1) - x^2), x the sawtooth between -+ pi m cos(alpha)/2."""
    width, module, teeth, angle = GEAR
    reach = 0.5 * math.pi * module * math.cos(angle)
    x = reach * (2.0 * ((time * PUMP.tooth_frequency) % 1.0) - 1.0)
    return width * OMEGA * (module**2 * (teeth + 1.0) - x**2)


def test_displacement_is_that_of_the_teeth():
    """2 pi B m^2 (z + 1 - pi^2 cos^2(alpha)/12) = 0.02482 l/rev."""
    assert displacement(*GEAR) * 1e3 == pytest.approx(0.02482, abs=5e-6)


def test_26_7_l_per_min_at_35_bar_and_1230_rpm():
    assert pump_flow(35 * BAR, 1.0, PUMP) * 6e4 == pytest.approx(26.7, abs=0.05)
    assert pump_flow(35 * BAR, 1.0, PUMP) / pump_flow(0.0, 1.0, PUMP) == pytest.approx(0.875, rel=1e-12)


def test_pumped_oil_is_flow_times_density_and_its_slope_the_derivative():
    oil, slope = pumped_oil(50 * BAR, 1.0, PUMP, 1.17e9)
    assert oil == pytest.approx(pump_flow(50 * BAR, 1.0, PUMP) * (1.0 + 50 * BAR / 1.17e9), rel=1e-14)
    above, below = (pumped_oil(50 * BAR + d, 1.0, PUMP, 1.17e9)[0] for d in (1e3, -1e3))
    assert slope == pytest.approx((above - below) / 2e3, rel=1e-7)


@pytest.mark.parametrize("share", [0.03, 0.25, 0.5, 0.8])
def test_the_flow_of_a_tooth_is_the_printed_one(share: float):
    """Averaged over a millionth of a tooth: the formula itself."""
    time = (7.0 + share) / PUMP.tooth_frequency
    window = 1e-6 / PUMP.tooth_frequency
    flow = PUMP.delivery + ripple_flow(time, window, PUMP)
    assert flow == pytest.approx(printed(time - 0.5 * window), rel=1e-6)


@given(st.floats(1e-6, 3e-3), st.floats(0.0, 0.01))
def test_whatever_the_step_a_revolution_delivers_the_displacement(step: float, start: float):
    """Windows that follow each other add up to the volume between their ends: over whole teeth nothing is left."""
    period = 9.0 / PUMP.tooth_frequency
    edges = np.arange(start, start + period, step)
    windows = [(then, then - before) for before, then in pairwise(edges)]
    windows.append((start + period, start + period - edges[-1]))
    surplus = sum(ripple_flow(time, window, PUMP) * window for time, window in windows if window > 0.0)
    assert abs(surplus) < 1e-9 * displacement(*GEAR)


def test_the_ripple_is_a_fifth_of_the_flow():
    """From z + 1 - pi^2 cos^2(alpha)/4 to z + 1, over z + 1 - pi^2 cos^2(alpha)/12: 23.5 % peak to peak."""
    flows = [PUMP.delivery + ripple_flow(t, 1e-7, PUMP) for t in np.linspace(0.1, 0.2, 5000)]
    share = (max(flows) - min(flows)) / PUMP.delivery
    k = (math.pi * math.cos(GEAR[3])) ** 2
    assert share == pytest.approx((k / 4.0) / (10.0 - k / 12.0), rel=1e-3)
    assert ripple_volume(*GEAR) == pytest.approx(displacement(*GEAR) / 9.0 * (k / 4.0) / (10.0 - k / 12.0), rel=1e-12)


def test_a_pump_that_runs_up_has_turned_half_as_far():
    """Constant acceleration: n t^2/(2 T) until T, then n (t - T/2)."""
    pump = PUMP._replace(run_up=0.4)
    assert speed_ratio(0.1, pump) == 0.25
    assert speed_ratio(1.0, pump) == 1.0
    assert teeth_passed(0.4, pump) == pytest.approx(0.2 * PUMP.tooth_frequency)
    assert teeth_passed(0.2, pump) == pytest.approx(0.05 * PUMP.tooth_frequency)
