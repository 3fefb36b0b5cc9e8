"""Oil of a line or manifold without inertia and friction: one volume with two ends.

What both ends bring is stored, P' = (q_1 + q_2)/C, C = V/B. In steps, with Z = h/C, Z_e = (1 + e) Z, e = 1/4, the sum
g = q_1 + q_2 and the difference f = q_1 - q_2 of the instant before:

    p_1 = P + Z_e q_1 - (Z_e f + e Z g)/2,   p_2 = P + Z_e q_2 + (Z_e f - e Z g)/2,   then  P <- P + Z (q_1 + q_2)

Ends alike see the trapezoidal rule, and C P is the oil to the last bit; e adds an inertance that keeps flows from
swinging from step to step where both ends stand at vapour. Ends opposite see p_1 - p_2 = Z_e (f_now - f): no steady
drop, an inertance 2 h Z_e beside a resistance 4 Z_e. It must not be less, since ends do not know each other within a
step; it is that of 4 cm of pipe of 11 mm for 20 cm^3 at 50 us, and falls with the square of the step.

Passive for any step and size: a step gives h (p_1 q_1 + p_2 q_2) = C/2 (P_now^2 - P^2) + h Z_e/4 (f_now^2 - f^2) +
h e Z/4 (g_now^2 - g^2) to the stores and h Z_e/4 (f_now - f)^2 + h e Z/4 (g_now - g)^2 to heat.

Where both ends stand at vapour nothing drives a flow between them, and its store is emptied by half in each step.

Memory of a line: P, q_1, q_2, p_1, p_2, then the elements of the wall of end 1 and of end 2.
"""

import numpy as np
from numpy.typing import NDArray

from twin.kernel import inlined, kernel
from twin.lines import wall
from twin.lines.spec import LineNumbers
from twin.lines.wall import creep_port, inner_flow

WALL = 5  # in the memory of a line
SIZE = WALL + 2 * wall.ELEMENTS
PRESSURES_AT = np.array([0, 3, 4])  # in it
CALM = 0.25  # e
AT_VAPOUR = 1.0  # [Pa]
Z, Z_END, CREEPS, CREEP = range(4)
NUMBERS = CREEP + wall.NUMBERS


def coefficients(line: LineNumbers, step: float) -> NDArray[np.float64]:
    """Of a line; any step will do."""
    z = step / line.capacity
    return np.array([z, (1.0 + CALM) * z, float(bool(line.creep)), *wall.wall_numbers(line, step)])


def inertance(line: LineNumbers, step: float) -> float:
    """What the scheme puts between the ends [Pa s^2/m^3]."""
    return 2.0 * (1.0 + CALM) * step**2 / line.capacity


@inlined
def _free(m, n, own: float, other: float) -> float:
    """c of an end; own, other: flows of the instant before."""
    return m[0] - (n[Z_END] - 0.5 * n[Z]) * own + 0.5 * n[Z] * other


@kernel
def arriving(lines, place, numbers, memory, c, z) -> None:
    """Fill c and Z of the ends of these lines. Reads only."""
    for k in range(len(lines)):
        i, m, n = lines[k], memory[place[k] :], numbers[k]
        c[2 * i], c[2 * i + 1] = _free(m, n, m[1], m[2]), _free(m, n, m[2], m[1])
        z[2 * i] = z[2 * i + 1] = n[Z_END]
        if n[CREEPS] > 0.0:
            for end in range(2):
                e = 2 * i + end
                c[e], z[e] = creep_port(c[e], z[e], n[CREEP:], m[WALL + end * wall.ELEMENTS :])


@kernel
def departing(lines, place, numbers, memory, q, vapour_pressure: float) -> None:
    """Take the flows [m^3/s] of the instant and move on to the next."""
    for k in range(len(lines)):
        i, m, n = lines[k], memory[place[k] :], numbers[k]
        q_1, q_2, c_1, c_2 = q[2 * i], q[2 * i + 1], _free(m, n, m[1], m[2]), _free(m, n, m[2], m[1])
        if n[CREEPS] > 0.0:
            q_1 = inner_flow(c_1, n[Z_END], q_1, n[CREEP:], m[WALL:])
            q_2 = inner_flow(c_2, n[Z_END], q_2, n[CREEP:], m[WALL + wall.ELEMENTS :])
        m[3], m[4] = c_1 + n[Z_END] * q_1, c_2 + n[Z_END] * q_2
        m[0] += n[Z] * (q_1 + q_2)
        m[1], m[2] = q_1, q_2
        if max(m[3], m[4]) < vapour_pressure + AT_VAPOUR:
            m[1], m[2] = 0.75 * q_1 + 0.25 * q_2, 0.25 * q_1 + 0.75 * q_2


@kernel
def settle(lines, place, numbers, memory, p, q) -> None:
    """Steady flows from end 1 to end 2 since ever, under the pressures p at the ends, which are alike."""
    for k in range(len(lines)):
        i, m = lines[k], memory[place[k] :]
        p_1, p_2 = p[2 * i], p[2 * i + 1]
        m[0], m[1], m[2], m[3], m[4] = 0.5 * (p_1 + p_2), q[i], -q[i], p_1, p_2
        for j in range(wall.ELEMENTS):
            m[WALL + j], m[WALL + wall.ELEMENTS + j] = p_1, p_2


@kernel
def profile(place: int, memory, xi, out) -> None:
    """Pressure [Pa] at places xi after `departing`: linear between the ends."""
    for i in range(len(xi)):
        out[i] = memory[place + 3] + xi[i] * (memory[place + 4] - memory[place + 3])
