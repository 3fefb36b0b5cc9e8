"""The sampled loop: its matrix against a loop integrated apart from it, its edges against runs on both sides."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from controller.law import Memory
from controller.stability import Timing, critical_gain, is_stable, monodromy, multipliers
from controller.stability.actuator.analogue import analogue_edge
from tests.support.sampled_loop import (
    Case,
    course,
    integrated,
    tabulated,
)

DERIVATIVES = ("measured", "backward", "filtered")
DELAYS = (0.0, 0.25, 1.0, 1.3, 2.0, 2.71828, 3.0)  # every whole number, and some between
EDGES = settings(max_examples=24, deadline=None, derandomize=True)


def random_case(derivative: str, delay: float) -> Case:
    random = np.random.default_rng([round(delay * 1e5), DERIVATIVES.index(derivative)])
    s, d, k, gamma, tau, lag = random.uniform([0.1, 0.0, 0.0, 0.05, 0.1, 0.2], [4.0, 2.0, 3.0, 1.0, 6.0, 3.0])
    return Case(s, d, k, gamma, tau, delay, derivative, lag if derivative == "filtered" else None)


def matrix_of(case: Case) -> np.ndarray:
    return monodromy(
        case.s, case.d, case.k, case.gamma, Timing(case.tau, case.delay, case.derivative, case.filter_time)
    )


def by_columns(case: Case) -> np.ndarray:
    """The matrix from sample to sample, one run of a period from each unit state."""
    past = math.ceil(case.delay)
    memory = {"measured": 0, "backward": 1, "filtered": 2}[case.derivative]
    columns = []
    for unit in np.eye(3 + past + memory):
        z, inputs, rest = unit[:3], unit[3 : 3 + past], unit[3 + past :]
        before = Memory(*rest, *[0.0] * (2 - memory))
        states, commands, memories = course(case, z, inputs, before, 1, integrated(case))
        assert memories[-1] is not None
        columns.append([*states[-1], *commands[::-1][:past], *memories[-1][:memory]])
    return np.array(columns).T


@pytest.mark.parametrize("delay", DELAYS)
@pytest.mark.parametrize("derivative", DERIVATIVES)
def test_matrix_and_multipliers_against_integration(derivative: str, delay: float):
    """The law itself in a loop integrated to 1e-12. Multipliers: to 1e-9 each, where they are single.

    Those near 0 belong to past inputs and are nearly multiple; they are compared through their matrix.
    """
    case = random_case(derivative, delay)
    theory, run = matrix_of(case), by_columns(case)
    np.testing.assert_allclose(theory, run, atol=1e-9)
    expected = np.linalg.eigvals(run)
    for mu in multipliers(theory):
        if abs(mu) > 0.05:
            assert np.abs(expected - mu).min() < 1e-9


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 2.5])
@pytest.mark.parametrize("derivative", DERIVATIVES)
def test_many_periods_from_rest(derivative: str, delay: float):
    """Ten periods after the first command, at their instants; the first difference of the law is 0, as in `Memory`."""
    case = random_case(derivative, delay)
    states, commands, _ = course(case, [1.0, 0.5, -0.3], [], None, 11, integrated(case))
    past = math.ceil(delay)
    row = {"measured": [], "backward": [1.0], "filtered": [1.0, 0.0]}[derivative]
    state = np.array([*states[1], *([commands[0], 0.0, 0.0][:past]), *row])
    final = np.linalg.matrix_power(matrix_of(case), 10) @ state
    np.testing.assert_allclose(final[:3], states[-1], atol=1e-9 * np.abs(states).max())


def test_an_array_of_cases_is_the_cases():
    k, tau = np.array([[0.0], [0.5]]), np.array([1.0, 3.0, 7.0])
    delay = np.array([1.2, 1.5, 2.0])
    stack = monodromy(0.5, 0.1, k, 0.23, Timing(tau, delay, "backward"))
    assert stack.shape == (2, 3, 6, 6)
    np.testing.assert_array_equal(stack[1, 2], monodromy(0.5, 0.1, 0.5, 0.23, Timing(7.0, 2.0, "backward")))
    edges = critical_gain(0.0, k, 0.23, Timing(tau, np.array([0.0, 1.2, 3.0])))
    assert np.asarray(edges)[1, 1] == critical_gain(0.0, 0.5, 0.23, Timing(3.0, 1.2))


@pytest.mark.parametrize("d", [0.0, 0.3])
@pytest.mark.parametrize("derivative", ["measured", "backward"])
@pytest.mark.parametrize("delay", [0.0, 1.5])
def test_fast_sampling_is_the_analogue_loop(d: float, derivative: str, delay: float):
    """Gap to k (d + sqrt2/gamma) of first order in tau: a tenth of the interval, a tenth of the gap."""
    edge = float(analogue_edge(d, 0.5, 0.23))
    assert edge == pytest.approx(0.5 * (d + math.sqrt(2.0) / 0.23), rel=1e-14)
    gaps = [critical_gain(d, 0.5, 0.23, Timing(tau, delay, derivative)) - edge for tau in (1e-2, 1e-3, 1e-4)]
    assert gaps[0] / gaps[1] == pytest.approx(10.0, rel=0.1)
    assert gaps[1] / gaps[2] == pytest.approx(10.0, rel=0.02)
    assert abs(gaps[2]) < 1e-3


def test_fast_sampling_without_damping_gain():
    assert critical_gain(0.0, 1.0, 0.23, Timing(1e-6)) == pytest.approx(6.149, abs=5e-4)


def test_derivative_gain_can_destabilise():
    """Source, text to Fig. 5.14 and following: tau 3, s 0.5, k 0."""
    assert is_stable(monodromy(0.5, 0.0, 0.0, 0.23, Timing(3.0)))
    assert not is_stable(monodromy(0.5, 0.5, 0.0, 0.23, Timing(3.0)))


def swings(case: Case, periods: int) -> float:
    """Logarithm of the growth of the largest swing from the second quarter of a run to the last."""
    states, _, _ = course(case, [1.0, 0.3, -0.2], [], None, periods, tabulated(case))
    quarter = periods // 4
    size = np.abs(states).max(axis=1)
    return math.log(size[-quarter:].max() / size[quarter : 2 * quarter].max())


@given(
    d=st.floats(0.0, 0.5),
    k=st.floats(0.05, 2.0),
    gamma=st.floats(0.05, 1.0),
    tau=st.floats(0.2, 8.0),
    delay=st.floats(0.0, 3.0),
    derivative=st.sampled_from(DERIVATIVES),
    lag=st.floats(0.0, 2.0),
)
@EDGES
def test_the_law_loses_stability_at_the_critical_gain(
    d: float, k: float, gamma: float, tau: float, delay: float, derivative: str, lag: float
):
    """Oscillations die out 2 % below the edge and grow 2 % above it, in 1200 periods."""
    lag_of = lag if derivative == "filtered" else None
    edge = critical_gain(d, k, gamma, Timing(tau, delay, derivative, lag_of))
    assert isinstance(edge, float)
    assume(edge > 1e-3)
    assert swings(Case(0.98 * edge, d, k, gamma, tau, delay, derivative, lag_of), 1200) < 0.0
    assert swings(Case(1.02 * edge, d, k, gamma, tau, delay, derivative, lag_of), 1200) > 0.0


@pytest.mark.parametrize(("tau", "lost"), [(1.0, True), (2.0, True), (3.0, False), (5.0, True), (7.0, False)])
def test_without_damping_any_gain_may_be_too_much(tau: float, lost: bool):
    """k = d = 0: the oil spring gains energy at small s iff sin(sqrt2 tau) > 0, from the slope of its multiplier."""
    assert (math.sin(math.sqrt(2.0) * tau) > 0.0) == lost
    assert (critical_gain(0.0, 0.0, 0.23, Timing(tau)) == 0.0) == lost
    assert (swings(Case(0.05, 0.0, 0.0, 0.23, tau, 0.0, "measured", None), 1200) > 0.0) == lost


def test_too_much_derivative_leaves_no_gain():
    assert critical_gain(10.0, 0.1, 0.23, Timing(2.0)) == 0.0
    assert swings(Case(0.001, 10.0, 0.1, 0.23, 2.0, 0.0, "measured", None), 200) > 0.0


def test_a_wrong_sign_is_never_stable():
    assert critical_gain(0.0, 0.5, -0.23, Timing(2.0)) == 0.0


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"tau": 0.0}, "sampling interval 0.0"),
        ({"tau": math.nan}, "sampling interval nan"),
        ({"delay": -0.1}, "delay -0.1"),
        ({"delay": np.array([0.5, 1.5])}, "round up"),
        ({"derivative": "forward"}, "'forward' is none of"),
        ({"derivative": "filtered"}, "filter time"),
        ({"derivative": "filtered", "filter_time": -1.0}, "filter time"),
    ],
)
def test_what_cannot_be_asked(change: dict, word: str):
    with pytest.raises(ValueError, match=word):
        monodromy(1.0, 0.0, 0.5, 0.23, Timing(**{"tau": 1.0, **change}))
