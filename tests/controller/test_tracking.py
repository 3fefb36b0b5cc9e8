"""Lag and amplitude ratio of a run that follows: closed forms of a first-order lag, a delay, a ramp."""

import math

import numpy as np
import pytest

from controller.tracking import tracking

TIME = np.arange(20_000) * 1e-3
MOVES = TIME >= 1.0


def sine(frequency: float, lag: float = 0.0, ratio: float = 1.0) -> np.ndarray:
    """0.1 m, from 1 s on 20 mm about it."""
    return 0.1 + 0.02 * ratio * np.where(MOVES, np.sin(2 * np.pi * frequency * (TIME - 1.0) - lag), 0.0)


@pytest.mark.parametrize("frequency", [0.25, 1.0, 7.3])
@pytest.mark.parametrize(("lag", "ratio"), [(0.0, 1.0), (0.7, 0.5), (2.0, 0.9), (-0.2, 1.1)])
def test_a_sine_of_known_lag_and_ratio(frequency: float, lag: float, ratio: float):
    found = tracking(TIME, sine(frequency), sine(frequency, lag, ratio) + 3e-3 + 1e-4 * TIME, frequency)
    assert found.phase_lag == pytest.approx(lag, abs=1e-6)
    assert found.time_lag == pytest.approx(lag / (2 * np.pi * frequency), abs=1e-6)
    assert found.amplitude_ratio == pytest.approx(ratio, rel=1e-6)


def test_a_first_order_lag_after_its_transient():
    """1/(1 + i w tau) from rest: the transient exp(-t/tau) is over in the first third."""
    tau, omega = 0.1, 2 * np.pi * 0.5
    x, y = TIME - 1.0, np.zeros(TIME.size)
    response = 1.0 / (1.0 + 1j * omega * tau)
    y[MOVES] = (np.imag(response * np.exp(1j * omega * x)) + omega * tau * abs(response) ** 2 * np.exp(-x / tau))[MOVES]
    found = tracking(TIME, sine(0.5), 0.1 + 0.02 * y, 0.5)
    assert found.phase_lag == pytest.approx(math.atan(omega * tau), abs=1e-6)
    assert found.amplitude_ratio == pytest.approx(abs(response), rel=1e-6)


def test_a_ramp_followed_with_a_constant_error_lags_by_error_over_speed():
    ramp = np.clip(0.1 + 0.01 * (TIME - 1.0), 0.1, 0.2)
    behind = np.interp(TIME - 0.05, TIME, ramp)
    found = tracking(TIME, ramp, behind)
    assert found.time_lag == pytest.approx(0.05, rel=1e-3)
    assert math.isnan(found.phase_lag)
    assert math.isnan(found.amplitude_ratio)


@pytest.mark.parametrize("reference", [np.repeat([0.1, 0.2], 10_000), np.full(20_000, 0.1), np.full(20_000, np.nan)])
def test_steps_and_holds_are_not_tracked(reference: np.ndarray):
    assert all(map(math.isnan, tracking(TIME, reference, np.zeros(TIME.size))))


def test_two_periods_suffice():
    assert tracking(TIME[:3001], sine(1.0)[:3001], sine(1.0, 0.3)[:3001], 1.0).phase_lag == pytest.approx(0.3, abs=1e-6)


def test_less_than_two_periods_are_not_measured():
    assert all(map(math.isnan, tracking(TIME[:2500], sine(1.0)[:2500], sine(1.0)[:2500], 1.0)))
