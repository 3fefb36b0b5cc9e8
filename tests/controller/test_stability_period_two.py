"""Orbits of period two: born at the flip of linear theory, with a linear law of amplitude, through folds."""

from itertools import islice

import numpy as np
import pytest

from controller.stability import Timing, critical_gain
from controller.stability.actuator.constant_command import SimulatedActuator
from controller.stability.actuator.model import Actuator
from controller.stability.actuator.oscillation import PLAIN, oscillations
from controller.stability.actuator.simulate import controller, displaced, simulate
from controller.stability.orbits.branch import advance, branch
from controller.stability.orbits.period_two import flip_at, orbits, softness
from controller.stability.orbits.stroboscope import mirrored, period

PLANT = SimulatedActuator(Actuator(0.0043, 0.23, 0.1), 0.0, 1e-11)
LOOPS = {
    "soft": controller(0.0, 0.0, Timing(3.0)),
    "hard": controller(0.0, 0.0, Timing(10.0)),
    "late": controller(0.0, 0.0, Timing(3.0, 0.2)),
    "difference": controller(0.0, 0.1, Timing(4.0, 0.0, "backward")),
    "filter": controller(0.0, 0.1, Timing(5.0, 0.2, "filtered", 0.8)),
}


def test_a_branch_goes_round_a_circle():
    """x^2 + p^2 = 1: both folds are points like others."""

    def circle(z):
        return np.array([z @ z - 1.0]), 2.0 * z[None, :]

    up = np.array([0.0, 1.0])
    start = advance(np.array([1.0, 0.01]), up, 0.0, circle)[0]
    points = np.array([point.z for point in islice(branch(start, up, circle, 0.1), 80)])
    assert np.linalg.norm(points, axis=1) == pytest.approx(1.0, abs=1e-9)
    assert points.min(axis=0) == pytest.approx(-1.0, abs=3e-3)
    assert points.max(axis=0) == pytest.approx(1.0, abs=3e-3)


@pytest.mark.parametrize("name", LOOPS)
def test_a_small_orbit_stands_at_the_flip_of_the_loop_that_it_damps(name):
    """(s - flip)/|u| tends to `softness`, which knows linear theory alone: half the orbit, half of what is left."""
    loop, flip = LOOPS[name], flip_at(PLANT, LOOPS[name])
    left = []
    for size in (2e-3, 1e-3):
        orbit = next(orbits(PLANT, loop, first=size))
        left.append((orbit.s - flip) / orbit.opening - softness(PLANT, loop))
        assert orbit.points[1] == pytest.approx(mirrored(orbit.points[0]), abs=1e-8)
    assert abs(left[1]) < 0.05 * abs(softness(PLANT, loop))
    assert left[1] / left[0] == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("name", ["soft", "late", "filter"])
def test_multipliers_are_those_of_finite_differences(name):
    orbit = list(islice(orbits(PLANT, LOOPS[name]), 8))[-1]
    loop, x, size = LOOPS[name]._replace(s=orbit.s), orbit.points[0], 1e-6

    def twice(x: np.ndarray) -> np.ndarray:
        return period(period(x, PLANT, loop)[0], PLANT, loop)[0]

    assert twice(x) == pytest.approx(x, abs=1e-9)
    seen = np.linalg.eigvals(
        np.transpose([(twice(x + size * e) - twice(x - size * e)) / (2 * size) for e in np.eye(len(x))])
    )
    assert np.sort(np.abs(seen)) == pytest.approx(np.sort(np.abs(orbit.multipliers)), rel=1e-3, abs=1e-4)


def test_a_hard_flip_has_unstable_orbits_below_it_and_stable_ones_past_a_fold():
    """One multiplier passes 1 at the fold, and runs on either side of it agree."""
    flip = flip_at(PLANT, LOOPS["hard"])
    assert flip == pytest.approx(critical_gain(0.0, 0.1, 0.23, Timing(10.0)), rel=1e-9)
    found = list(islice(orbits(PLANT, LOOPS["hard"]), 40))
    gains, stable = np.array([orbit.s for orbit in found]), np.array([orbit.stable for orbit in found])
    fold = int(np.argmin(gains))
    assert gains[fold] < 0.97 * flip < flip < gains[-1]
    assert not stable[:fold].any()
    assert stable[fold + 1 :].all()
    assert min(abs(found[i].multipliers - 1.0).min() for i in (fold - 1, fold, fold + 1)) < 0.1
    wide = oscillations(PLAIN._replace(tau=10.0, s=[gains[fold] * 0.995, gains[fold] * 1.005], start=3.0))
    np.testing.assert_array_equal(wide.oscillates, [False, True])


def test_a_run_comes_to_the_stable_orbit():
    orbit = next(orbit for orbit in orbits(PLANT, LOOPS["soft"]) if orbit.opening > 2e-3)
    assert orbit.stable
    run = simulate(displaced(1e-3), PLANT.actuator, LOOPS["soft"]._replace(s=orbit.s), 600, tolerance=1e-10)
    ends = run.states[-2:] if run.states[-2, 0] * orbit.points[0, 0] > 0.0 else run.states[-2:][::-1]
    assert ends == pytest.approx(orbit.points, abs=1e-6)


def test_a_loop_without_a_flip_has_none():
    with pytest.raises(ValueError, match="no multiplier of this loop passes -1"):
        next(orbits(PLANT, controller(0.0, 0.2, Timing(3.0, 0.6))))
