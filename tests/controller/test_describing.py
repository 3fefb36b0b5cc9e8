"""The describing function of dry friction against the first harmonic by quadrature, and the energy it takes."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from controller.stability.amplitude.describing import friction_damping, held_speed


def test_the_damping_is_the_first_harmonic_of_the_force_over_the_speed():
    speed, force = 0.02, 800.0
    harmonic = 2.0 / math.pi * quad(lambda t: force * math.sin(t), 0.0, math.pi)[0]  # F sign(sin t) is even about pi
    assert friction_damping(speed, force) == pytest.approx(harmonic / speed, rel=1e-12)


def test_dry_friction_takes_what_its_damping_takes():
    """Work over a period of v = V cos(wt): 4 F V/w, and c V^2 pi/w."""
    speed, force, omega = 0.02, 800.0, 220.0
    time = np.linspace(0.0, 2.0 * math.pi / omega, 100001)
    v = speed * np.cos(omega * time)
    work = np.trapezoid(force * np.abs(v), time)
    assert friction_damping(speed, force) * speed**2 * math.pi / omega == pytest.approx(work, rel=1e-6)
    assert friction_damping(held_speed(3e3, force), force) == pytest.approx(3e3)
