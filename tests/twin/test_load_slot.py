"""Loads in an environment, on a compliant link and on a lever: closed forms, energy, order, scipy's Radau."""

import math

import numpy as np
import pytest

from tests.support.mechanics import end_of, moves
from twin.compliant import Compliant, resting_stretch
from twin.contact import Stops
from twin.environment import Environment, environment_force
from twin.integration import integrate
from twin.lever import Lever, lever_force, lever_mass
from twin.load_slot import HeldLoad
from twin.stribeck import Stribeck
from twin.table import curve_through, value_and_slope

FREE = Environment(0.0, 0.0, 0.0, 0.0)


def nothing(_: float) -> float:
    return 0.0


def order(error, coarse: float) -> float:
    return math.log2(error(coarse) / error(0.5 * coarse))


def test_a_damped_spring_has_its_closed_form_and_the_step_is_of_second_order():
    """50 kg on 2e5 N/m with 2000 N s/m about 0.1 m, released at 0.2 m, after 50 ms."""
    held = HeldLoad(50.0, 0.0, 0.0, Environment(2e5, 0.1, 2000.0, 0.0))
    decay, damped = 20.0, math.sqrt(4000.0 - 400.0)
    swing = math.exp(-decay * 0.05) * (math.cos(damped * 0.05) + decay / damped * math.sin(damped * 0.05))

    def error(step: float) -> float:
        return abs(end_of(held, nothing, (0.2, 0.0), step, round(0.05 / step))[0] - 0.1 - 0.1 * swing)

    assert error(2.5e-4) < 2e-5
    assert order(error, 5e-4) == pytest.approx(2.0, abs=0.1)


def test_quadratic_damping_alone_is_exact():
    """m v' = -d v |v|: v = v0/(1 + d v0 t/m), whatever the step."""
    held = HeldLoad(50.0, 0.0, 0.0, Environment(0.0, 0.0, 0.0, 100.0))
    for way in (1.0, -1.0):
        assert end_of(held, nothing, (0.0, way), 0.1, 10)[1] == pytest.approx(way / 3.0, rel=1e-12)


def test_a_constant_force_reaches_the_speed_at_which_the_dampers_hold_it():
    """3000 N = 1000 v + 2000 v^2 at 1 m/s, gravity of 10 m/s^2 on 50 kg and a force of 500 N cancelling."""
    held = HeldLoad(50.0, 10.0, 500.0, Environment(0.0, 0.0, 1000.0, 2000.0))
    assert end_of(held, lambda _: 3000.0, (0.0, 0.0), 2e-3, 500)[1] == pytest.approx(1.0, rel=1e-9)


def link(around: Environment = FREE, **changes: float) -> Compliant:
    return Compliant(30.0, 60.0, 1e6, 500.0, 0.0, 0.0, around)._replace(**changes)


def test_two_free_masses_keep_their_momentum_and_swing_at_their_frequency():
    """omega^2 = k (1/m_1 + 1/m_2); the stretch crosses zero each half period."""
    free = link(link_damping=0.0)
    omega, h = math.sqrt(1e6 * (1.0 / 30.0 + 1.0 / 60.0)), 2e-5
    crossings, last = [], 1e-3
    for number, (_, v, memory) in enumerate(moves(free, nothing, (0.0, 0.3), h, 2500, memory=(1e-3, -0.15))):
        assert 30.0 * v + 60.0 * memory[1] == pytest.approx(0.0, abs=1e-9)
        if last * memory[0] < 0.0:
            crossings.append(number * h + h * last / (last - memory[0]))
        last = memory[0]
    assert np.diff(crossings).mean() == pytest.approx(math.pi / omega, rel=1e-4)


def test_the_link_damps_as_its_closed_form_and_the_step_is_of_second_order():
    """Relative motion: mu s'' + c s' + k s = 0 with mu = 20 kg, from a stretch of 1 mm at rest."""
    decay = 0.5 * 500.0 / 20.0
    damped = math.sqrt(1e6 / 20.0 - decay**2)

    def error(step: float) -> float:
        _, _, memory = end_of(link(), nothing, (0.0, 0.0), step, round(0.02 / step), memory=(1e-3, 0.0))
        swing = math.cos(damped * 0.02) + decay / damped * math.sin(damped * 0.02)
        return abs(memory[0] - 1e-3 * math.exp(-decay * 0.02) * swing)

    assert error(1e-4) < 2e-6
    assert order(error, 2e-4) == pytest.approx(2.0, abs=0.1)


def test_a_damper_of_any_size_only_takes_energy():
    """Kinetic energies and the link's; a leapfrog's has a ripple of (omega h)^2/4, here 5e-6."""
    for damping in (10.0, 1e4, 1e8):
        energy = 0.5 * 30.0 * 0.3**2
        for _, v, memory in moves(link(link_damping=damping), nothing, (0.0, 0.3), 2e-5, 300):
            then = 0.5 * (30.0 * v**2 + 60.0 * memory[1] ** 2 + 1e6 * memory[0] ** 2)
            assert then <= energy * (1.0 + 2e-5)
            energy = min(energy, then)


def test_it_rests_where_its_forces_are_in_balance_and_the_piston_sticks():
    """Load on a spring of its own; the piston held by 400 N of static friction against 300 N more than its share."""
    around = Environment(2e5, 0.05, 0.0, 0.0)
    held = link(gravity=9.81, force=100.0, around=around)
    stretch = resting_stretch(held, 0.1)
    balance = -60.0 * 9.81 + 100.0 - 1e6 * stretch + environment_force(0.1 + stretch, 0.0, around)
    assert balance == pytest.approx(0.0, abs=1e-9)
    oil = 30.0 * 9.81 - 1e6 * stretch + 300.0
    grip = Stribeck(300.0, 400.0, 0.01, 0.0, 0.0, 1.0)
    x, v, memory = end_of(held, lambda _: oil, (0.1, 0.0), 5e-5, 200, friction=grip, memory=(stretch, 0.0))
    assert (x, v) == (0.1, 0.0)
    assert memory[0] == pytest.approx(stretch, rel=1e-9)


BOOM = Lever(
    20.0,
    curve_through([(0.0, 200.0), (0.3, 600.0), (0.6, 300.0)]),
    curve_through([(0.0, -3000.0), (0.3, -5000.0), (0.6, -2500.0)]),
    9.81,
    0.0,
    FREE,
)


def lift(x: float) -> float:
    """Work of `lever_force` from 0 to a place [J], by Simpson's rule."""
    places = np.linspace(0.0, x, 201)
    values = [lever_force(float(place), BOOM) for place in places]
    weights = np.array([1.0, *[4.0, 2.0] * 99, 4.0, 1.0])
    return float(weights @ values) * (places[1] - places[0]) / 3.0


def test_without_a_force_a_lever_keeps_its_kinetic_energy_to_rounding():
    free = BOOM._replace(lift=curve_through([(0.0, 0.0)]), gravity=0.0)
    for x, v, _ in moves(free, nothing, (0.1, 0.5), 1e-3, 400):
        assert lever_mass(x, free) * v**2 == pytest.approx(lever_mass(0.1, free) * 0.25, rel=1e-12)


def test_a_lever_agrees_with_radau_is_of_second_order_and_keeps_its_energy():
    """m(x) x'' + m'(x) x'^2/2 = F(x) + 4500 N from 0.2 m at 0.4 m/s."""

    def rates(_: float, y: np.ndarray) -> list[float]:
        x, v = y
        slope = value_and_slope(x, BOOM.inertia)[1]
        return [v, (lever_force(x, BOOM) + 4500.0 - 0.5 * slope * v**2) / lever_mass(x, BOOM)]

    exact = integrate(rates, (0.0, 0.4), [0.2, 0.4], "Radau", most=20_000, rtol=1e-11, atol=1e-13).y[0, -1]

    def error(step: float) -> float:
        return abs(end_of(BOOM, lambda _: 4500.0, (0.2, 0.4), step, round(0.4 / step))[0] - exact)

    assert order(error, 4e-3) == pytest.approx(2.0, abs=0.3)
    x, v, _ = end_of(BOOM, lambda _: 4500.0, (0.2, 0.4), 1e-3, 400)
    gained = 0.5 * lever_mass(x, BOOM) * v**2 - 0.5 * lever_mass(0.2, BOOM) * 0.16
    assert gained == pytest.approx(4500.0 * (x - 0.2) + lift(x) - lift(0.2), abs=0.02)


def test_an_end_stop_takes_its_share_of_a_levers_energy():
    """Restitution e leaves e^2 of m(x) v^2, wherever the rebound has got to within the step."""
    free = BOOM._replace(lift=curve_through([(0.0, 0.0)]), gravity=0.0)
    x, v, _ = end_of(free, nothing, (0.5, 0.4), 1e-3, 300, stops=Stops(0.6, 0.5, 1e-3))
    assert v < 0.0
    assert lever_mass(x, free) * v**2 == pytest.approx(0.25 * lever_mass(0.5, free) * 0.16, rel=1e-9)
