"""Spool: the exact second-order answer, the two limits, and the lands."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import circuit, valve_of
from twin.spool_valve import move_spool, opening

H = 50e-6
VALVE = valve_of(circuit(H))
UNIT = st.floats(-1.0, 1.0)


def move(reference: float, seconds: float, start: float = 0.0) -> list[tuple[float, float]]:
    s, rate, found = start, 0.0, []
    for _ in range(round(seconds / H)):
        s, rate = move_spool(s, rate, reference, VALVE, H)
        found.append((s, rate))
    return found


@pytest.mark.parametrize("ms", [1, 5, 20, 50])
def test_small_step_is_exact(ms: int):
    """0.2 at 30 Hz, damping 0.8: 1 - e^(-zeta omega t)(cos omega_d t + zeta omega/omega_d sin omega_d t)."""
    omega, zeta, t = 2.0 * math.pi * 30.0, 0.8, ms * 1e-3
    damped = omega * math.sqrt(1.0 - zeta**2)
    wave = math.cos(damped * t) + zeta * omega / damped * math.sin(damped * t)
    s, rate = move(0.2, t)[-1]
    assert s == pytest.approx(0.2 * (1.0 - math.exp(-zeta * omega * t) * wave), rel=1e-10)
    expected = 0.2 * omega**2 / damped * math.exp(-zeta * omega * t) * math.sin(damped * t)
    assert rate == pytest.approx(expected, rel=1e-9)


def test_large_step_keeps_the_rate_limit():
    """-1 to 1: never faster than 50 travels a second, and that fast for most of the way."""
    moved = move(1.0, 0.06, start=-1.0)
    track = [-1.0, *(s for s, _ in moved)]
    rates = [(b - a) / H for a, b in pairwise(track)]
    assert max(rate for _, rate in moved) == 50.0
    assert max(rates) == pytest.approx(50.0, rel=1e-9)
    assert sum(rate > 49.999 for rate in rates) * H > 0.02


@given(UNIT, st.floats(-50.0, 50.0), UNIT)
def test_travel_ends_at_one_and_the_spool_rests_there(s: float, rate: float, reference: float):
    there, then = move_spool(s, rate, reference, VALVE, 5e-3)
    assert abs(there) <= 1.0
    assert abs(there) < 1.0 or then * there <= 0.0


def test_full_reference_is_reached_and_left():
    assert move(1.0, 0.3)[-1] == (pytest.approx(1.0, abs=1e-6), pytest.approx(0.0, abs=1e-4))
    assert move(0.0, 0.3, start=1.0)[-1] == (pytest.approx(0.0, abs=1e-9), pytest.approx(0.0, abs=1e-7))


@pytest.mark.parametrize(("spool", "share"), [(-1.0, 0.0), (0.0, 0.0), (0.1, 0.0), (0.55, 0.5), (1.0, 1.0)])
def test_lands_open_beyond_the_overlap_to_their_full_area(spool: float, share: float):
    assert opening(spool, VALVE) == pytest.approx(share * VALVE.area, rel=1e-12)
