"""Where components meet line ends: one pressure, exact passage, cavities that open and close without losing oil."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.port import Port, cavity, joined, passage, pressure, with_cavity

VAPOUR, H = -1e5, 50e-6
FREE = st.floats(-3e7, 3e7)
IMPEDANCE = st.floats(7.0, 11.0).map(lambda exponent: 10.0**exponent)
A = st.floats(10.0, 15.0).map(lambda exponent: 10.0**exponent)
B = st.floats(6.0, 12.0).map(lambda exponent: 10.0**exponent)


def port(free: float, impedance: float) -> Port:
    return Port(free, impedance)


@given(FREE, IMPEDANCE, FREE, IMPEDANCE)
def test_two_ends_at_one_place_share_pressure_and_balance_flows(c_1, z_1, c_2, z_2):
    """(p - c_1)/Z_1 + (p - c_2)/Z_2 = Q for any delivered Q, (2.101)."""
    q = 3e-4
    both = joined(c_1, z_1, c_2, z_2)
    p = pressure(both, q, -math.inf)
    assert (p - c_1) / z_1 + (p - c_2) / z_2 == pytest.approx(q, rel=1e-9, abs=1e-12 * 3e7 / min(z_1, z_2))


@given(FREE, IMPEDANCE, FREE, IMPEDANCE, A, B)
def test_passage_solves_its_law_with_both_pressures_at_or_above_vapour(up, z_up, down, z_down, a, b):
    source, sink = port(up, z_up), port(down, z_down)
    q = passage(source, sink, a, b, VAPOUR)
    drop = pressure(source, -q, VAPOUR) - pressure(sink, q, VAPOUR)
    assert a * q * abs(q) + b * q == pytest.approx(drop, rel=1e-6, abs=1.0)


@given(FREE, IMPEDANCE, FREE, IMPEDANCE, A, B)
def test_passage_takes_energy_and_has_no_preferred_direction(up, z_up, down, z_down, a, b):
    source, sink = port(up, z_up), port(down, z_down)
    q = passage(source, sink, a, b, VAPOUR)
    assert q * (pressure(source, -q, VAPOUR) - pressure(sink, q, VAPOUR)) >= -1e-9
    assert passage(sink, source, a, b, VAPOUR) == pytest.approx(-q, rel=1e-12)


def fill(c: float, z: float, volume: float, q: float) -> tuple[float, float, float]:
    """Pressure, flow into the line and cavity after a step in which a component delivers q."""
    p = with_cavity(port(c, z), volume, H)
    at = pressure(p, q, VAPOUR)
    return at, (at - c) / z, cavity(p, q, VAPOUR, H) if at == VAPOUR else 0.0


@given(FREE, IMPEDANCE, st.floats(0.0, 1e-5), st.floats(-1e-3, 1e-3))
def test_a_cavity_is_what_the_line_took_and_nobody_brought(c, z, volume, q):
    """V' = V + h (into the line - delivered), never negative, and p > p_v only without a cavity."""
    p, taken, then = fill(c, z, volume, q)
    assert p >= VAPOUR
    assert then >= 0.0
    assert then == pytest.approx(volume + H * (taken - q), abs=1e-12 * (1e-5 + H * (abs(taken) + abs(q))))
    assert then == 0.0 or p == VAPOUR


def test_a_cavity_closes_to_nothing_and_leaves_no_trace():
    """A column drawn back by 2 bar fills 1 cm^3 again; what flows afterwards is what is delivered."""
    volume, z, history = 1e-6, 1e10, []
    for _ in range(2000):
        p, taken, volume = fill(1e5, z, volume, 0.0)
        history.append((p, taken, volume))
    assert history[0][0] == VAPOUR
    assert history[-1] == (pytest.approx(1e5), pytest.approx(0.0, abs=1e-15), 0.0)
    assert sum(taken for _, taken, _ in history) * H == pytest.approx(-1e-6, rel=1e-12)
