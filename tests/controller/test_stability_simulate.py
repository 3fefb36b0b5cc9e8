"""The sampled loop about the whole actuator, run: against scipy, `controller.law` and linear theory."""

import math

import numpy as np
import pytest

from controller.stability import Timing, loop_onset, monodromy
from controller.stability.actuator.constant_command import (
    LONGEST,
    STATE,
    SimulatedActuator,
    step_by,
)
from controller.stability.actuator.disagreement import causes, oscillates_by_theory
from controller.stability.actuator.model import Actuator, field
from controller.stability.actuator.oscillation import KEPT, PLAIN, oscillations
from controller.stability.actuator.simulate import (
    END,
    WENT,
    controller,
    displaced,
    simulate,
)
from controller.stability.actuator.stiff import stiff_step_by
from controller.stability.orbits.period_two import linear_loop
from controller.stability.orbits.stroboscope import mirrored, period, width_of
from controller.stability.plant import linear_actuator
from tests.support.random_loops import SIDES, random_loops
from tests.support.sampled_loop import Case, course
from tests.support.stiff_valve import by_radau
from twin.integration import integrate

PLANT = Actuator(0.0043, 0.23, 0.1)
FINE = SimulatedActuator(PLANT, 0.0, 1e-12)
NARROW = PLAIN._replace(s=0.6007, d=2.987, k=0.0443, gamma=0.7756, tau=5.2372, alpha=0.2, limit=0.003, start=0.3)
FAINT = PLAIN._replace(
    d=0.010307, k=0.039635, gamma=0.095, tau=0.50866, derivative="filtered", filter_time=0.52145, start=100.0
)  # 0.62666 is its critical gain
STATE_0 = np.array([0.01, -0.006, 0.42, 0.61])
SMOOTH = np.array([0.003, 0.0002, 0.45, 0.55])  # no pressure comes near supply or relief soon


def by_scipy(z: np.ndarray, u: float, time: float) -> np.ndarray:
    if time <= 0.0:
        return z
    end = integrate(lambda _, y: field(y, u, PLANT), (0.0, time), z, "DOP853", most=200_000, rtol=1e-12, atol=1e-13)
    return end.y[:, -1]


@pytest.mark.parametrize(
    ("derivative", "lag", "delay", "limit"),
    [
        ("measured", None, 0.0, 1.0),
        ("backward", None, 0.4, 0.02),
        ("filtered", 0.7, 1.0, 1.0),
        ("measured", None, 2.3, 1.0),
    ],
)
def test_a_run_is_what_the_control_law_and_scipy_make_of_it(derivative, lag, delay, limit):
    """`controller.law` itself, commands at their instants, DOP853: 1e-8 of the supply pressure over twelve periods."""
    case = Case(4.0, 0.3, PLANT.k, PLANT.gamma, 1.7, delay, derivative, lag)

    def limited(z, u, time):
        return by_scipy(z, float(np.clip(u, -limit, limit)), time)

    states, given, _ = course(case, STATE_0, np.zeros(3), None, 12, limited)
    loop = controller(case.s, case.d, Timing(case.tau, delay, derivative, lag), limit)
    run = simulate(STATE_0, PLANT, loop, 12, tolerance=1e-12)
    assert run.outcome == WENT
    assert run.states == pytest.approx(states, abs=1e-8)
    assert run.commands == pytest.approx(np.clip(given[3:], -limit, limit), abs=1e-8)
    assert (np.abs(run.commands) == limit).any() == (limit < 1.0)


def test_a_step_is_of_fifth_order():
    """Half the step, a 64th of a step's error."""
    errors = []
    for size in (0.05, 0.025):
        stages, trial = np.zeros((7, STATE)), np.zeros(STATE)
        stages[0] = field(SMOOTH, 0.05, PLANT)
        step_by(SMOOTH.copy(), STATE, size, 0.05, FINE, stages, trial)
        errors.append(np.abs(trial - by_scipy(SMOOTH, 0.05, size)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(6.0, abs=0.5)


def test_a_small_swing_keeps_its_size():
    """k = 0, valve shut: the oil spring swings for ever. A step h loses (sqrt2 h)^6/3600 of a swing of any size."""
    loop, steps = controller(0.0, 0.0, Timing(np.pi * np.sqrt(2.0))), math.ceil(np.pi * np.sqrt(2.0) / LONGEST)
    kept = (1.0 - (2.0 * np.pi / steps) ** 6 / 3600.0) ** (1000 * steps)
    for size in (1e-9, 1e-4):
        run = simulate([0.0, 0.0, 0.5 + size, 0.5 - size], PLANT._replace(k=0.0), loop, 1000)
        assert run.states[-1, 2] - 0.5 == pytest.approx(kept * size, rel=1e-3)
    assert kept > 0.997


@pytest.mark.parametrize(
    ("derivative", "lag", "delay"), [("measured", None, 0.0), ("backward", None, 0.6), ("filtered", 0.7, 2.0)]
)
def test_a_small_swing_follows_the_monodromy_matrix(derivative, lag, delay):
    """From sample to sample, at 1e-6 of the supply pressure: what is left is its square, and the step's error."""
    loop, size = controller(1.5, 0.2, Timing(2.0, delay, derivative, lag)), 1e-6
    z = np.zeros(width_of(loop) - 1)
    z[:3] = size * PLANT.alpha * np.array([1.0, -0.5, 0.8])
    x = np.zeros(width_of(loop))
    x[:4] = z[0], z[1], 0.5 + z[2] / (2.0 * PLANT.alpha), 0.5 - z[2] / (2.0 * PLANT.alpha)
    for _ in range(20):
        z = monodromy(loop.s, loop.d, PLANT.k, PLANT.gamma, Timing(loop.tau, delay, derivative, lag)) @ z
        x = period(x, FINE, loop)[0]
    assert [*x[:2], PLANT.alpha * (x[2] - x[3]), *x[4:]] == pytest.approx(z, rel=1e-4, abs=1e-4 * np.abs(z).max())


@pytest.mark.parametrize(
    ("derivative", "lag", "delay"), [("measured", None, 0.0), ("backward", None, 1.0), ("filtered", 0.7, 1.4)]
)
def test_derivatives_of_a_period_are_those_of_its_end(derivative, lag, delay):
    """Central differences; and both ways of running a period agree; and so does the mirror image."""
    loop = controller(3.0, 0.2, Timing(1.1, delay, derivative, lag))
    rng = np.random.default_rng(4)
    x = np.concatenate([SMOOTH, rng.uniform(-0.01, 0.01, width_of(loop) - 4)])
    after, by_x, by_s = period(x, FINE, loop)
    size = 1e-6
    seen = [
        (period(x + size * e, FINE, loop)[0] - period(x - size * e, FINE, loop)[0]) / (2.0 * size)
        for e in np.eye(len(x))
    ]
    assert by_x == pytest.approx(np.transpose(seen), rel=1e-5, abs=1e-5)
    up, down = (period(x, FINE, loop._replace(s=loop.s + shift))[0] for shift in (size, -size))
    assert by_s == pytest.approx((up - down) / (2.0 * size), rel=1e-5, abs=1e-6)
    assert period(mirrored(x), FINE, loop)[0] == pytest.approx(mirrored(after), rel=1e-12, abs=1e-12)


def test_random_loops_swing_on_the_side_of_the_edge_that_theory_says():
    """Let go at 0.01 alpha, 3 % and 10 % beside their critical gain; also how often samples change sides."""
    for loop in random_loops(7, 10):
        at = loop._replace(s=SIDES * loop.s, start=0.01)
        found, numbers = oscillations(at), [float(np.asarray(value)) for value in loop[1:6]]
        d, k, gamma, tau, delay = numbers
        np.testing.assert_array_equal(found.oscillates, [False, False, True, True], str(numbers))
        sampled = controller(0.0, d, Timing(tau, delay, loop.derivative, loop.filter_time))
        onset = loop_onset(linear_loop(linear_actuator(k, gamma), sampled), d)
        assert onset is not None
        assert onset.gain == pytest.approx(loop.s, rel=1e-6)
        assert found.angle[2] == pytest.approx(onset.angle, rel=0.1), numbers


def test_a_flip_swings_at_half_the_sampling_frequency():
    found = oscillations(PLAIN._replace(s=2.45, tau=3.0))
    assert found.oscillates
    assert found.angle == pytest.approx(np.pi)
    assert found.frequency == pytest.approx(np.pi / 3.0, rel=1e-6)
    assert found.saturated == 0.0


def test_a_piston_on_its_way_does_not_oscillate():
    """A valve that opens by no more than 0.1 % brings it home from 20 % of a chamber in 2000 units and more of time."""
    found = oscillations(PLAIN._replace(limit=1e-3, start=0.2 / PLANT.alpha))
    assert not found.oscillates
    assert found.growth < KEPT


def test_a_valve_at_its_limit_is_counted():
    found = oscillations(PLAIN._replace(s=[1.0, 5.0], tau=20.0, start=10.0))
    assert found.saturated[0] == 0.0
    assert 0.5 < found.saturated[1] < 1.0
    assert found.oscillates[1]


def test_a_piston_runs_into_the_end_with_the_valve_open():
    """Soft oil, late: what the shut chamber would catch flows out. It counts as oscillating."""
    loop = PLAIN._replace(s=0.295, d=0.629, tau=6.69, delay=0.963, gamma=0.814, k=0.0287, alpha=0.2, start=0.01)
    found = oscillations(loop)
    assert found.ends
    assert found.oscillates
    assert found.amplitude == 1.0
    run = simulate(displaced(0.002), Actuator(0.2, 0.814, 0.0287), controller(0.295, 0.629, Timing(6.69, 0.963)), 400)
    assert run.outcome == END
    assert np.isnan(run.states[-1]).all()


def test_a_wide_swing_with_a_stiff_valve_is_what_scipy_integrates():
    """The valve at its limit most of the time: chambers settle up to a thousand times faster than the piston moves."""

    def witness(z: np.ndarray, u: float, time: float) -> np.ndarray:
        if time <= 0.0:
            return z
        return by_radau(z, float(np.clip(u, -1.0, 1.0)), time, PLANT, rtol=1e-9, atol=1e-11).y[:, -1]

    case = Case(5.0, 0.0, PLANT.k, PLANT.gamma, 20.0, 0.0, "measured", None)
    states, _, _ = course(case, displaced(0.05), np.zeros(1), None, 2, witness)
    run = simulate(displaced(0.05), PLANT, controller(5.0, 0.0, Timing(20.0)), 2, tolerance=1e-9)
    assert run.states == pytest.approx(states, abs=1e-8)


def test_a_stiff_step_is_of_fourth_order():
    """Half the step, a 32nd of a step's error."""
    errors = []
    for size in (0.0125, 0.00625):
        trial = np.zeros(STATE)
        stiff_step_by(SMOOTH.copy(), size, -0.05, FINE, np.zeros((7, STATE)), trial)
        errors.append(np.abs(trial - by_scipy(SMOOTH, -0.05, size)).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.3)


def test_oil_stops_the_piston_before_the_end_of_the_cylinder():
    """The chamber's volume goes to zero there and its pressure to infinity, as in (5.7)."""
    run = simulate([0.9, 0.3, 0.5, 0.5], PLANT, controller(0.0, 0.0, Timing(0.5)), 20, tolerance=1e-9)
    assert run.outcome == WENT
    assert 0.96 < run.states[:, 0].max() < 1.0
    assert run.states[:, 3].max() > 200.0


@pytest.mark.parametrize(
    ("loop", "cause", "oscillates"),
    [
        (PLAIN._replace(s=1.39, tau=10.0, start=3.0), "hard", True),
        (PLAIN._replace(s=1.39, tau=10.0, start=0.01), "", False),
        (PLAIN._replace(s=2.45, tau=3.0, start=3.0), "", True),
        (NARROW, "saturated", True),
        (NARROW._replace(limit=0.03), "", False),
        (FAINT._replace(s=0.64546), "damped", False),
        (FAINT._replace(s=0.72), "slow", False),
    ],
)
def test_why_a_run_parts_from_theory(loop, cause, oscillates):
    found = oscillations(loop)
    assert found.oscillates == oscillates
    assert causes(loop, found) == cause
    assert bool(oscillates_by_theory(loop)) == (oscillates != (cause != ""))


def test_growth_is_that_of_the_largest_multiplier():
    """Over a third of the run, 100 periods: |mu|^100."""
    loop = PLAIN._replace(s=2.36, start=1e-6)
    mu = np.abs(np.linalg.eigvals(monodromy(2.36, 0.0, 0.1, 0.23, Timing(3.0)))).max()
    found = oscillations(loop)
    assert found.growth == pytest.approx(mu**100, rel=0.02)
    assert found.growth > 1.0 / KEPT


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tau": 0.0}, r"tau 0\.0 must be above 0"),
        ({"delay": [0.5, -1.0]}, r"delay -1\.0 must be at least 0"),
        ({"derivative": "exact"}, "'exact' is none of"),
        ({"derivative": "filtered"}, "needs a filter time"),
        ({"start": 300.0}, r"start 1\.29 chamber lengths"),
        ({"alpha": 0.0}, r"alpha 0\.0 must be above 0"),
    ],
)
def test_what_cannot_be_run_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        oscillations(PLAIN._replace(**change))
