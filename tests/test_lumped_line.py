"""Lumped line: friction, inertia, and the first mode of a real line."""

import math

import pytest
from scipy.integrate import solve_ivp

from twin.lines.lumped import accelerate, line_resistance, lumped_line, resistance_slope, turbulence

LINE = lumped_line(length=2.5, diameter=11e-3, modulus=1.135e9, density=878.0, viscosity=40e-6, fitting=0.0)


def test_laminar_friction_is_hagen_poiseuille():
    """26.7 l/min through 2.5 m: 32 mu L v/d^2."""
    q = 26.7e-3 / 60.0
    v = q / (math.pi / 4.0 * 11e-3**2)
    assert line_resistance(q, LINE) * q == pytest.approx(32.0 * 878.0 * 40e-6 * 2.5 * v / 11e-3**2, rel=1e-12)


def test_turbulent_friction_is_blasius():
    """Re 10000: lambda = 0.3164 Re^-1/4, against 64/Re."""
    assert turbulence(1e4) == pytest.approx(0.3164 * 1e4**-0.25 / (64.0 / 1e4), rel=1e-12)


@pytest.mark.parametrize("reynolds", [2300.0, 4000.0])
def test_friction_is_continuous_through_transition(reynolds: float):
    assert turbulence(reynolds * (1.0 + 1e-12)) == pytest.approx(turbulence(reynolds * (1.0 - 1e-12)), rel=1e-10)


@pytest.mark.parametrize("reynolds", [1000.0, -1000.0, 3000.0, 8000.0, -8000.0])
def test_slope_is_that_of_the_pressure_drop(reynolds: float):
    line, q = LINE._replace(fitting=1e7), reynolds / LINE.reynolds_per_flow
    above, below = ((q + d) * line_resistance(q + d, line) for d in (1e-5 * q, -1e-5 * q))
    assert resistance_slope(q, line) == pytest.approx((above - below) / (2e-5 * q), rel=1e-6)


def test_first_mode_is_10_percent_below_the_quarter_wave():
    """One end closed, the other at constant pressure: sqrt(2) a/l with half of the oil at the end, not (pi/2) a/l."""
    lumped = 1.0 / math.sqrt(LINE.inertance * LINE.end_capacity)
    wave = math.pi / 2.0 * math.sqrt(1.135e9 / 878.0) / 2.5
    assert lumped / wave == pytest.approx(math.sqrt(2.0) / (math.pi / 2.0), rel=1e-12)  # 0.900


@pytest.mark.parametrize(("reynolds", "drop"), [(500.0, 1e5), (10000.0, 20e5)])
def test_acceleration_is_of_second_order(reynolds: float, drop: float):
    """Laminar and turbulent, against scipy: halving the step quarters the error."""
    start = reynolds / LINE.reynolds_per_flow
    exact = solve_ivp(
        lambda _, q: (drop - line_resistance(q[0], LINE) * q) / LINE.inertance,
        (0.0, 0.02), [start], method="DOP853", rtol=1e-12, atol=1e-16,
    ).y[0, -1]  # fmt: skip

    def error(steps: int) -> float:
        q = start
        for _ in range(steps):
            q = accelerate(q, drop, LINE, 0.02 / steps)
        return abs(q - exact)

    assert math.log2(error(20) / error(40)) == pytest.approx(2.0, abs=0.1)
