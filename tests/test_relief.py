"""Relief valve: the setting, the corners, and a step that solves the curve exactly."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.plant import BAR, circuit
from twin.node import Node, implicitness, pressure
from twin.relief import relief_flow, relief_slope, relieve

VALVE = circuit().relief
MODULUS = 1.17e9
START = st.floats(-5e6, 3e7)
STEP = st.floats(-6.0, -3.0).map(lambda exponent: 10.0**exponent)
VOLUME = st.floats(-6.0, -3.0).map(lambda exponent: 10.0**exponent)


def node(p: float, volume: float) -> Node:
    capacity = volume / MODULUS
    return Node(volume + capacity * p, volume, capacity)


def test_the_setting_is_67_bar_at_26_7_l_per_min():
    assert relief_flow(67 * BAR, VALVE) * 6e4 == pytest.approx(26.7, rel=1e-12)


def test_the_pilot_alone_passes_0_225_l_per_min_at_the_knee_and_the_main_stage_2_5_bar_per_100():
    assert relief_flow(VALVE.cracking, VALVE) == 0.0
    assert VALVE.knee - VALVE.cracking == pytest.approx(6.1 * BAR)
    assert relief_flow(VALVE.knee, VALVE) * 6e4 == pytest.approx(0.225)
    assert relief_flow(VALVE.knee + 2.5 * BAR, VALVE) * 6e4 == pytest.approx(100.225)


@given(START, START, VOLUME, STEP)
def test_mean_flow_solves_the_theta_rule(before: float, free: float, volume: float, step: float):
    n = node(free, volume)
    mean = relieve(before, n, VALVE, step)
    theta = implicitness(step * relief_slope(before, VALVE) / n.capacity)
    end = pressure(n._replace(stored=n.stored - step * mean), -1e9)
    expected = (1.0 - theta) * relief_flow(before, VALVE) + theta * relief_flow(end, VALVE)
    assert mean == pytest.approx(expected, rel=1e-9, abs=1e-6 * VALVE.main_slope)  # 1e-6 Pa, rounding of S - V


@given(st.floats(VALVE.knee, 3e7), VOLUME, STEP)
def test_a_stiff_main_stage_does_not_empty_a_node_below_its_knee(before: float, volume: float, step: float):
    """The main stage's straight line meets zero flow 0.0056 bar below the knee; further down only the pilot empties."""
    n, pilot = node(before, volume), relief_flow(VALVE.knee, VALVE)
    end = pressure(n._replace(stored=n.stored - step * relieve(before, n, VALVE, step)), -1e9)
    assert before >= end >= VALVE.knee - pilot / VALVE.main_slope - pilot * step / n.capacity - 1e-3
