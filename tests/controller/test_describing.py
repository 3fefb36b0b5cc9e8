"""Describing functions against the first harmonic by quadrature, and a friction's energy."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from controller.stability.amplitude.describing import dead_band, friction_damping, held_speed, relay, saturation

AMPLITUDES = (0.5, 1.0, 1.3, 4.0, 40.0)


def first_harmonic(function, amplitude: float) -> float:
    """Of a function of A sin t, over A; kinks are given to the quadrature."""
    kinks = sorted({math.asin(min(1.0, 1.0 / amplitude)), math.pi - math.asin(min(1.0, 1.0 / amplitude)), math.pi / 2})
    parts = [0.0, *kinks, math.pi]
    value = sum(
        quad(lambda t: function(amplitude * math.sin(t)) * math.sin(t), low, high)[0] for low, high in pairwise(parts)
    )
    return 2.0 / math.pi * value / amplitude


@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_closed_forms_are_the_first_harmonic(amplitude: float):
    def band(x: float) -> float:
        return max(0.0, x - 1.0)

    assert dead_band(amplitude, 1.0) == pytest.approx(first_harmonic(band, amplitude), abs=1e-9)
    assert saturation(amplitude, 1.0) == pytest.approx(first_harmonic(lambda x: min(x, 1.0), amplitude), abs=1e-9)
    assert relay(amplitude, 0.3) == pytest.approx(first_harmonic(lambda x: 0.3, amplitude), abs=1e-9)


def test_dry_friction_takes_what_its_damping_takes():
    """Work over a period of v = V cos(wt): 4 F V/w, and c V^2 pi/w."""
    speed, force, omega = 0.02, 800.0, 220.0
    time = np.linspace(0.0, 2.0 * math.pi / omega, 100001)
    v = speed * np.cos(omega * time)
    work = np.trapezoid(force * np.abs(v), time)
    assert friction_damping(speed, force) * speed**2 * math.pi / omega == pytest.approx(work, rel=1e-6)
    assert friction_damping(held_speed(3e3, force), force) == pytest.approx(3e3)
