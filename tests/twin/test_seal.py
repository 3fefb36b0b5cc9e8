"""Seal friction: the law, exact rest, loss of energy, and the order of the step."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR, FRICTIONLESS, circuit, seal_of
from twin.integration import integrate
from twin.seal import friction, friction_limit, slide

SEAL = seal_of(circuit(seal={"diameter": 82e-3, "downward": 1.0}))  # a seal each on piston and rod, alike both ways
STEP = 25e-6
SPEED = st.floats(-1.0, 1.0)


@pytest.mark.parametrize("z", [1e-7, 1e-6, 1e-5, 1e-4])
def test_friction_is_the_power_law(z: float):
    """F = 3.819e-6 z^-0.5373 p_w b pi (D + d), z = mu v/(p_w b), at 25 bar, b = 10 mm."""
    load = 25 * BAR * 0.01
    speed = z * load / SEAL.viscosity
    expected = 3.819e-6 * z**-0.5373 * load * math.pi * 0.082
    assert friction(speed, 25 * BAR, SEAL)[0] == pytest.approx(expected, rel=1e-12)
    assert friction(-speed, 25 * BAR, SEAL)[0] == pytest.approx(expected, rel=1e-12)


def test_limit_is_a_quarter_of_the_sealing_force_and_met_without_a_jump():
    """0.25 p_w b pi (D + d): 1610 N at 25 bar, up to z = (0.25/alpha)^(1/beta)."""
    most = 0.25 * 25 * BAR * 0.01 * math.pi * 0.082
    assert friction_limit(1.0, 25 * BAR, SEAL) == pytest.approx(most, rel=1e-12)
    edge = (0.25 / 3.819e-6) ** (1.0 / -0.5373) * 25 * BAR * 0.01 / SEAL.viscosity
    assert friction(0.999 * edge, 25 * BAR, SEAL) == (pytest.approx(most, rel=1e-12), 0.0)
    assert friction(1.001 * edge, 25 * BAR, SEAL)[0] == pytest.approx(most * 1.001**-0.5373, rel=1e-9)


def test_slope_is_the_derivative_of_the_friction():
    above, below = (friction(0.1 * (1.0 + e), 25 * BAR, SEAL)[0] for e in (1e-5, -1e-5))
    assert friction(0.1, 25 * BAR, SEAL)[1] == pytest.approx((above - below) / 2e-6, rel=1e-6)


@pytest.mark.parametrize("downward", [0.7, 1.3])
def test_friction_downwards_is_a_share_of_that_upwards(downward: float):
    """At every speed, at the limit, and for what starts to move: m dv/dt = drive - F."""
    seal = SEAL._replace(downward=downward)
    for speed in (1e-6, 1e-3, 0.1):
        up, down = (friction(v, 25 * BAR, seal) for v in (speed, -speed))
        assert up == friction(speed, 25 * BAR, SEAL)
        assert down == pytest.approx([downward * value for value in up], rel=1e-12)
    drive = -friction_limit(-1.0, 25 * BAR, seal)
    assert drive == pytest.approx(-downward * friction_limit(1.0, 25 * BAR, seal), rel=1e-12)
    assert slide(0.0, 0.999 * drive, 120.0, 25 * BAR, seal, STEP) == 0.0
    assert slide(0.0, drive - 240.0, 120.0, 25 * BAR, seal, STEP) == pytest.approx(-STEP * 2.0, rel=1e-9)


@given(st.floats(-1.0, 1.0), st.floats(1.0, 400.0))
def test_inside_the_limit_a_mass_at_rest_stays_exactly_at_rest(share: float, bar: float):
    assert slide(0.0, share * 0.999999 * friction_limit(share, bar * BAR, SEAL), 120.0, bar * BAR, SEAL, STEP) == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_beyond_the_limit_the_excess_accelerates(sign: float):
    drive = sign * (friction_limit(sign, 25 * BAR, SEAL) + 240.0)
    assert slide(0.0, drive, 120.0, 25 * BAR, SEAL, STEP) == pytest.approx(sign * STEP * 2.0, rel=1e-9)


@given(SPEED, st.floats(0.1, 400.0), st.floats(30.0, 400.0))
def test_friction_alone_dissipates_and_never_turns_the_motion_round(speed: float, bar: float, mass: float):
    then = slide(speed, 0.0, mass, bar * BAR, SEAL, STEP)
    assert 0.0 <= then * math.copysign(1.0, speed) <= abs(speed)


@given(SPEED, st.floats(-5e3, 5e3))
def test_without_friction_it_is_newtons_law(speed: float, drive: float):
    off = seal_of(circuit(seal=FRICTIONLESS))
    assert slide(speed, drive, 120.0, 25 * BAR, off, STEP) == speed + STEP * drive / 120.0


def test_sliding_is_of_second_order():
    """600 N against the friction at 25 bar from 0.02 m/s, 20 ms, against scipy."""
    exact = integrate(
        lambda _, v: [(600.0 - friction(v[0], 25 * BAR, SEAL)[0]) / 120.0],
        (0.0, 0.02), [0.02], "DOP853", most=20_000, rtol=1e-12, atol=1e-15,
    ).y[0, -1]  # fmt: skip

    def error(steps: int) -> float:
        v = 0.02
        for _ in range(steps):
            v = slide(v, 600.0, 120.0, 25 * BAR, SEAL, 0.02 / steps)
        return abs(v - exact)

    assert math.log2(error(20) / error(40)) == pytest.approx(2.0, abs=0.1)


def test_a_sliding_mass_stops_for_good_when_and_where_the_plateau_says():
    """Slower than the plateau's edge friction is constant: v0 m/(F - drive) to rest."""
    v, t, drive = 2e-4, 0.0, 1000.0
    while v != 0.0:
        v = slide(v, drive, 120.0, 25 * BAR, SEAL, 1e-7)
        t += 1e-7
        assert t < 0.01
    assert t == pytest.approx(2e-4 * 120.0 / (friction_limit(1.0, 25 * BAR, SEAL) - drive), abs=2e-7)
