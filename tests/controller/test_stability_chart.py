"""Charts: counted without eigenvalues, compared with them."""

import numpy as np
import pytest

from controller.stability import Timing, linear_actuator, monodromy
from controller.stability.chart import characteristic, count_plant, stable_multipliers, unstable_multipliers

TAU, S = np.linspace(0.0, 20.0, 41)[1:], np.linspace(0.0, 5.0, 31)[1:, None]  # of the axes of Figs 5.8 to 5.19
CHARTS = [(k, 0.0) for k in (0.0, 0.1, 0.5, 1.0, 10.0, 1000.0)] + [(0.0, d) for d in (0.1, 0.5, 1.0, 10.0, 1000.0)]


def inside(matrix: np.ndarray) -> np.ndarray:
    return (np.abs(np.linalg.eigvals(matrix)) < 1.0 - 1e-12).sum(axis=-1)


@pytest.mark.parametrize(("k", "d"), CHARTS)
def test_the_charts_of_the_source(k: float, d: float):
    """Every count of a coarse grid is that of numpy's eigenvalues."""
    counts = stable_multipliers(S, d, k, 0.23, Timing(TAU))
    np.testing.assert_array_equal(counts, inside(monodromy(S, d, k, 0.23, Timing(TAU))))
    assert 0 <= counts.min() < counts.max() <= 3


@pytest.mark.parametrize("derivative", ["measured", "backward", "filtered"])
def test_a_chart_over_the_delay(derivative: str):
    """Delays that round up to different numbers of periods in one chart, each against a matrix of its own size."""
    lag = 0.7 if derivative == "filtered" else None
    delays, s = np.array([0.0, 0.3, 1.0, 1.3, 2.9]), np.linspace(0.1, 4.0, 25)[:, None]
    outside = unstable_multipliers(s, 0.2, 0.5, 0.23, Timing(2.0, delays, derivative, lag))
    for column, delay in enumerate(delays):
        matrix = monodromy(s[:, 0], 0.2, 0.5, 0.23, Timing(2.0, delay, derivative, lag))
        np.testing.assert_array_equal(outside[:, column], matrix.shape[-1] - inside(matrix))


def test_a_multiplier_on_the_circle_is_not_stable():
    """s = 0: the piston stays where it is, mu = 1; with k = d = 0 the oil spring swings for ever beside it."""
    np.testing.assert_array_equal(stable_multipliers(0.0, 0.0, [0.0, 0.5], 0.23, Timing(3.0)), [0, 2])


def test_a_plant_is_counted_as_the_actuator():
    counts = count_plant(linear_actuator(0.5, 0.23), S, 0.1, Timing(TAU, 1.3))
    np.testing.assert_array_equal(counts, stable_multipliers(S, 0.1, 0.5, 0.23, Timing(TAU, 1.3)))


def test_characteristic_polynomial_has_the_eigenvalues_as_roots():
    matrix = np.random.default_rng(58).normal(size=(5, 5))
    np.testing.assert_allclose(characteristic(matrix)[::-1], np.poly(matrix), atol=1e-12)
