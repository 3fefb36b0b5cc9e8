"""Chambers of every actuator: oil kept, leaks that are counted, power that is not lost, walls that give way."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.actuator import (
    DrainedCylinder,
    areas,
    chamber_cavities,
    chamber_pressures,
    drive,
    fill_chambers,
    passed,
    stored_oil,
    volumes,
)
from twin.cylinder import Chambers, Cylinder
from twin.kernel import interpreted
from twin.motor import Motor
from twin.port import Port

B, VAPOUR, H = 1.3e9, -1e5, 50e-6
DRAINED = DrainedCylinder(1.2e-3, 2e-3, 1e-4, 1e-4, 0.27, 1e-13, 2e-12, 3e-12, 1.1e9, 1.2e9, VAPOUR)
PLAIN = Cylinder(1.2e-3, 2e-3, 1e-4, 1e-4, 0.27, 1e-13, B, VAPOUR)
WAVY = Motor(5e-6, 5e-6, 1e-4, 1e-4, 1000.0, 1e-13, 2e-12, 3e-12, B, VAPOUR, 0.1, 9.0)
SHUT = Port(0.0, 1e30)
PRESSURE = st.floats(-1e5, 400e5)


@pytest.mark.parametrize("kind", [PLAIN, DRAINED, WAVY])
@given(lower=PRESSURE, upper=PRESSURE, place=st.floats(0.0, 0.27))
def test_the_oil_that_makes_a_pressure_has_it(kind, lower: float, upper: float, place: float):
    p = Chambers(lower, upper)
    stored = stored_oil(p, place, kind)
    assert chamber_pressures(stored, place, kind) == pytest.approx(p, abs=1e-3)
    assert chamber_cavities(stored, place, kind) == pytest.approx((0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize("kind", [PLAIN, DRAINED, WAVY])
@given(st.tuples(PRESSURE, PRESSURE), st.tuples(PRESSURE, PRESSURE), st.floats(0.0, 0.26), st.floats(-5e-4, 5e-4))
def test_every_drop_is_stored_delivered_or_counted_as_lost(kind, p, free, place: float, travelled: float):
    """Lines of 1e10 Pa s/m^3; oil never appears, whatever the pressures, cavities or travel."""
    before, p, z = stored_oil(Chambers(*p), place, kind), Chambers(*p), 1e10
    lower, upper, inflow = Port(free[0], z), Port(free[1], z), Chambers(1e-5, -2e-5)
    then, after, lost = fill_chambers(before, p, inflow, lower, upper, max(0.0, place + travelled), kind, H)
    came = 0.5 * H * (sum(inflow) + (free[0] - after.lower) / z + (free[1] - after.upper) / z)
    assert sum(then) - sum(before) == pytest.approx(came - lost, abs=1e-17)
    assert min(after) >= VAPOUR
    assert after == pytest.approx(chamber_pressures(then, max(0.0, place + travelled), kind), abs=1.0)


def test_a_cylinder_without_leaks_to_the_outside_loses_nothing():
    _, _, lost = fill_chambers(
        stored_oil(Chambers(2e7, 1e7), 0.1, PLAIN), Chambers(2e7, 1e7), Chambers(0.0, 0.0), SHUT, SHUT, 0.1, PLAIN, H
    )
    assert lost == 0.0


@pytest.mark.parametrize("kind", [DRAINED, WAVY])
def test_shut_chambers_empty_through_their_leaks_as_an_exponential(kind):
    """p_l = p_u: no flow across; p = p_0 exp(-o B t/V) in each, and what is lost is what was compressed."""
    kind = kind._replace(outside_upper=kind.outside_lower, leakage=0.0)
    p = Chambers(1e7, 1e7)
    stored, total = stored_oil(p, 0.1, kind), 0.0
    for _ in range(200):
        stored, p, lost = fill_chambers(stored, p, Chambers(0.0, 0.0), SHUT, SHUT, 0.1, kind, 2.5e-4)
        total += lost
    volume, modulus = volumes(kind, 0.1), getattr(kind, "modulus_lower", B)
    assert p.lower == pytest.approx(1e7 * math.exp(-0.05 * 2e-12 * modulus / volume.lower), rel=1e-5)
    assert total == pytest.approx(sum(stored_oil(Chambers(1e7, 1e7), 0.1, kind)) - sum(stored), rel=1e-9)


def test_what_a_motor_passes_is_the_integral_of_its_torque_per_pressure():
    """Simpson's rule over 1.3 turns, ripple of 10 %, 9 waves: flow and torque are one function of the angle."""
    count, end = 400, 1.3 * 2.0 * math.pi
    weights = [1.0, *[4.0, 2.0] * (count // 2 - 1), 4.0, 1.0]
    through = (
        sum(w * interpreted(areas)(WAVY, i * end / count).lower for i, w in enumerate(weights)) * end / count / 3.0
    )
    assert interpreted(passed)(WAVY, end).lower == pytest.approx(through, rel=1e-7)
    assert interpreted(passed)(WAVY, end).upper == -interpreted(passed)(WAVY, end).lower


def test_a_motor_with_shut_ports_is_a_spring_that_gives_back_what_it_took():
    """Turned 0.2 rad away and back in leapfrog steps: the work of its torque on the way sums up to nothing."""
    tight = WAVY._replace(leakage=0.0, outside_lower=0.0, outside_upper=0.0)
    p, work, x = Chambers(1e7, 1e7), 0.0, 0.0
    stored, most = stored_oil(p, x, tight), 0.0
    for number in range(2000):
        v = 0.2 * math.pi / 0.1 * math.sin(2.0 * math.pi * (number + 0.5) / 2000)
        work += 0.5 * H * v * drive(p, x, tight)
        x += H * v
        stored, p, _ = fill_chambers(stored, p, Chambers(0.0, 0.0), SHUT, SHUT, x, tight, H)
        work += 0.5 * H * v * drive(p, x, tight)
        most = max(most, abs(work))
    assert most > 1e-4
    assert abs(work) < 1e-5 * most
