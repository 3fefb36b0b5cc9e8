"""The moving body of a valve: a damped oscillator between two stops, or a lag."""

import math

import pytest

from twin.contact import Stops
from twin.valve_body import MOST_SUBSTEPS, Mass, first_order_body, mass_body, move_body, steady_lift

STOPS = Stops(stroke=1e-3, restitution=0.3, rest_speed=1e-4)
MASS, STIFFNESS = 0.05, 40e3


def moved(body, lift: float, speed: float, force: float, step: float, seconds: float) -> tuple[float, float]:
    for _ in range(round(seconds / step)):
        lift, speed = move_body(body, lift, speed, force, 0.0, step)
    return lift, speed


@pytest.mark.parametrize("share", [0.1, 0.7])
def test_it_swings_as_the_damped_oscillator(share: float):
    """x = F/k (1 - e^-at (cos wt + a/w sin wt)) after 3.3 ms; substeps of 0.25 rad: within 1 % of the steady lift."""
    step, seconds, force = 100e-6, 3.3e-3, 16.0
    damping = 2.0 * share * math.sqrt(MASS * STIFFNESS)
    body = mass_body(MASS, damping, STIFFNESS, STOPS, step)
    a = damping / (2.0 * MASS)
    w = math.sqrt(STIFFNESS / MASS - a * a)
    exact = force / STIFFNESS * (1.0 - math.exp(-a * seconds) * (math.cos(w * seconds) + a / w * math.sin(w * seconds)))
    assert moved(body, 0.0, 0.0, force, step, seconds)[0] == pytest.approx(exact, abs=0.01 * force / STIFFNESS)


def test_the_error_falls_with_the_square_of_the_step():
    damping, force, seconds = 10.0, 16.0, 4e-3
    ends = [
        moved(mass_body(MASS, damping, STIFFNESS, STOPS, h)._replace(substeps=1.0), 0.0, 0.0, force, h, seconds)[0]
        for h in (100e-6, 50e-6, 25e-6)
    ]
    assert (ends[0] - ends[1]) / (ends[1] - ends[2]) == pytest.approx(4.0, abs=0.2)


def test_without_damping_the_energy_of_spring_and_mass_stays():
    """The midpoint rule keeps a quadratic invariant at any step, here 2.5 rad long: 1e-9 is rounding."""
    body = Mass(MASS, 0.0, STIFFNESS, STOPS, 1.0)
    lift, speed = 0.2e-3, 0.1
    start = 0.5 * MASS * speed**2 + 0.5 * STIFFNESS * (lift - 0.5e-3) ** 2
    for _ in range(1000):
        lift, speed = move_body(body, lift, speed, 0.5e-3 * STIFFNESS, 0.0, 2.8e-3)
        now = 0.5 * MASS * speed**2 + 0.5 * STIFFNESS * (lift - 0.5e-3) ** 2
        assert now == pytest.approx(start, rel=1e-9)


def test_an_impact_has_its_own_instant_and_restitution():
    """No spring to speak of, 1 m/s at 0.1 mm from the upper stop: 0.1 ms there, 0.1 ms back at 0.3 m/s."""
    body = Mass(MASS, 0.0, 1e-6, STOPS, 1.0)
    lift, speed = move_body(body, 0.9e-3, 1.0, 0.0, 0.0, 0.2e-3)
    assert speed == pytest.approx(-0.3, rel=1e-6)
    assert lift == pytest.approx(1e-3 - 0.3 * 0.1e-3, rel=1e-6)


@pytest.mark.parametrize("force", [-5.0, 500.0])
def test_a_pressed_body_comes_to_rest_at_its_stop_without_gain(force: float):
    """Bounces die: energy never rises, and the stop holds the body exactly."""
    body = mass_body(MASS, 0.0, STIFFNESS, STOPS, 100e-6)
    lift, speed, before = 0.5e-3, 0.0, math.inf
    for _ in range(400):
        lift, speed = move_body(body, lift, speed, force, 0.0, 100e-6)
        energy = 0.5 * MASS * speed**2 + 0.5 * STIFFNESS * lift**2 - force * lift
        assert energy <= before + 1e-6 * abs(force) * STOPS.stroke
        before = energy
    assert (lift, speed) == ((1e-3, 0.0) if force > 0.0 else (0.0, 0.0))
    assert steady_lift(body, force) == lift


def test_the_lag_approaches_its_steady_lift_exponentially():
    """T = 2 ms: 1 - 1/e of F/k after 2 ms."""
    body = first_order_body(2e-3, STIFFNESS, 1e-3, 50e-6)
    assert moved(body, 0.0, 0.0, 16.0, 50e-6, 2e-3)[0] == pytest.approx(0.4e-3 * (1.0 - math.exp(-1.0)), rel=1e-9)
    assert move_body(first_order_body(0.0, STIFFNESS, 1e-3, 50e-6), 0.0, 0.0, 16.0, 0.0, 50e-6)[0] == 0.4e-3


def test_a_light_body_has_many_substeps_and_no_more_than_a_bound():
    assert mass_body(1e-9, 0.0, STIFFNESS, STOPS, 100e-6).substeps == MOST_SUBSTEPS
    assert mass_body(MASS, 0.0, STIFFNESS, STOPS, 100e-6).substeps == 1.0
