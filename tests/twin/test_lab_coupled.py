"""A line solved together with a cylinder or a valve: exact modes, Joukowsky, bounded work."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from twin.lines.lab.attached import chamber, given, valve, wall
from twin.lines.lab.coupled import CoupledLine, march_coupled
from twin.lines.lab.friction import friction
from twin.lines.lab.pipe import Pipe
from twin.lines.lab.space import grid
from twin.lines.lab.system import State

PIPE = Pipe(2.0, 0.011, 1000.0, 878.0, 40e-6)
IMPEDANCE = PIPE.hammer / PIPE.area
MODULUS, AREA, VOLUME, MASS, REST = 1.2e9, 1.16e-3, 5e-5, 120.0, 20e5


def test_a_mass_on_a_chamber_behind_a_line_swings_in_its_exact_mode():
    """Shut at the left: m w^2 (V w/B + tan(w T)/Z) = A^2 w. Begun in that mode, a cycle later it is back, also in the
    second mode, in which the line is more than a quarter of a wave long."""

    def mode(omega: float) -> float:
        return MASS * omega * (VOLUME * omega / MODULUS + math.tan(omega * PIPE.travel_time) / IMPEDANCE) - AREA**2

    quarter = 0.5 * math.pi / PIPE.travel_time
    for low, high in ((1.0, 0.99 * quarter), (1.2 * quarter, 2.2 * quarter)):
        omega: Any = brentq(mode, low, high)
        found, start = mode_after_a_cycle(omega)
        assert found == pytest.approx(start, abs=2e-3 * np.abs(start).max())


def mode_after_a_cycle(omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressures over REST [Pa] in the line after a cycle, and before."""
    piston = chamber(
        AREA, VOLUME, MODULUS, MASS, lambda t: -AREA * REST, lambda t, p: 0.0, 0.0, REST, (1e-13, 1e-8, 1e-7)
    )
    places = grid("chebyshev", 16, PIPE.length)
    line = CoupledLine(PIPE, places, friction("none"), (wall(IMPEDANCE), piston), REST)
    shape = 1e3 * np.cos(omega * places.x / PIPE.speed)  # 0.01 bar: the chamber's volume stays
    stored, x = line.start.z[:2]
    x = x - AREA * shape[-1] / (MASS * omega**2)  # m x'' = A p
    stored = (VOLUME + AREA * x) * (1.0 + (REST + shape[-1]) / MODULUS)
    y = np.concatenate([REST + shape, np.zeros(len(shape))])
    line.start = line.start._replace(line=State(y, line.start.line.w), z=np.array([stored, x, 0.0]), p=y[line.rows])
    *_, (t, last) = march_coupled(line, "esdirk4", 0.1, 2.0 * math.pi / omega, 3000)
    assert t == pytest.approx(2.0 * math.pi / omega)
    return last.line.y[: len(shape)] - REST, shape


def test_a_valve_that_shuts_makes_joukowskys_pressure_and_holds_no_flow():
    """Steady through the land first: supply - outlet = a Q^2 + b Q + friction; then rho a v less, and Q = 0."""
    a, b = 4e5 / (2e-4) ** 2, 0.0
    shut = 0.25
    land = valve(
        lambda t: 30e5, lambda t: float(np.interp(t, (0.0, 0.01, shut, shut + 1e-3), (0, 1, 1, 0))), a, b, IMPEDANCE
    )
    line = CoupledLine(PIPE, grid("fem", 40, PIPE.length), friction("steady"), (land, given(lambda t: 10e5)), 10e5)
    course = list(march_coupled(line, "esdirk4", 300.0, shut + 3e-3, 6000, 2e-3))
    times = np.array([t for t, _ in course])
    before, after = course[int(np.searchsorted(times, shut)) - 1][1], course[-1][1]
    flow = -before.q[0]
    drop = PIPE.steady_rate * PIPE.density * PIPE.length * flow / PIPE.area
    assert a * flow**2 + drop == pytest.approx(20e5, rel=2e-3)
    assert before.q[1] == pytest.approx(flow, rel=2e-3)  # what goes in comes out
    assert before.p[0] - after.p[0] == pytest.approx(IMPEDANCE * flow, rel=0.03)  # friction gives some of it back
    assert abs(after.q[0]) < 1e-3 * flow


def test_a_tighter_tolerance_takes_more_steps_and_gives_less_error():
    """Against a run at a hundredth of the finer one."""

    def run(tolerance: float) -> tuple[int, float]:
        def push(t):
            return 20e5 + 10e5 * float(np.sin(min(t / 0.02, 1.0) * 0.5 * math.pi) ** 2)

        tolerated = 1e-14 * tolerance, 1e-9 * tolerance, 1e-8 * tolerance
        piston = chamber(AREA, VOLUME, MODULUS, MASS, lambda t: -AREA * REST, lambda t, p: 0.0, 0.0, REST, tolerated)
        line = CoupledLine(PIPE, grid("fem", 12, PIPE.length), friction("kagawa"), (given(push), piston), REST)
        course = list(march_coupled(line, "esdirk4", tolerance, 0.05, 5000))
        return len(course), float(course[-1][1].z[1])

    (few, coarse), (many, fine), (_, right) = run(1000.0), run(30.0), run(1.0)
    assert many > few
    assert abs(fine - right) < 0.3 * abs(coarse - right) + 1e-9


def test_work_is_bounded():
    line = CoupledLine(
        PIPE, grid("fem", 8, PIPE.length), friction("none"), (given(lambda t: 30e5), wall(IMPEDANCE)), REST
    )
    with pytest.raises(ValueError, match="10 steps reach"):
        list(march_coupled(line, "esdirk4", 1e-3, 1.0, 10))
