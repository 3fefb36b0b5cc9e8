"""The loop without sampling: analogue and relay edges, the kink at u = 0, the slow manifold, each by its full model."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from controller.stability import Timing, linear_actuator, sampled_loop
from controller.stability.actuator.analogue import (
    analogue_edge,
    analogue_frequency,
    analogue_polynomial,
    flow_slope,
    one_sided_jacobians,
)
from controller.stability.actuator.relay import relay_edge, relay_frequency, relay_polynomial
from controller.stability.actuator.slow_fast import (
    critical_manifold,
    full_rates,
    layer_rates,
    reduced_rates,
    slides,
)
from controller.stability.curves import pair_gains
from controller.stability.sampled import closed
from twin.integration import integrate

SQRT2 = math.sqrt(2.0)
ALPHA, K, GAMMA = 0.01, 0.5, 0.5  # of Figs 5.4 and 5.5


def slopes(rates, y: np.ndarray, side: float = 0.0, step: float = 1e-6) -> np.ndarray:
    """Jacobian by central differences, or by second order one-sided ones."""
    columns = []
    for unit in np.eye(len(y)):
        if side:
            h = side * step * unit
            columns.append((4.0 * rates(y + h) - 3.0 * rates(y) - rates(y + 2.0 * h)) / (2.0 * side * step))
        else:
            columns.append((rates(y + step * unit) - rates(y - step * unit)) / (2.0 * step))
    return np.array(columns).T


def closed_rates(s: float, d: float, command=lambda h: -h):
    """The whole actuator under u = command(s y1 + d y2)."""
    return lambda y: full_rates(y, command(s * y[0] + d * y[1]), K, GAMMA, ALPHA)


def swing(s: float, d: float, size: float, periods: int = 60) -> float:
    """Logarithm of growth of a small swing of the whole model about p_e = 1/2, second quarter of a run to last."""
    start = [size, 0.0, 0.5, 0.5]
    end = periods * 2.0 * math.pi / float(analogue_frequency(d, GAMMA))
    times = np.linspace(0.0, end, 40 * periods)
    rates = closed_rates(s, d)
    limits = {"t_eval": times, "rtol": 1e-9, "atol": 1e-9 * size}
    y = integrate(lambda _t, y: rates(y), (0.0, end), start, "DOP853", most=200_000, **limits).y[0]
    quarter = len(y) // 4
    return math.log(np.abs(y[-quarter:]).max() / np.abs(y[quarter : 2 * quarter]).max())


def test_analogue_edge_of_the_source():
    """Fig. 5.5: alpha 0.01, k 0.5, gamma 0.5, d 0.1."""
    assert float(analogue_edge(0.1, K, GAMMA)) == pytest.approx(1.4642, abs=5e-5)
    assert float(analogue_frequency(0.1, GAMMA)) == pytest.approx(1.4390, abs=5e-5)
    assert float(analogue_edge(0.0, 1.0, 0.23)) == pytest.approx(6.149, abs=5e-4)


@pytest.mark.parametrize("rest", [0.5, 0.2, 0.0039])
@pytest.mark.parametrize("d", [0.0, 0.1, 2.0])
def test_analogue_polynomial_has_its_pair_on_the_axis_at_the_edge(d: float, rest: float):
    edge = analogue_edge(d, K, GAMMA, rest)
    omega = float(analogue_frequency(d, GAMMA, rest))
    roots = np.roots(analogue_polynomial(edge, d, K, GAMMA, rest))
    assert np.abs(roots - 1j * omega).min() < 1e-12
    assert np.roots(analogue_polynomial(0.99 * edge, d, K, GAMMA, rest)).real.max() < 0.0
    assert np.roots(analogue_polynomial(1.01 * edge, d, K, GAMMA, rest)).real.max() > 0.0
    assert edge >= analogue_edge(d, K, GAMMA)  # equal pressures of 1/2 go first


def test_the_whole_model_loses_stability_at_the_analogue_edge():
    """2 % on both sides. Swings of 1e-6 move the pressures by 1e-4 of the supply: the valve is straight to that."""
    edge = float(analogue_edge(0.1, K, GAMMA))
    assert swing(0.98 * edge, 0.1, 1e-6) < -0.5
    assert swing(1.02 * edge, 0.1, 1e-6) > 0.5


@pytest.mark.parametrize("rest", [0.5, 0.3])
def test_one_sided_jacobians_are_those_of_the_field(rest: float):
    """One-sided differences of the whole model along each state, on the side where u > 0 and where u < 0."""
    s, d = 1.3, 0.1
    for jacobian, side in zip(one_sided_jacobians(s, d, K, GAMMA, ALPHA, rest), (-1.0, 1.0), strict=True):
        found = slopes(closed_rates(s, d), np.array([0.0, 0.0, rest, rest]), side)
        np.testing.assert_allclose(found, jacobian, atol=1e-5 * np.abs(jacobian).max())


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_the_kink_does_not_move_the_edge(share: float):
    """At p_e = 0.3 the two sides differ by a third, and every mixture has the roots of one polynomial, and 0."""
    s, d, rest = 1.3, 0.1, 0.3
    one, other = one_sided_jacobians(s, d, K, GAMMA, ALPHA, rest)
    assert np.abs(one - other).max() > 0.1 * np.abs(one).max()
    polynomial = np.poly(share * one + (1.0 - share) * other)
    np.testing.assert_allclose(polynomial, [*analogue_polynomial(s, d, K, GAMMA, rest), 0.0], atol=1e-10)


def test_the_printed_d1_needs_a_rest_at_return_pressure():
    """d_1 = s/k - 4 sqrt2/(3 gamma) is d_2 with sigma = 3/(2 sqrt2): p_e = 0.0039 or 0.9961."""
    rest = float(np.asarray(brentq(lambda p: float(flow_slope(p)) - 1.5 / SQRT2, 1e-6, 0.5)))
    assert rest == pytest.approx(0.0039, abs=5e-5)
    edge = float(analogue_edge(0.1, K, GAMMA, rest))
    assert edge / K - 4.0 * SQRT2 / (3.0 * GAMMA) == pytest.approx(0.1, rel=1e-9)
    with pytest.raises(ValueError, match=r"inside \(0, 1\)"):
        flow_slope(1.0)


@pytest.mark.parametrize("eps", [5e-3, 1e-3, 1e-4])
def test_smoothed_relay_has_its_pair_on_the_axis_at_the_edge(eps: float):
    edge = relay_edge(10.0, K, GAMMA, ALPHA, eps)
    omega = float(relay_frequency(10.0, K, GAMMA, ALPHA, eps))
    for d, sign in ((edge, 0.0), (1.01 * edge, -1.0), (0.99 * edge, 1.0)):
        roots = np.roots(relay_polynomial(10.0, d, K, GAMMA, ALPHA, eps))
        top = roots[np.argmax(roots.real)]
        assert (abs(top.real) < 1e-9 * omega) if sign == 0.0 else (np.sign(top.real) == sign)
    roots = np.roots(relay_polynomial(10.0, edge, K, GAMMA, ALPHA, eps))
    assert np.abs(roots - 1j * omega).min() < 1e-9 * omega


def test_relay_edge_of_the_source():
    assert float(relay_edge(10.0, K, GAMMA, ALPHA)) == pytest.approx(0.2789, abs=5e-5)
    closed = SQRT2 * ALPHA * 10.0 / (GAMMA + SQRT2 * ALPHA * K)
    gaps = [closed - float(relay_edge(10.0, K, GAMMA, ALPHA, eps)) for eps in (1e-2, 1e-3, 1e-4)]
    assert gaps[0] / gaps[1] == pytest.approx(10.0, rel=1e-9)
    assert gaps[0] > 0.0
    fast, faster = (float(relay_frequency(10.0, K, GAMMA, ALPHA, eps)) for eps in (1e-2, 1e-4))
    assert faster / fast == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize("d", [0.2, 0.4])
def test_relay_polynomial_is_that_of_the_whole_model(d: float):
    """Smoothed by tanh: the pressures at rest are 1/2, with |u| on both ports the field is smooth up to rounding."""
    eps = 0.05
    rest = np.array([0.0, 0.0, 0.5, 0.5])
    field = slopes(lambda y: smooth_relay(y, 10.0, d, eps), rest)
    expected = relay_polynomial(10.0, d, K, GAMMA, ALPHA, eps)
    reduced = difference_of_pressures(field)
    np.testing.assert_allclose(np.poly(reduced), expected, rtol=1e-6)


def smooth_relay(y: np.ndarray, s: float, d: float, eps: float) -> np.ndarray:
    """Mean of the two open directions, weighed by (1 +- u)/2: the switching relay in the mean, u = -tanh(h/eps)."""
    u = -math.tanh((s * y[0] + d * y[1]) / eps)
    up, down = (full_rates(y, side, K, GAMMA, ALPHA) for side in (1.0, -1.0))
    return 0.5 * (1.0 + u) * up + 0.5 * (1.0 - u) * down


def difference_of_pressures(field: np.ndarray) -> np.ndarray:
    """The part of a Jacobian by y1, y2 and alpha (y3 - y4)."""
    into = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, ALPHA, -ALPHA]])
    back = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 0.5 / ALPHA], [0, 0, -0.5 / ALPHA]])
    return into @ field @ back


@pytest.mark.parametrize("u", [0.7, -0.4])
@pytest.mark.parametrize("y2", [0.1, -0.15])
def test_stiff_oil_keeps_the_pressures_on_the_manifold(u: float, y2: float):
    """Flows fit the speed there, so pressures stand still; their own slopes are `layer_rates`."""
    y1 = 0.2
    y3, y4 = (float(p) for p in critical_manifold(y2, u, GAMMA))
    y = np.array([y1, y2, y3, y4])
    assert np.abs(full_rates(y, u, K, GAMMA, ALPHA)[2:]).max() < 1e-12
    field = slopes(lambda y: full_rates(y, u, K, GAMMA, ALPHA), y)
    expected = [float(rate) for rate in layer_rates(y1, y2, u, GAMMA, ALPHA)]
    np.testing.assert_allclose(np.diag(field)[2:], expected, rtol=1e-6)
    assert max(expected) < 0.0
    np.testing.assert_allclose(full_rates(y, u, K, GAMMA, ALPHA)[:2], reduced_rates(y2, u, K, GAMMA, ALPHA), atol=1e-15)


def test_the_whole_model_follows_the_manifold_the_closer_the_stiffer():
    """0.5 after a start off the manifold, u held: the distance is of first order in alpha."""
    away = []
    for alpha in (1e-3, 1e-4):

        def rates(_t, y, a=alpha):
            return full_rates(y, 0.6, K, GAMMA, a)

        limits = {"rtol": 1e-9, "atol": 1e-12}
        y = integrate(rates, (0.0, 0.5), [0.0, 0.2, 0.9, 0.3], "Radau", most=50_000, **limits).y[:, -1]
        away.append(np.abs(y[2:] - np.array(critical_manifold(y[1], 0.6, GAMMA))).max())
    assert away[0] / away[1] == pytest.approx(10.0, rel=0.1)


@pytest.mark.parametrize("d", [0.02, 0.1, 0.35])
def test_the_reduced_relay_loop_slides_near_rest_and_the_whole_one_never_does(d: float):
    """On the manifold the two sides of h = 0 push at each other where |s - d k| |y2| < d alpha (1 - 2 (y2/gamma)^2)."""
    s = 10.0
    bound = d * ALPHA / (s - d * K)
    assert slides(np.array([0.0, 0.99, -0.99]) * bound, s, d, K, GAMMA, ALPHA).all()
    assert not slides(np.array([1.01, -1.01]) * bound, s, d, K, GAMMA, ALPHA).any()
    y = np.array([-d / s * bound, bound, 0.4, 0.7])
    moves = [s * rate[0] + d * rate[1] for rate in (full_rates(y, u, K, GAMMA, ALPHA) for u in (1.0, -1.0))]
    assert moves[0] == moves[1]


@pytest.mark.parametrize("tau", [0.3, 1.3, 1.96, 6.28])
def test_a_pair_of_the_damped_loop_leaves_the_circle_at_its_gain(tau: float):
    """k 0.1, gamma 0.23, as in figure 5.9: inside below the gain, outside above it, and complex."""
    loop = sampled_loop(linear_actuator(0.1, 0.23), Timing(tau))
    gain = min(g for g in pair_gains(loop, 0.0) if g > 0.0)
    below, at, above = (np.linalg.eigvals(closed(loop, share * gain, 0.0)) for share in (0.999, 1.0, 1.001))
    assert np.abs(below).max() < 1.0 < np.abs(above).max()
    leaving = at[np.argmax(np.abs(at))]
    assert abs(leaving) == pytest.approx(1.0, abs=1e-9)
    assert abs(leaving.imag) > 1e-3
