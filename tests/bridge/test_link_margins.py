"""Margins of the linear loop against delay, loss and jitter, each by another way."""

import math

import numpy as np
import pytest

from bridge.scenario import load
from bridge.scenario.gains import gains
from bridge.studies.stability.link_margins import (
    LinearLoop,
    delay_edge,
    exponent,
    growth,
    loops_of,
    loss_edge,
    matrices,
)
from bridge.studies.stability.rig_loop import margins_of, timing_of
from controller.stability import linear_actuator
from controller.stability.amplitude.linear_law import pd_law

SCENARIO = load("step", ["controller.derivative=0.01 V s/%", "controller.velocity=filtered"])
PID = load("pid")


def loop(delay: float, gain: float = 0.3) -> LinearLoop:
    """A small one: the dimensionless actuator under a PD."""
    law = pd_law(gain, 0.1, "measured", 0.0, 1.0, 1.0, 0.0)
    return LinearLoop("rest", linear_actuator(0.1, 1.0), law, 1.0, delay)


def test_the_delay_edge_is_that_of_the_margins():
    own = gains(SCENARIO)
    for found in loops_of(SCENARIO):
        known = margins_of(found.plant, timing_of(SCENARIO), own.proportional, own.derivative).delay_margin
        assert delay_edge(found) == pytest.approx(SCENARIO.loop.delay + known * found.period, rel=1e-3)


def test_a_pid_has_less_margin_than_its_pd():
    """Its integral turns the phase back, at every point."""
    without = load("pid", ["controller.integral=0"])
    for own, other in zip(loops_of(PID), loops_of(without), strict=True):
        assert 0.0 < delay_edge(own) < delay_edge(other)


def test_the_growth_of_the_second_moment_is_the_radius_of_the_kronecker_form():
    came, lost = matrices(loop(0.4), 0.4)
    for share in (0.0, 0.2, 0.6):
        whole = (1.0 - share) * np.kron(came, came) + share * np.kron(lost, lost)
        assert growth(came, lost, share) == pytest.approx(math.log(np.abs(np.linalg.eigvals(whole)).max()), abs=2e-3)


def test_a_lost_command_leaves_the_one_before_in_force():
    """Two lost in a row: the input that the plant sees is the same over both periods."""
    own = loop(0.4)
    _, lost = matrices(own, 0.4)
    state = np.append(np.zeros(len(lost) - 1), 1.0)
    assert (lost @ lost @ state)[-1] == (lost @ state)[-1] == 1.0


def test_without_jitter_the_exponent_is_that_of_the_largest_multiplier():
    for delay in (0.5, 1.25):
        own = loop(delay)
        known = math.log(np.abs(np.linalg.eigvals(matrices(own, delay)[0])).max())
        assert exponent(own, 0.0) == pytest.approx(known, abs=2e-3)


def test_a_loop_tolerates_less_loss_at_a_higher_gain():
    low, high = (loss_edge(loops_of(load("step", [f"controller.gain={gain}"]))[-1]) for gain in (1, 2))
    assert 0.0 < high < low


def test_a_law_that_is_not_linear_has_no_edge():
    assert loops_of(load("relay")) == []
