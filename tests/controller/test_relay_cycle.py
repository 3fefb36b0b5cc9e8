"""Oscillation of a sampled relay: closed forms of integrators, and the loop itself run with `controller.law`."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from controller.law import RelayGains, Sample, relay
from controller.reference import Target
from controller.stability.actuator.model import TABLE_5_1, dimensionless, omega
from controller.stability.actuator.relay import (
    critical_derivative_time,
    open_actuator,
    relay_edge,
    relay_polynomial,
)
from controller.stability.plant import Plant, linear_actuator, zero_order_hold
from controller.stability.relay_cycle import RelaySwing, dead_time_cycle, opening, relay_cycle
from controller.stability.timing import Timing

INTEGRATOR = Plant(np.zeros((1, 1)), np.array([0.3]), np.array([1.0]), np.zeros(1))  # 0.3 m/s at an open valve


def found(plant: Plant, td: float, timing: Timing, opened: float = 1.0) -> RelaySwing:
    swing = relay_cycle(plant, td, timing, opened)
    assert swing is not None
    return swing


def test_an_integrator_with_a_dead_time_swings_by_a_triangle():
    """Period 4 dead times, peak to peak 2 V times the dead time."""
    cycle = dead_time_cycle(INTEGRATOR, INTEGRATOR.position, 0.03)
    assert cycle is not None
    assert 1.0 / cycle.frequency == pytest.approx(4 * 0.03, rel=1e-6)
    assert cycle.peak_to_peak == pytest.approx(2 * 0.3 * 0.03, rel=1e-6)


@pytest.mark.parametrize("td", [0.0, 0.04])
def test_a_lagged_integrator_turns_where_its_closed_form_does(td: float):
    """x' = v, v' = (V u - v)/c: v goes from -w to w = V tanh(H/2c), and x from -x_H to x_H = V H/2 - w c."""
    c, dead, full = 0.1, 0.05, 1.0
    plant = Plant(np.array([[0.0, 1.0], [0.0, -1.0 / c]]), np.array([0.0, full / c]), np.eye(2)[0], np.eye(2)[1])

    def switching(half: float) -> float:
        w, t = full * math.tanh(half / (2.0 * c)), half - dead
        fading = (full + w) * math.exp(-t / c)
        x = -(full * half / 2.0 - w * c) + full * t - c * (full + w - fading)
        return x + td * (full - fading)

    cycle = dead_time_cycle(plant, np.array([1.0, td]), dead)
    assert cycle is not None
    assert 0.5 / cycle.frequency == pytest.approx(brentq(switching, 1.5 * dead, 20.0 * dead), rel=1e-6)


@pytest.mark.parametrize("delay", [0.0, 1.0, 2.0, 5.0])
def test_sampling_adds_half_a_period_in_the_mean_and_a_whole_one_at_most(delay: float):
    swing = found(INTEGRATOR, 0.0, Timing(0.01, delay))
    for cycle, late in ((swing.middle, delay + 0.5), (swing.slowest, delay + 1.0)):
        assert 1.0 / cycle.frequency == pytest.approx(4 * late * 0.01, rel=1e-6)
        assert cycle.peak_to_peak == pytest.approx(2 * 0.3 * late * 0.01, rel=1e-6)


def run(plant: Plant, td: float, timing: Timing, opened: float) -> tuple[float, float]:
    """Mean frequency and mean peak to peak of the plant under `controller.law.relay`, commands at their instants."""
    tau, delay = float(np.asarray(timing.tau)), float(np.asarray(timing.delay))
    gains = RelayGains(td, timing.derivative, (timing.filter_time or 0.0) * tau, tau, opened)
    whole, share = int(delay), delay - int(delay)
    steps = [zero_order_hold(plant, part * tau / 4) for part in (share, 1.0 - share)]
    memory, given, z, places = None, [0.0] * (whole + 2), np.zeros(len(plant.b)) + 0.1, []
    for i in range(4000):
        v = float(plant.velocity @ z) if plant.velocity is not None else math.nan
        u, memory = relay(Sample(i, float(plant.position @ z), v, 0.0, 0.0, 0.0), Target(0.0, 0.0), memory, gains)
        given.append(u)
        for (power, moved), held in zip(steps, (given[-2 - whole], given[-1 - whole]), strict=True):
            for _ in range(4):
                z = power @ z + moved * held
                places.append(float(plant.position @ z))
    turns = np.flatnonzero(np.diff(np.sign(given[-2000:])) > 0)
    late = np.array(places[-8 * 2000 :])
    swings = [float(np.ptp(late[8 * a : 8 * b])) for a, b in pairwise(turns.tolist())]
    return (len(turns) - 1) / ((turns[-1] - turns[0]) * tau), float(np.mean(swings))


@pytest.mark.parametrize(
    ("td", "timing"),
    [
        (0.0, Timing(0.5, 0.0)),
        (0.5, Timing(0.3, 1.0)),
        (0.5, Timing(0.2, 1.5)),
        (0.5, Timing(0.05, 6.0)),
        (0.3, Timing(0.2, 1.0, "backward")),
        (0.3, Timing(0.1, 2.6, "filtered", 2.0)),
    ],
)
def test_a_run_swings_between_the_ends(td: float, timing: Timing):
    """Finely sampled in the middle, to 6 %; else locked onto whole samples somewhere between, to 2 % of the sizes."""
    plant = linear_actuator(2.0, 0.5)
    frequency, size = run(plant, td, timing, 0.7)
    swing = found(plant, td, timing, 0.7)
    assert 0.98 * swing.slowest.frequency <= frequency <= 1.02 * swing.fastest.frequency
    assert 0.98 * swing.fastest.peak_to_peak <= size <= 1.02 * swing.slowest.peak_to_peak
    if swing.middle.frequency * float(np.asarray(timing.tau)) < 0.02:
        assert swing.middle.frequency == pytest.approx(frequency, rel=0.06)
        assert swing.middle.peak_to_peak == pytest.approx(size, rel=0.06)


def test_the_dead_band_left_in_shrinks_the_swing_and_keeps_its_frequency():
    plant = linear_actuator(2.0, 0.5)
    whole, less = (found(plant, 0.5, Timing(0.4, 1.0), opened).middle for opened in (1.0, opening(1.0, 0.1)))
    assert opening(0.4, 0.1) == pytest.approx(1.0 / 3.0)
    assert less.frequency == whole.frequency
    assert less.peak_to_peak == pytest.approx(whole.peak_to_peak * opening(1.0, 0.1))
    with pytest.raises(ValueError, match="must be above 0"):
        relay_cycle(plant, 0.5, Timing(0.4), opening(0.05, 0.1))


@pytest.mark.parametrize("friction", [0.0, 800.0])
def test_the_critical_derivative_in_si_is_that_of_the_dimensionless_relay(friction: float):
    """d_H/(s omega): with d = D L omega and s = P L, the derivative time D/P."""
    drive = TABLE_5_1._replace(friction=friction)
    actuator = dimensionless(drive)
    dimensionless_edge = float(relay_edge(1.0, actuator.k, actuator.gamma, actuator.alpha))
    assert critical_derivative_time(drive) == pytest.approx(dimensionless_edge / omega(drive), rel=1e-12)


def test_the_open_actuator_has_the_polynomial_of_the_smoothed_relay():
    actuator = dimensionless(TABLE_5_1._replace(friction=500.0))
    plant, (s, d, eps) = open_actuator(actuator), (3.0, 0.7, 0.2)
    closed = plant.a - np.outer(plant.b, np.array([s, d, 0.0])) / eps
    assert np.poly(closed) == pytest.approx(relay_polynomial(s, d, actuator.k, actuator.gamma, actuator.alpha, eps))


def test_above_its_critical_derivative_the_relay_swings_by_its_dead_time_alone():
    """(5.22) has no dead time: there the swing vanishes with it; below, a swing is left that no dead time makes."""
    actuator = dimensionless(TABLE_5_1)
    plant, edge = open_actuator(actuator), critical_derivative_time(TABLE_5_1) * omega(TABLE_5_1)
    sizes = {
        factor: [found(plant, factor * edge, Timing(late)).middle.peak_to_peak for late in (0.02, 0.01)]
        for factor in (0.5, 2.0)
    }
    assert sizes[2.0][1] < 0.6 * sizes[2.0][0]
    assert sizes[0.5][1] > 0.9 * sizes[0.5][0]
