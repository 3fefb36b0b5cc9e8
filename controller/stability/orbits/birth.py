"""Where periodic orbits begin: the relay's at d_H with no amplitude and no period, the proportional one's at s_crit.

Source: 5.3.3 and 5.4.2, their own approximations here. Small orbits of the relay are those of its linear loop about
y3 = y4 = 1/2, in closed form: z' = A z + b u, u = 1 over half a period T, z(T) = -z(0).

The proportional loop has a term of second order that a smooth loop cannot have. Near u = 0,

    a' = -2 z2 + sqrt2 gamma (u - |u| a/(2 alpha)) + ...,    a = alpha (y3 - y4):

an opening of either sign lets the pressures even out, as a leak would. Harmonic balance is exact to first order in the
amplitude: with z1 = Re e^(i omega t), and p, q the complex amplitudes of a and u, the part of |u| a at omega is

    c = |q| (2/pi p + 2/(3 pi) p* q^2/|q|^2),    p* the conjugate,

and s rises with the amplitude by at least 4/(3 pi) |q| (omega^2 + k^2)/(2 alpha) > 0. So every loop with k > 0 is born
soft, with stable orbits above s_crit. The thesis found an unstable one below. That is what a boundary value problem
finds whose arcs keep their branch of (5.8) when the amplitude passes through 0 and u changes its sign: `arc.CROSSED`,
where the leak has the other sign.
"""

import math

import numpy as np
from scipy.linalg import expm

from controller.stability.actuator.analogue import analogue_edge, analogue_frequency
from controller.stability.actuator.model import Actuator, Array, Feedback
from controller.stability.orbits.arc import CROSSED, PROPORTIONAL, RELAY
from controller.stability.orbits.limit_cycle import Orbit, analogue_loop, solve

SQRT2 = math.sqrt(2.0)


def linear_relay_orbit(half_period: float, s: float, actuator: Actuator) -> tuple[Array, float]:
    """(y1, y2, alpha (y3 - y4)) at the switch to u = 1, and the d at which this is the linear loop's half-period."""
    alpha, gamma, k = actuator
    matrix = np.zeros((4, 4))
    matrix[:3] = [[0, 1, 0, 0], [0, -k, 1, 0], [0, -2, -gamma / (SQRT2 * alpha), SQRT2 * gamma]]
    over = expm(matrix * half_period)
    z = -np.linalg.solve(np.eye(3) + over[:3, :3], over[:3, 3])
    return z, float(-s * z[0] / z[1])


def relay_birth(actuator: Actuator, s: float, half_period: float) -> Orbit:
    """The relay's orbit of a short half-period. ArithmeticError where the linear orbit is not a guess for it."""
    z, d = linear_relay_orbit(half_period, s, actuator)
    guess = Orbit(
        analogue_loop(RELAY, actuator, Feedback(s, d)),
        _start(z[0], z[1], z[2] / actuator.alpha),
        np.array([half_period]),
    )
    return solve(guess, "d", -2)


def proportional_birth(actuator: Actuator, d: float, speed: float, kind: int = PROPORTIONAL) -> Orbit:
    """The orbit of a PROPORTIONAL or CROSSED loop with y2 = -speed at the switch, speed > 0 small against alpha.

    ValueError without damping: there is no edge. ArithmeticError where the linear orbit is not a guess for it.
    """
    alpha, gamma, k = actuator
    if k <= 0.0 or kind not in (PROPORTIONAL, CROSSED):
        raise ValueError(f"an orbit is born at an edge of a proportional loop with k above 0, not with k {k}")
    edge, omega = float(analogue_edge(d, k, gamma)), float(analogue_frequency(d, gamma))
    y1, y2 = speed * d / edge, -speed
    node = _start(y1, y2, (k * y2 - omega**2 * y1) / alpha)  # y2' = -omega^2 y1 on the linear orbit
    loop = analogue_loop(kind, actuator, Feedback(edge, d))
    return solve(Orbit(loop, node, np.array([math.pi / omega])), "s", 1)


def _start(y1: float, y2: float, difference: float) -> Array:
    return np.array([[y1, y2, 0.5 + 0.5 * difference, 0.5 - 0.5 * difference]])


def birth_slopes(d: float, actuator: Actuator) -> tuple[float, float]:
    """d s/d speed and d T/d speed of the proportional loop at its birth, T the half-period; by harmonic balance."""
    alpha, gamma, k = actuator
    s, omega = float(analogue_edge(d, k, gamma)), float(analogue_frequency(d, gamma))
    p, q = complex(-(omega**2), k * omega), -complex(s, d * omega)
    leak = abs(q) * 2.0 / math.pi * (p + p.conjugate() * q**2 / (3.0 * abs(q) ** 2))
    leak *= SQRT2 * gamma / (2.0 * alpha)
    faster = leak.imag / (2.0 * omega**2)
    larger = (2.0 * k * omega * faster - leak.real) / (SQRT2 * gamma)
    speed = omega * s / math.hypot(s, d * omega)  # |y2| at the switch of an orbit with y1 = cos omega t
    return larger / speed, -math.pi / omega**2 * faster / speed
