"""Gear pump: the figures of section 2.6 of the source."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.plant import BAR, circuit
from twin.circuit import through_pump
from twin.node import Node, pressure
from twin.pump import displacement, pump_flow, pumped_oil

PUMP = circuit().pump


def test_displacement_is_that_of_the_teeth():
    """2 pi B m^2 (z + 1 - pi^2 cos^2(alpha)/12) = 0.02482 l/rev."""
    assert displacement(63e-3, 2.6e-3, 9.0, math.radians(20.0)) * 1e3 == pytest.approx(0.02482, abs=5e-6)


def test_26_7_l_per_min_at_35_bar_and_1230_rpm():
    assert pump_flow(35 * BAR, PUMP) * 6e4 == pytest.approx(26.7, abs=0.05)
    assert pump_flow(35 * BAR, PUMP) / pump_flow(0.0, PUMP) == pytest.approx(0.875, rel=1e-12)


def test_pumped_oil_is_flow_times_density_and_its_slope_the_derivative():
    oil, slope = pumped_oil(50 * BAR, PUMP, 1.17e9)
    assert oil == pytest.approx(pump_flow(50 * BAR, PUMP) * (1.0 + 50 * BAR / 1.17e9), rel=1e-14)
    above, below = (pumped_oil(50 * BAR + d, PUMP, 1.17e9)[0] for d in (1e3, -1e3))
    assert slope == pytest.approx((above - below) / 2e3, rel=1e-7)


@given(st.floats(-BAR, 300 * BAR), st.floats(-0.02, 0.02))
def test_a_step_of_the_pump_is_the_trapezoidal_rule_down_to_a_cavity(before: float, filled: float):
    """Mean oil flow = Q(before) + slope (after - before)/2, after being the pressure that this flow leaves."""
    c, volume = circuit(), 5e-5
    node = Node(volume * (1.0 + filled), volume, volume / 1.17e9)
    mean = through_pump(before, node, c.pump, c.oil, 1e-4)
    after = pressure(node._replace(stored=node.stored + 1e-4 * mean), c.oil.vapour_pressure)
    inflow, slope = pumped_oil(before, c.pump, c.oil.bulk_modulus)
    assert mean == pytest.approx(inflow + 0.5 * slope * (after - before), rel=1e-9)
