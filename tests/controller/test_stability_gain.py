"""Critical gains against a scan of eigenvalues over the gain: random loops of every kind, and sampling at resonance."""

import math

import numpy as np
import pytest

from controller.stability import Timing, critical_gain, monodromy

DELAYS = (0.0, 0.23, 1.0, 2.7, 3.0)
KINDS = (("measured", None), ("backward", None), ("filtered", 0.3), ("filtered", 5.0))


def largest(s: np.ndarray, *loop) -> np.ndarray:
    return np.abs(np.linalg.eigvals(monodromy(s, *loop))).max(axis=-1)


def random_loop(seed: int) -> tuple:
    random = np.random.default_rng([59, seed])
    d, k = (0.0 if random.random() < 0.3 else 10.0 ** random.uniform(-2.0, 1.0) for _ in range(2))
    tau, gamma = random.uniform(0.05, 12.0), 10.0 ** random.uniform(-1.5, 0.3)
    return d, k, gamma, Timing(tau, DELAYS[seed % 5], *KINDS[seed % 4])


@pytest.mark.parametrize("seed", range(100))
def test_the_first_loss_is_where_a_scan_finds_it(seed: int):
    """Stable at 500 gains below, on the circle there, outside just above; or outside at the smallest gains."""
    loop = random_loop(seed)
    edge = critical_gain(*loop)
    assert isinstance(edge, float)
    if edge == 0.0:
        assert (largest(np.geomspace(1e-6, 1e-4, 20), *loop) > 1.0).all()
        return
    below = np.concatenate(
        [np.geomspace(1e-5, edge, 250, endpoint=False), np.linspace(1e-5, edge, 250, endpoint=False)]
    )
    assert (largest(below, *loop) < 1.0).all()
    assert largest(np.array([edge]), *loop)[0] == pytest.approx(1.0, abs=1e-7)
    assert (largest(edge * (1.0 + np.array([1e-6, 1e-4, 1e-3])), *loop) > 1.0).all()


@pytest.mark.parametrize("delay", DELAYS)
@pytest.mark.parametrize(("derivative", "lag"), KINDS)
def test_sampling_at_whole_periods_of_the_oil_spring_is_never_stable(derivative: str, lag: float | None, delay: float):
    """k = 0, sqrt2 tau = 2 pi N: nobody sees the spring swing, mu = 1 at any gain. With friction it dies by itself."""
    for n in (1, 2, 3):
        tau = math.sqrt(2.0) * math.pi * n
        for d in (0.0, 0.5):
            assert critical_gain(d, 0.0, 0.23, Timing(tau, delay, derivative, lag)) == 0.0
    assert critical_gain(0.0, 0.5, 0.23, Timing(math.sqrt(2.0) * math.pi, delay, derivative, lag)) > 0.0
