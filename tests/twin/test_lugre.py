"""LuGre friction: presliding, the curve of steady sliding, energy, and scipy's Radau on its equations."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.mechanics import SLOT, moves
from twin.environment import Environment
from twin.friction import friction_force, slide
from twin.integration import integrate
from twin.load_slot import HeldLoad
from twin.lugre import LuGre
from twin.stribeck import Stribeck

BRISTLES = LuGre(Stribeck(1.0, 1.5, 0.001, 0.4, 0.0, 1.0), 1e5, math.sqrt(1e5))  # of the paper, 1 kg


def memory(z: float = 0.0) -> np.ndarray:
    bent = np.zeros(SLOT)
    bent[0] = z
    return bent


def test_in_presliding_the_bristles_are_a_spring_with_a_damper():
    """A hundredth of the break-away force: the mass swings to F/sigma_0 as m z'' + (s_1 + s_2) z' + s_0 z = F does."""
    force, h = 0.015, 2e-5
    omega, decay = math.sqrt(1e5), 0.5 * (math.sqrt(1e5) + 0.4)
    damped = math.sqrt(omega**2 - decay**2)
    mass, v, bent, seen = 1.0, 0.0, memory(), []
    for _ in range(1000):
        v = slide(BRISTLES, v, force, mass, 0.0, bent, h)
        seen.append(bent[0])
    t = h * np.arange(1, 1001)
    swing = np.exp(-decay * t) * (np.cos(damped * t) + decay / damped * np.sin(damped * t))
    assert np.abs(np.array(seen) / (force / 1e5) - (1.0 - swing)).max() < 0.01  # sigma_0 |v| z/g bends it by F/F_c


@pytest.mark.parametrize("v", [2e-4, 1e-3, 5e-3, 0.2, -0.2, -1e-3])
@pytest.mark.parametrize("negative", [1.0, 0.6])
def test_steady_sliding_follows_the_stribeck_curve(v: float, negative: float):
    """Bristles at g/sigma_0: F = F_c + (F_s - F_c) exp(-(v/v_s)^2) + s_2 v, of any mass that is held at this speed."""
    kind, bent = BRISTLES._replace(curve=BRISTLES.curve._replace(negative=negative)), memory()
    for _ in range(2000):
        slide(kind, v, 0.0, 1e12, 0.0, bent, 1e-2 * abs(1e-3 / v))
    expected = (1.0 + 0.5 * math.exp(-((v / 1e-3) ** 2)) + 0.4 * abs(v)) * (negative if v < 0.0 else 1.0)
    assert friction_force(kind, v, 0.0, 0.0, bent) == pytest.approx(-math.copysign(expected, v), rel=1e-9)


@given(st.floats(-0.5, 0.5), st.floats(-2e-5, 2e-5), st.floats(1e-6, 1e-1), st.floats(0.1, 10.0))
def test_it_creates_no_energy_whatever_the_step(v: float, z: float, time: float, mass: float):
    """Kinetic energy and that of the bristles, s_0 z^2/2, without a drive."""
    bent, energy = memory(z), 0.5 * mass * v * v + 0.5e5 * z * z
    for _ in range(20):
        v = slide(BRISTLES, v, 0.0, mass, 0.0, bent, time)
        then = 0.5 * mass * v * v + 0.5e5 * bent[0] ** 2
        assert then <= energy * (1.0 + 1e-12)
        energy = then


def stick_slip(step: float, seconds: float) -> np.ndarray:
    """Places of a mass of 1 kg that a spring of 2 N/m pulls with its end at 1 m/s."""
    pulled = HeldLoad(1.0, 0.0, 0.0, Environment(2.0, 0.0, 0.0, 0.0))
    count = round(seconds / step)
    motion = moves(pulled, lambda t: 2.0 * t, (0.0, 0.0), step, count, friction=BRISTLES)
    return np.array([x for x, _, _ in motion])


def test_stick_slip_agrees_with_radau_and_the_step_is_of_second_order():
    """It breaks away after 0.75 s; the error at 1 s, in the slip, is a quarter at half the step."""
    sigma, sigma_1 = BRISTLES.stiffness, BRISTLES.damping

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        level = 1.0 + 0.5 * math.exp(-((v / 1e-3) ** 2))
        bending = v - sigma * abs(v) / level * z
        damping = sigma_1 if sigma_1 * abs(v) <= 4.0 * level else 4.0 * level / abs(v)
        return [v, 2.0 * (t - x) - sigma * z - damping * bending - 0.4 * v, bending]

    found = integrate(rates, (0.0, 1.0), [0.0, 0.0, 0.0], "Radau", most=200_000, rtol=1e-9, atol=1e-13)
    exact = found.y[0, -1]
    coarse, fine = (abs(stick_slip(step, 1.0)[-1] - exact) for step in (2e-4, 1e-4))
    assert exact > 0.01
    assert fine < 1e-4 * exact
    assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.4)
