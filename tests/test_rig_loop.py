"""The matrix of the sampled loop, its critical gains and its charts, on the dimensionless actuator."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from bridge.stability.chart import Plainly, actuator, chart
from bridge.stability.loop import Timing, multipliers, sampled, stable
from bridge.stability.margins import critical_gain as theory_gain
from bridge.stability.margins import derivative_range

SQRT2 = math.sqrt(2.0)


@pytest.mark.parametrize("tau", [0.7, 2.0, 3.0, 4.0])
def test_flip_of_the_frictionless_actuator_is_the_closed_form(tau):
    """mu = -1 at s = 4 cos(tau/sqrt2)/(sqrt2 gamma (tau cos(tau/sqrt2) - sqrt2 sin(tau/sqrt2))), k = d = 0."""
    w, gamma = tau / SQRT2, 0.23
    s = 4.0 * math.cos(w) / (SQRT2 * gamma * (tau * math.cos(w) - SQRT2 * math.sin(w)))
    found = multipliers(sampled(actuator(0.0, gamma), Timing(tau, 0.0, "measured", 0.0)), s, 0.0)
    assert np.abs(found + 1.0).min() < 1e-12 * max(1.0, abs(s))


@pytest.mark.parametrize("derivative", ["measured", "backward", "filtered"])
@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 2.3])
def test_the_matrix_is_the_loop_integrated_step_by_step(derivative, delay):
    """Ten samples of the law and the plant's equations by expm, held and late, against powers of M."""
    plant, period, lag, p, d = actuator(0.1, 0.23), 1.7, 2.0, 0.8, 0.3
    loop = sampled(plant, Timing(period, delay * period, derivative, lag))
    matrix = loop.free + loop.entry @ (p * loop.by_gain + d * loop.by_derivative)
    x, z = np.array([1.0, 0.2, -0.1]), np.zeros(len(matrix))
    z[:3] = x
    kept, last, velocity, commands = math.exp(-period / lag) if derivative == "filtered" else 0.0, 0.0, 0.0, {}
    whole, share = divmod(delay, 1.0)
    for i in range(10):
        difference = (x[0] - last) / period
        velocity = x[1] if derivative == "measured" else kept * velocity + (1.0 - kept) * difference
        commands[i], last = -(p * x[0] + d * velocity), x[0]
        for time, command in ((share, i - whole - 1), (1.0 - share, i - whole)):
            u = np.array([commands.get(int(command), 0.0)])
            both = expm(np.block([[plant.a, plant.b], [np.zeros((1, 4))]]) * time * period)
            x = both[:3, :3] @ x + both[:3, 3:] @ u
        z = matrix @ z
        assert z[:3] == pytest.approx(x, abs=1e-12)


def test_slow_limit_of_sampling_is_the_analogue_edge():
    """tau -> 0: k (d + sqrt2/gamma), and d = 0.5 at tau 3, s 0.5 destabilises a stable loop."""
    loop = sampled(actuator(0.1, 0.23), Timing(1e-3, 0.0, "measured", 0.0))
    assert theory_gain(loop, 0.0).gain == pytest.approx(0.1 * SQRT2 / 0.23, rel=2e-2)
    loop = sampled(actuator(0.0, 0.23), Timing(3.0, 0.0, "measured", 0.0))
    assert stable(loop, 0.5, 0.0)
    assert not stable(loop, 0.5, 0.5)
    assert derivative_range(loop, 0.5, 0.0)[1] < 0.5


def test_counts_of_a_chart_agree_with_multipliers_one_by_one():
    family = Plainly({"damping": 0.1})
    x, y = np.linspace(0.5, 9.0, 4), np.linspace(0.1, 4.0, 5)
    for across, up in (("period", "gain"), ("gain", "period"), ("delay", "damping")):
        drawn = chart(family, across, up, x, y)
        for i, j in ((0, 0), (4, 3), (2, 1)):
            at = {**family.numbers, across: float(x[j]), up: float(y[i])}
            found = multipliers(family.loop(at), at["gain"], at["derivative"])
            assert drawn.outside[i, j] == np.sum(np.abs(found) > 1.0 + 1e-7)
