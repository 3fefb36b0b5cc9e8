"""How stability is lost: closed forms of the edges against multipliers, kind and frequency against runs."""

import math

import numpy as np
import pytest

from controller.stability import (
    Plant,
    Timing,
    critical_gain,
    is_stable,
    linear_actuator,
    loop_onset,
    monodromy,
    multipliers,
)
from controller.stability import sampled_loop as loop_of
from controller.stability.actuator.analogue import analogue_frequency
from controller.stability.crossing import stable_ranges
from controller.stability.curves import flip_curve, flip_gain, fold_intervals, neimark_sacker_curve
from controller.stability.sampled import closed
from tests.support.sampled_loop import Case, course, tabulated

SQRT2 = math.sqrt(2.0)
TAU = np.random.default_rng(57).uniform(0.1, 20.0, 300)
LAG = Plant(np.array([[-1.0]]), np.array([1.0]), np.array([1.0]), None)  # x' = u - x


@pytest.mark.parametrize("gamma", [0.0695, 0.23, 1.0])
@pytest.mark.parametrize("d", [0.0, 0.1, 1.0, 10.0])
def test_flip_curve_has_a_multiplier_at_minus_one(d: float, gamma: float):
    """Whatever d: det(M + 1) = 0, and the multiplier itself where no other is near; 1e-12 of the matrix."""
    s, matrix = on_curve(flip_curve(TAU, gamma), d, gamma)
    size = np.linalg.norm(matrix, axis=(1, 2))
    assert (np.abs(np.linalg.det(matrix + np.eye(3))) / size**2).max() < 1e-12
    gap = np.sort(np.abs(multipliers(matrix) + 1.0))
    alone = gap[:, 1] > 0.2
    assert alone.sum() > 0.8 * len(s)
    assert (gap[:, 0] / size)[alone].max() < 1e-12


@pytest.mark.parametrize("gamma", [0.0695, 0.23, 1.0])
@pytest.mark.parametrize("d", [0.1, 1.0, 10.0])
def test_neimark_sacker_curve_has_a_pair_of_product_one(d: float, gamma: float):
    """The third multiplier is then e3, so e3^2 - e1 e3 + e2 - 1 = 0; a complex pair has size 1. 1e-12 of the matrix."""
    s, matrix = on_curve(neimark_sacker_curve(TAU, d, gamma), d, gamma)
    size = np.linalg.norm(matrix, axis=(1, 2))
    e1, e3 = np.trace(matrix, axis1=1, axis2=2), np.linalg.det(matrix)
    e2 = 0.5 * (e1**2 - np.trace(matrix @ matrix, axis1=1, axis2=2))
    assert (np.abs(e3**2 - e1 * e3 + e2 - 1.0) / size**2).max() < 1e-12
    mu = multipliers(matrix)
    pairs = np.abs(mu.imag) > 0.1
    assert len(s) > 30
    assert (np.abs(np.abs(mu) - 1.0) / size[:, None])[pairs].max(initial=0.0) < 1e-12


def on_curve(s: np.ndarray, d: float, gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """Gains of a curve over TAU up to 50, and the matrices there."""
    at = (s > 0.0) & (s < 50.0)
    return s[at], monodromy(s[at], d, 0.0, gamma, Timing(TAU[at]))


def test_fold_intervals_keep_a_multiplier_at_one():
    """tau of whole periods of the oil spring: it swings once or more between samples, and nobody sees it."""
    tau = fold_intervals(20.0)
    np.testing.assert_allclose(SQRT2 * tau / (2.0 * np.pi), [1.0, 2.0, 3.0, 4.0], rtol=1e-14)
    for s, d in ((0.3, 0.0), (1.0, 0.0), (0.3, 0.5)):
        matrix = monodromy(s, d, 0.0, 0.23, Timing(tau))
        assert np.abs(np.linalg.det(matrix - np.eye(3))).max() < 1e-12
        assert not is_stable(matrix).any()


def test_the_first_edge_is_on_a_curve():
    """k = d = 0: the critical gain is the flip curve where any gain is stable, to 1e-12."""
    found = np.asarray(critical_gain(0.0, 0.0, 0.23, Timing(TAU[:100])))
    curve = flip_curve(TAU[:100], 0.23)
    assert 30 < (found > 0.0).sum() < 70
    np.testing.assert_allclose(found[found > 0.0], curve[found > 0.0], rtol=1e-12)


def test_curves_bound_the_stable_region_of_a_damped_chart():
    """d = 0.1: every end of every stable range of s, 0 aside, is on one of the two curves."""
    ends = 0
    for tau in TAU[:100]:
        loop = loop_of(linear_actuator(0.0, 0.23), Timing(tau))
        matrix = closed(loop, 0.0, 0.1)
        curves = [flip_curve(tau, 0.23), neimark_sacker_curve(tau, 0.1, 0.23)]
        for end in np.ravel(stable_ranges(matrix, loop.entry, loop.position)):
            if 0.0 < end < 100.0:
                assert np.nanmin(np.abs(np.array(curves) - end)) < 1e-10 * (1.0 + end)
                ends += 1
    assert ends > 30


def test_flip_gain_is_the_curve():
    loop = loop_of(linear_actuator(0.0, 0.23), Timing(7.0))
    assert flip_gain(loop, 0.3) == pytest.approx(float(flip_curve(7.0, 0.23)), rel=1e-12)


@pytest.mark.parametrize("tau", [0.1, 1.0, 3.0])
def test_a_lag_flips(tau: float):
    """mu = e^-tau - s (1 - e^-tau) = -1 at s = coth(tau/2): half the sampling frequency, pi/tau."""
    onset = loop_onset(loop_of(LAG, Timing(tau, derivative="backward")), 0.0)
    assert onset is not None
    assert onset.kind == "flip"
    assert onset.gain == pytest.approx(1.0 / math.tanh(0.5 * tau), rel=1e-12)
    assert onset.angle / tau == 0.5 * (2.0 * math.pi / tau)


@pytest.mark.parametrize("tau", [0.1, 1.0, 3.0])
def test_a_lag_with_one_period_of_delay_swings(tau: float):
    """mu^2 - a mu + s (1 - a), a = e^-tau: product 1 at s = 1/(1 - a), sum a, so cos(angle) = a/2."""
    onset = loop_onset(loop_of(LAG, Timing(tau, 1.0, "backward")), 0.0)
    assert onset is not None
    assert onset.kind == "Neimark-Sacker"
    assert onset.gain == pytest.approx(-1.0 / math.expm1(-tau), rel=1e-12)
    assert math.cos(onset.angle) == pytest.approx(0.5 * math.exp(-tau), abs=1e-12)


def test_a_lag_fed_back_with_the_wrong_sign_folds():
    """x' = u - x, u = s x: x stays wherever it is at s = 1, sampled or not."""
    onset = loop_onset(loop_of(LAG._replace(position=np.array([-1.0])), Timing(0.7, 1.3, "backward")), 0.0)
    assert onset is not None
    assert (onset.kind, onset.angle) == ("fold", 0.0)
    assert onset.gain == pytest.approx(1.0, rel=1e-12)


def test_a_command_that_moves_nothing_loses_nothing():
    assert loop_onset(loop_of(LAG._replace(b=np.array([0.0])), Timing(0.7, derivative="backward")), 0.0) is None


def test_what_is_lost_at_once_is_the_oil_spring():
    """k = d = 0, tau 1: the piston's own multiplier 1 turns inward, the pair exp(+-i sqrt2 tau) outward."""
    onset = loop_onset(loop_of(linear_actuator(0.0, 0.23), Timing(1.0)), 0.0)
    assert onset is not None
    assert (onset.gain, onset.kind) == (0.0, "Neimark-Sacker")
    assert onset.angle == pytest.approx(SQRT2, rel=1e-12)


@pytest.mark.parametrize("d", [0.0, 1.0])
def test_fast_sampling_starts_with_the_analogue_frequency(d: float):
    onset = loop_onset(loop_of(linear_actuator(0.5, 0.23), Timing(1e-4)), d)
    assert onset is not None
    assert onset.angle / 1e-4 == pytest.approx(float(analogue_frequency(d, 0.23)), rel=1e-3)


@pytest.mark.parametrize(
    ("tau", "delay", "derivative", "kind"),
    [
        (1.0, 0.0, "measured", "Neimark-Sacker"),
        (5.0, 0.0, "measured", "flip"),
        (5.0, 0.7, "filtered", "Neimark-Sacker"),
        (2.0, 1.6, "backward", "Neimark-Sacker"),
        (8.0, 0.1, "backward", "flip"),
    ],
)
def test_a_run_at_the_edge_swings_as_predicted(tau: float, delay: float, derivative: str, kind: str):
    """The law's own loop, 400 periods, all else died out: samples change sign angle/pi times a period, to one."""
    lag = 0.8 if derivative == "filtered" else None
    onset = loop_onset(loop_of(linear_actuator(0.5, 0.23), Timing(tau, delay, derivative, lag)), 0.1)
    assert onset is not None
    assert onset.kind == kind
    case = Case(onset.gain, 0.1, 0.5, 0.23, tau, delay, derivative, lag)
    position = course(case, [1.0, 0.3, -0.2], [], None, 600, tabulated(case))[0][200:, 0]
    changes = (position[1:] * position[:-1] < 0.0).sum()
    assert changes == pytest.approx(400.0 * onset.angle / math.pi, abs=1.0)
    assert np.abs(position[:200]).max() == pytest.approx(np.abs(position[200:]).max(), rel=0.02)
