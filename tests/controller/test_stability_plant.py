"""Any linear plant in the sampled loop: against python-control, on the running loop's grid, margins on both sides."""

import math

import control
import numpy as np
import pytest

from controller.grid import last_due, sampling
from controller.stability import (
    SampledLoop,
    Timing,
    closed,
    critical_gain,
    delay_margin,
    gain_margin,
    is_stable,
    linear_actuator,
    loop_onset,
    monodromy,
    multipliers,
    plant_of,
    sampled_loop,
)
from tests.support.plant import FRICTIONLESS, SMOOTH, circuit
from tests.support.sampled_loop import Case, course, tabulated
from twin.circuit.linear import edge_point, linearise

SQRT2 = math.sqrt(2.0)
ACTUATOR = control.StateSpace(
    [[0.0, 1.0, 0.0], [0.0, -0.5, 1.0], [0.0, -2.0, 0.0]],
    [[0.0], [0.0], [SQRT2 * 0.23]],
    [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]],
    [[0.0], [0.0]],
    inputs=["valve"],
    outputs=["speed", "place"],
)
PLANT = linear_actuator(0.5, 0.23)


@pytest.fixture(scope="module")
def rig() -> control.StateSpace:
    c = circuit(pump=SMOOTH, seal=FRICTIONLESS)
    return linearise(edge_point(c, 0.135, "+"), circuit=c)


def test_the_actuator_is_one_of_them():
    """By name and by index, any derivative and delay: the same matrix as the dimensionless functions give."""
    for plant in (plant_of(ACTUATOR, "valve", "place", "speed"), plant_of(ACTUATOR, 0, 1, 0)):
        for derivative, lag in (("measured", None), ("backward", None), ("filtered", 0.7)):
            found = closed(sampled_loop(plant, Timing(2.0, 1.3, derivative, lag)), 0.7, 0.2)
            expected = monodromy(0.7, 0.2, 0.5, 0.23, Timing(2.0, 1.3, derivative, lag))
            np.testing.assert_allclose(found, expected, atol=1e-14)


@pytest.mark.parametrize("tau", [0.3, 3.0])
def test_hold_is_that_of_python_control(tau: float):
    discrete, loop = control.c2d(ACTUATOR, tau, "zoh"), sampled_loop(PLANT, Timing(tau))
    np.testing.assert_allclose(loop.free, discrete.A, atol=1e-14)
    np.testing.assert_allclose(loop.entry, np.asarray(discrete.B)[:, 0], atol=1e-14)


@pytest.mark.parametrize("periods", [0, 1, 2])
def test_edge_is_the_gain_margin_of_python_control(periods: int):
    """One sample a period, delays of whole periods as 1/z; its phase crossover is the frequency at the edge."""
    system = control.ss2tf(control.c2d(ACTUATOR[1, 0], 1.0, "zoh"))
    margin, _, crossover, _ = control.margin(system * control.tf([1.0], [1.0] + [0.0] * periods, 1.0))
    onset = loop_onset(sampled_loop(PLANT, Timing(1.0, float(periods))), 0.0)
    assert onset is not None
    assert onset.gain == pytest.approx(margin, rel=1e-6)
    assert onset.gain == critical_gain(0.0, 0.5, 0.23, Timing(1.0, float(periods)))
    assert onset.angle == pytest.approx(crossover, rel=1e-6)
    loop = sampled_loop(PLANT, Timing(1.0, float(periods)))
    assert gain_margin(loop, 0.5, 0.0)[1] == pytest.approx(2.0 * margin, rel=1e-6)


def test_closed_loop_poles_are_those_of_python_control():
    """Position and speed fed back one period late: by blocks there, by one matrix here."""
    plant = control.c2d(ACTUATOR, 1.0, "zoh")
    late = control.StateSpace([[0.0]], [[1.0]], [[1.0]], [[0.0]], 1.0)
    loop = control.feedback(control.StateSpace([], [], [], [[0.2, 0.7]], 1.0) * plant * late, 1)
    assert isinstance(loop, control.StateSpace)
    poles = loop.poles()
    assert len(poles) == 4
    for mu in multipliers(monodromy(0.7, 0.2, 0.5, 0.23, Timing(1.0, 1.0))):
        assert np.abs(poles - mu).min() < 1e-9


@pytest.mark.parametrize("tau", [0.02, 0.2])
def test_the_rig_answers_as_in_python_control(rig: control.StateSpace, tau: float):
    """Samples after a command of one period, and the gain margin; 19 states in pascal, m^3/s and metres."""
    loop = sampled_loop(plant_of(rig, "spool_reference", "position", "velocity"), Timing(tau))
    discrete = control.c2d(rig[[0, 1], 0], tau, "zoh")
    found, expected, ours, theirs = loop.entry, np.asarray(discrete.B)[:, 0], [], []
    for _ in range(20):
        ours.append(loop.position @ found)
        theirs.append((discrete.C @ expected)[0])
        found, expected = loop.free @ found, discrete.A @ expected
    np.testing.assert_allclose(ours, theirs, rtol=1e-6)
    onset = loop_onset(loop, 0.0)
    assert onset is not None
    answer = complex(np.asarray(discrete(onset.multiplier))[0, 0])
    assert answer == pytest.approx(-1.0 / onset.gain, rel=1e-5)  # Nyquist's point, by python-control
    assert is_stable(closed(loop, 0.99 * onset.gain, 0.0))
    assert not is_stable(closed(loop, 1.01 * onset.gain, 0.0))


@pytest.mark.parametrize("offset", [0.0, 0.6])
@pytest.mark.parametrize("delay", [0.0, 0.35, 1.0, 2.4])
def test_the_grid_of_the_running_loop_has_the_same_matrix(offset: float, delay: float):
    """Commands act by `controller.grid.last_due` on steps of 0.05, samples at offset + i: an offset only waits."""
    grid = sampling(step=0.05, daq_period=0.1, sample_period=1.0, offset=offset, delay=delay)
    case = Case(0.7, 0.2, 0.5, 0.23, 1.0, delay, "measured", None)
    z, flow, given, seen = np.array([1.0, 0.3, -0.2]), tabulated(case), {}, []
    for step in range(20 * 9):
        if step * grid.step >= grid.offset and (step * grid.step - grid.offset) % grid.sample == 0:
            seen.append(z)
            given[step * grid.step] = -(0.7 * z[0] + 0.2 * z[1])
        due = last_due((step + 1) * grid.step, grid)
        z = flow(z, 0.0 if due is None else given[due], 0.05)
    past = math.ceil(delay)
    start = np.array([*seen[0], *[0.0] * past])
    end = np.linalg.matrix_power(monodromy(0.7, 0.2, 0.5, 0.23, Timing(1.0, delay)), len(seen) - 1) @ start
    np.testing.assert_allclose(end[:3], seen[-1], atol=1e-9)


@pytest.mark.parametrize(
    ("s", "d", "tau", "delay", "derivative"),
    [
        (2.0, 0.0, 1.0, 0.0, "measured"),
        (1.5, 0.2, 2.0, 0.3, "backward"),
        (1.0, 0.1, 4.0, 0.0, "measured"),
    ],
)
def test_delay_margin_on_both_sides(s: float, d: float, tau: float, delay: float, derivative: str):
    margin = delay_margin(PLANT, s, d, Timing(tau, delay, derivative))
    for share, grows in ((0.97, False), (1.03, True)):
        case = Case(s, d, 0.5, 0.23, tau, delay + share * margin, derivative, None)
        size = np.abs(course(case, [1.0, 0.3, -0.2], [], None, 1500, tabulated(case))[0]).max(axis=1)
        assert (size[-400:].max() > size[400:800].max()) == grows


def test_delay_margin_meets_the_critical_gain():
    """The gain that is critical at the longest delay is the given one."""
    margin = delay_margin(PLANT, 2.0, 0.0, Timing(1.0))
    assert critical_gain(0.0, 0.5, 0.23, Timing(1.0, margin)) == pytest.approx(2.0, rel=1e-9)
    assert delay_margin(PLANT, 0.3, 0.0, Timing(1.0), longest=3.0) == math.inf


def test_gain_margin_has_two_sides():
    """An unstable plant, x' = x + u, needs 1 < s < coth(tau/2): mu = e^tau - s (e^tau - 1)."""
    plant = plant_of(control.StateSpace([[1.0]], [[1.0]], [[1.0]], [[0.0]]), velocity=None)
    low, high = gain_margin(sampled_loop(plant, Timing(0.5, derivative="backward")), 1.5, 0.0)
    assert 1.5 * low == pytest.approx(1.0, rel=1e-12)
    assert 1.5 * high == pytest.approx(1.0 / math.tanh(0.25), rel=1e-12)


def test_an_unstable_loop_has_no_margin():
    loop: SampledLoop = sampled_loop(PLANT, Timing(1.0))
    assert not is_stable(closed(loop, 4.0, 0.0))
    with pytest.raises(ValueError, match=r"s 4\.0, d 0\.0 are unstable"):
        gain_margin(loop, 4.0, 0.0)
    with pytest.raises(ValueError, match=r"unstable at delay 0\.0"):
        delay_margin(PLANT, 4.0, 0.0, Timing(1.0))


def test_what_is_no_plant(rig: control.StateSpace):
    with pytest.raises(ValueError, match="sampled at 1"):
        plant_of(control.c2d(ACTUATOR, 1.0, "zoh"))
    with pytest.raises(ValueError, match="'valv' is none of valve"):
        plant_of(ACTUATOR, "valv")
    with pytest.raises(ValueError, match="output 2 is none of"):
        plant_of(ACTUATOR, 0, 2, None)
    with pytest.raises(ValueError, match="without any lag"):
        plant_of(control.StateSpace([[-1.0]], [[1.0]], [[1.0]], [[1.0]]), velocity=None)
    with pytest.raises(ValueError, match="no velocity output"):
        sampled_loop(plant_of(rig, velocity=None), Timing(0.1))
