"""Where the orbits of the analogue loop are born: closed forms, harmonic balance, and plain runs beside the edge."""

import math

import numpy as np
import pytest

from controller.stability.actuator.analogue import analogue_edge, analogue_frequency
from controller.stability.actuator.model import Actuator
from controller.stability.actuator.relay import relay_edge
from controller.stability.orbits.arc import (
    CROSSED,
    PROPORTIONAL,
)
from controller.stability.orbits.birth import (
    birth_slopes,
    linear_relay_orbit,
    proportional_birth,
    relay_birth,
)
from controller.stability.orbits.floquet import (
    attracts,
    peaks,
)
from controller.stability.orbits.limit_cycle import (
    Orbit,
)
from tests.support.orbits import (
    EDGE,
    MOST,
    PLANT,
    D,
    S,
    proportional_branch,
    rates,
)
from twin.integration import integrate


def test_the_linear_relay_orbit_is_half_a_turn_of_the_linear_loop():
    """z(T) = -z(0) and h(z(0)) = 0 by scipy; d falls from d_H by the square of T."""
    alpha, gamma, k = PLANT
    z, d = linear_relay_orbit(0.03, S, PLANT)
    g, root2 = gamma / (math.sqrt(2.0) * alpha), math.sqrt(2.0)

    def linear(_t: float, z: np.ndarray) -> list[float]:
        return [z[1], z[2] - k * z[1], -2.0 * z[1] - g * z[2] + root2 * gamma]

    end = integrate(linear, (0.0, 0.03), z, "RK45", most=MOST, rtol=1e-12, atol=1e-16).y[:, -1]
    assert end == pytest.approx(-z, rel=1e-9)
    assert S * z[0] + d * z[1] == pytest.approx(0.0, abs=1e-15)
    edge = float(relay_edge(S, k, gamma, alpha))
    gaps = [edge - linear_relay_orbit(T, S, PLANT)[1] for T in (2e-3, 1e-3)]
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=1e-3)


def test_the_relay_orbit_vanishes_at_d_h_as_the_linear_one():
    """T and the swing of y3 go to 0 together, y2 as T^2, y1 as T^3, d to 0.2789; errors of second order in T."""
    times = (2e-3, 1e-3)
    found = [relay_birth(PLANT, S, T) for T in times]
    d = [orbit.loop.gains.d for orbit in found]
    edge = (4.0 * d[1] - d[0]) / 3.0
    assert edge == pytest.approx(float(relay_edge(S, *PLANT[::-1])), rel=1e-6)
    assert edge == pytest.approx(0.2789, abs=5e-5)
    tops = np.array([peaks(orbit) - [0.0, 0.0, 0.5, 0.5] for orbit in found])
    assert np.log2(tops[0] / tops[1]) == pytest.approx([3.0, 2.0, 1.0, 1.0], abs=0.01)
    swings = [orbit.starts[0, 2] - 0.5 for orbit in found]
    linear = [0.5 * linear_relay_orbit(T, S, PLANT)[0][2] / PLANT.alpha for T in times]
    gaps = np.array(swings) / linear - 1.0
    assert abs(gaps[0]) < 1e-3
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.02)


def test_the_proportional_orbit_is_born_at_the_edge():
    orbit = proportional_birth(PLANT, D, 1e-8)
    assert orbit.loop.gains.s == pytest.approx(1.4642, abs=5e-5)
    assert math.pi / orbit.lengths[0] == pytest.approx(1.4390, abs=5e-5)
    assert orbit.lengths[0] == pytest.approx(2.1832, abs=5e-5)


@pytest.mark.parametrize(("kind", "sign"), [(PROPORTIONAL, 1.0), (CROSSED, -1.0)])
@pytest.mark.parametrize("plant", [PLANT, Actuator(0.05, 0.23, 1.5)])
def test_gain_and_period_leave_the_edge_as_harmonic_balance_has_it(plant: Actuator, kind: int, sign: float):
    """Both by their chords to two small amplitudes, extrapolated to none; the arcs err by 1e-11 of the supply."""
    edge, half = float(analogue_edge(D, plant.k, plant.gamma)), math.pi / float(analogue_frequency(D, plant.gamma))
    chords = []
    for speed in (2e-3 * plant.alpha, 4e-3 * plant.alpha):
        orbit = proportional_birth(plant, D, speed, kind)
        chords.append(np.array([orbit.loop.gains.s - edge, orbit.lengths[0] - half]) / speed)
    slopes = sign * np.array(birth_slopes(D, plant))
    assert 2.0 * chords[0] - chords[1] == pytest.approx(slopes, rel=3e-4)


def test_every_damped_loop_is_born_soft():
    """ds/d|y2| is at least 4/(3 pi) (omega^2 + k^2)/(2 alpha omega) of what an opening of one amplitude is."""
    least, most = np.log([1e-3, 0.01, 0.01, 0.01]), np.log([0.1, 3.0, 5.0, 5.0])
    for alpha, gamma, k, d in np.exp(np.random.default_rng(8).uniform(least, most, (300, 4))):
        omega = float(analogue_frequency(d, gamma))
        edge = float(analogue_edge(d, k, gamma))
        opening = math.hypot(edge, d * omega) ** 2 / (omega * edge)  # |q| per |y2| at the switch
        bound = 4.0 / (3.0 * math.pi) * opening * (omega**2 + k**2) / (2.0 * alpha)
        assert birth_slopes(d, Actuator(alpha, gamma, k))[0] >= 0.999999 * bound


def swing(orbit: Orbit, start: np.ndarray, periods: int) -> np.ndarray:
    """Greatest |y2| in each of some periods of the proportional loop, from `start`."""
    end, each = periods * orbit.period, 64
    times = np.linspace(0.0, end, each * periods + 1)
    limits = {"t_eval": times, "rtol": 1e-7, "atol": 1e-12}
    y2 = integrate(rates(orbit, 1.0), (0.0, end), start, "DOP853", most=MOST, **limits).y[1, :-1]
    return np.abs(y2).reshape(periods, each).max(axis=1)


@pytest.mark.parametrize("share", [0.1, 3.0])
def test_above_the_edge_every_swing_comes_to_the_orbit(share: float):
    """6 % above: from a tenth of the orbit and from three times it."""
    orbit = proportional_branch(1.06 * EDGE).orbits[-1]
    sizes = swing(orbit, orbit.starts[0] * [share, share, 1.0, 1.0], 120)
    assert sizes[-1] == pytest.approx(peaks(orbit)[1], rel=0.01)
    assert (sizes[-1] - sizes[0]) * (1.0 - share) > 0.0


def test_below_the_edge_there_is_no_orbit_to_repel():
    """6 % below, where the arcs with crossed edges have an unstable orbit: swings inside and far outside it die."""
    ghost = proportional_branch(0.94 * EDGE, CROSSED).orbits[-1]
    loop = ghost._replace(loop=ghost.loop._replace(kind=PROPORTIONAL))
    assert not attracts(ghost)
    for share in (0.3, 10.0):
        sizes = swing(loop, ghost.starts[0] * [share, share, 1.0, 1.0], 30)
        assert sizes[-1] < 0.5 * sizes[0]
        assert (np.diff(sizes[3:]) < 0.0).all()
