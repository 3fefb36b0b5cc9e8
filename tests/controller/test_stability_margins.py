"""What is left until a loop oscillates: ranges and gains on both sides of their ends; rests that no loop moves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.stability import (
    Plant,
    Timing,
    closed,
    critical_gain,
    derivative_range,
    dominant,
    is_stable,
    linear_actuator,
    margins,
    movable,
    multipliers,
    sampled_loop,
    suggested_gain,
)

PLANT = linear_actuator(0.5, 0.23)
FEW = settings(max_examples=25, deadline=None, derandomize=True)


@given(d=st.floats(0.0, 0.6), tau=st.floats(0.5, 6.0), delay=st.floats(0.0, 2.0), s=st.floats(0.1, 1.5))
@FEW
def test_the_derivative_range_ends_where_stability_does(d: float, tau: float, delay: float, s: float):
    """Stable all through it, not so 1e-6 beyond each end; NaN for a loop that is not stable at its own d."""
    loop = sampled_loop(PLANT, Timing(tau, delay, "backward"))
    low, high = derivative_range(loop, s, d)
    if not is_stable(closed(loop, s, d)):
        assert math.isnan(low)
        assert math.isnan(high)
        return
    assert low <= d <= high
    assert is_stable(closed(loop, s, np.linspace(low + 1e-9, min(high, 50.0) - 1e-9, 50))).all()
    assert high == math.inf or not is_stable(closed(loop, s, high + 1e-6))
    assert low == 0.0 or not is_stable(closed(loop, s, low - 1e-6))


def test_margins_of_one_loop():
    """Of a lag x' = u - x: s_c = coth(tau/2), and at these gains mu = e^-tau - s (1 - e^-tau)."""
    lag = Plant(np.array([[-1.0]]), np.array([1.0]), np.array([1.0]), None)
    found = margins(lag, 0.5, 0.0, Timing(1.0, derivative="backward"))
    assert found.critical is not None
    assert found.stable
    assert found.gain_margin == pytest.approx(2.0 / math.tanh(0.5), rel=1e-12)
    decay = math.exp(-1.0)
    assert abs(found.dominant.multiplier) == pytest.approx(abs(decay - 0.5 * (1.0 - decay)), rel=1e-9)
    bad = margins(lag, 3.0, 0.0, Timing(1.0, derivative="backward"))
    assert (bad.stable, bad.delay_margin, bad.dominant.kind) == (False, 0.0, "flip")
    assert bad.gain_margin < 1.0


def test_the_suggested_gain_bears_every_delay_up_to_a_period():
    """Half the critical gain or less, and the next larger one tried would not do."""
    gain = suggested_gain([PLANT, linear_actuator(0.7, 0.23)], 0.1, Timing(1.0))
    assert 0.0 < gain <= 0.5 * critical_gain(0.1, 0.5, 0.23, Timing(1.0))
    assert margins(PLANT, gain, 0.1, Timing(1.0)).delay_margin >= 1.0
    if gain < 0.499 * critical_gain(0.1, 0.5, 0.23, Timing(1.0)):
        assert margins(PLANT, gain / 0.95, 0.1, Timing(1.0)).delay_margin < 1.0
    assert suggested_gain([PLANT], 10.0, Timing(2.0)) == 0.0


def beside(still: np.ndarray, seed: int, moved: float, shown: float) -> Plant:
    """The actuator beside a block of its own, both mixed by a random rotation, in units far apart."""
    random = np.random.default_rng(seed)
    n, m = 3, len(still)
    mix = 10.0 ** random.uniform(-4.0, 4.0, (n + m, 1)) * np.linalg.qr(random.normal(size=(n + m, n + m)))[0]
    a, b = np.zeros((n + m, n + m)), np.zeros(n + m)
    a[:n, :n], a[n:, n:], b[:n], b[n:] = PLANT.a, still, PLANT.b, moved
    rows = np.zeros((2, n + m))
    rows[0, 0] = rows[1, 1] = 1.0
    rows[0, n:] = shown
    back = np.linalg.inv(mix)
    return Plant(mix @ a @ back, mix @ b, rows[0] @ back, rows[1] @ back)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("moved", "shown"), [(0.0, 0.0), (0.0, 0.7), (0.4, 0.0)])
def test_what_no_loop_moves_is_left_out_and_nothing_else(seed: int, moved: float, shown: float):
    """A further 0: unmoved, unseen or both. The loop keeps the multipliers of the actuator alone."""
    plain = sampled_loop(PLANT, Timing(1.7, 0.6))
    found = movable(beside(np.zeros((1, 1)), seed, moved, shown))
    assert len(found.a) == 3
    mu, expected = (
        np.sort_complex(multipliers(closed(sampled_loop(p, Timing(1.7, 0.6)), 0.8, 0.1))) for p in (found, PLANT)
    )
    np.testing.assert_allclose(mu, expected, atol=1e-8)
    assert dominant(plain, 0.8, 0.1).angle == pytest.approx(
        dominant(sampled_loop(found, Timing(1.7, 0.6)), 0.8, 0.1).angle
    )


def test_what_a_loop_moves_or_what_has_a_rate_of_its_own_stays():
    """A second integrator that is moved and seen; a slow decay and a slow growth that nobody moves."""
    kept = beside(np.zeros((1, 1)), 3, 0.4, 0.7)  # one mode of the two 0 is not moved
    assert len(movable(kept).a) == 3
    for rate in (-1e-3, 1e-3):
        assert len(movable(beside(np.full((1, 1), rate), 3, 0.0, 0.7)).a) == 4
    assert movable(PLANT) is PLANT
    chain = Plant(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.array([0.0, 1.0]))
    assert movable(chain) is chain
