"""The neck of a chamber: its laws hold in each direction, whatever is open, and it never gives energy."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR
from twin.neck import Neck, Side, neck_flow, plain_side, side_flow
from twin.oil import Oil
from twin.orifice import quadratic_flow
from twin.port import Port, passage, pressure

OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
A = st.floats(1e11, 1e16) | st.just(math.inf)
B = st.floats(1e7, 1e11)
SIDE = st.builds(Side, st.floats(0.0, 10 * BAR), A, B, A, B, st.floats(0.0, 1e14), st.floats(0.0, 1e10))
PORT = st.builds(Port, st.floats(-50 * BAR, 300 * BAR), st.floats(1e8, 1e11))


def drop_of(q: float, side: Side) -> float:
    """Drop [Pa] at a flow [m^3/s] > 0, by bisection of the two ways' drop."""
    low, high = 0.0, 1e12
    for _ in range(200):
        d = 0.5 * (low + high)
        ways = quadratic_flow(d, side.a_beside, side.b_beside)
        ways += quadratic_flow(max(0.0, d - side.offset), side.a, side.b)
        low, high = (d, high) if ways < q else (low, d)
    return low + (side.a_after * q + side.b_after) * q


@given(st.builds(Neck, SIDE, SIDE), PORT, PORT)
def test_the_flow_obeys_the_law_of_its_side(neck, line, chamber):
    """What the ports leave between them is what the neck takes, to 1e-9; a neck without flow has less than it needs."""
    q = neck_flow(line, chamber, neck, OIL)
    left = pressure(line, -q, OIL.vapour_pressure) - pressure(chamber, q, OIL.vapour_pressure)
    side = neck.into if left > 0.0 else neck.out
    if q != 0.0:
        assert drop_of(abs(q), side) == pytest.approx(abs(left), rel=1e-9, abs=1e-3)
    else:
        assert abs(left) <= (side.offset if side.a_beside == math.inf else 0.0) or side.a == side.a_beside == math.inf


@given(st.builds(Neck, SIDE, SIDE), PORT, PORT)
def test_a_neck_takes_energy_and_never_gives_any(neck, line, chamber):
    q = neck_flow(line, chamber, neck, OIL)
    drop = pressure(line, -q, OIL.vapour_pressure) - pressure(chamber, q, OIL.vapour_pressure)
    assert q * drop >= 0.0


@given(PORT, PORT, st.floats(1e11, 1e16), B)
def test_one_plain_way_is_the_passage_between_two_ports(line, chamber, a, b):
    neck = Neck(plain_side(a, b), plain_side(a, b))
    assert neck_flow(line, chamber, neck, OIL) == pytest.approx(
        passage(line, chamber, a, b, OIL.vapour_pressure), rel=1e-12
    )


def test_a_check_valve_passes_nothing_below_its_cracking_pressure():
    """1 bar: 0.99 bar leave it shut, 2 bar drive a flow by the bar that is left."""
    side = Side(1 * BAR, 1e13, 1e8, math.inf, 0.0, 0.0, 0.0)
    assert side_flow(0.99 * BAR, 0.0, side) == 0.0
    assert side_flow(2.0 * BAR, 0.0, side) == quadratic_flow(1.0 * BAR, 1e13, 1e8)
