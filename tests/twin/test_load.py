"""The weight that waits on its support: when it is met, how the speeds become one, what is lost and what is kept."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.load import (
    Load,
    Weight,
    buffer_stiffness,
    carried_mass,
    contact_force,
    kick_weight,
    move_weight,
    pick_up,
    weight_at,
)

H, SUPPORT = 10e-6, 0.138


def load(mass: float = 120.0, added: float = 183.0, gravity: float = 0.0, half_period: float = 3e-3) -> Load:
    return Load(mass, gravity, 0.0, added, SUPPORT, buffer_stiffness(added, half_period))


def meet(v: float, held: Load, seconds: float) -> list[tuple[float, float, Weight]]:
    """A free piston runs into the weight: (position, speed, weight) step by step, as the plant moves them."""
    x, weight, seen = SUPPORT - 1e-4, Weight(SUPPORT, 0.0, 0.0), []
    for _ in range(round(seconds / H)):
        for half in range(2):
            push = contact_force(x, weight, held)
            v -= 0.5 * H * push / held.mass
            weight = kick_weight(weight, push, held, 0.5 * H)
            if half == 0:
                x += H * v
                weight = move_weight(weight, x, held, H)
        v, weight = pick_up(x, v, weight, held)
        seen.append((x, v, weight))
    return seen


@given(st.floats(0.05, 0.5), st.floats(60.0, 400.0), st.floats(20.0, 400.0))
def test_momentum_is_kept_and_the_speeds_become_one(v: float, mass: float, added: float):
    """v' = m v/(m + M), to rounding: the buffer's forces are equal and opposite in every step."""
    _, speed, weight = meet(v, load(mass, added), 8e-3)[-1]
    assert weight.carried == 1.0
    assert speed == pytest.approx(mass * v / (mass + added), rel=1e-9)


def test_it_takes_a_quarter_period_on_the_buffer():
    """Relative motion on k = M (pi/3 ms)^2 with the reduced mass: (pi/2) sqrt(mu/k) from touch to one speed."""
    held, v = load(), 0.38
    seen = meet(v, held, 8e-3)
    touch = next(i for i, (x, _, _) in enumerate(seen) if x > SUPPORT)
    one = next(i for i, (_, _, weight) in enumerate(seen) if weight.carried)
    reduced = 120.0 * 183.0 / 303.0
    assert (one - touch) * H == pytest.approx(0.5 * math.pi * math.sqrt(reduced / held.stiffness), abs=2 * H)


def test_the_half_period_is_that_of_the_weight_against_a_wall():
    """A piston that nothing stops swings the weight up to twice its speed in 3 ms."""
    held = load(mass=1e9)
    seen = meet(0.38, held, 5e-3)
    touch = next(i for i, (x, _, _) in enumerate(seen) if x > SUPPORT)
    one = next(i for i, (_, _, weight) in enumerate(seen) if weight.carried)
    assert 2 * (one - touch) * H == pytest.approx(3e-3, abs=4 * H)


@given(st.floats(0.05, 0.5))
def test_energy_is_only_lost(v: float):
    """Kinetic energies and the buffer's: never above the piston's at first; the leapfrog's ripple is (omega h)^2/4."""
    held = load()
    before = 0.5 * held.mass * v**2
    for x, speed, weight in meet(v, held, 8e-3):
        pressed = 0.0 if weight.carried else max(0.0, x - weight.position)
        moving = 0.5 * carried_mass(weight, held) * speed**2 + 0.5 * held.stiffness * pressed**2
        moving += 0.0 if weight.carried else 0.5 * held.added * weight.velocity**2
        assert moving <= before * (1.0 + 1e-4)


def test_the_support_carries_it_until_it_is_lifted_and_again_when_it_is_set_down():
    held = load(gravity=9.81)
    resting = Weight(SUPPORT, 0.0, 0.0)
    assert kick_weight(resting, 0.0, held, 1.0) == resting
    carried = Weight(0.15, 0.0, 1.0)
    assert move_weight(carried, 0.14, held, H) == Weight(0.14, 0.0, 1.0)
    assert move_weight(carried, 0.137, held, H) == Weight(SUPPORT, 0.0, 0.0)


def test_a_start_above_the_support_carries_it():
    held = load()
    assert carried_mass(weight_at(0.2, held), held) == 303.0
    assert carried_mass(weight_at(0.1, held), held) == 120.0
    assert carried_mass(weight_at(0.2, load(added=0.0)), held._replace(added=0.0)) == 120.0


def test_a_piston_that_rests_at_the_support_carries_the_weight_and_one_below_does_not():
    assert weight_at(SUPPORT, load()) == Weight(SUPPORT, 0.0, 1.0)
    assert weight_at(math.nextafter(SUPPORT, 0.0), load()) == Weight(SUPPORT, 0.0, 0.0)
    assert weight_at(SUPPORT, load(added=0.0)).carried == 0.0
