"""Oil of a line or manifold without inertia and friction: one volume with two ends.

What both ends bring is stored, P' = (q_1 + q_2)/C, C = V/B. In steps, with Z = h/C:

    p_1 = P + Z q_1 - Z f/2,   p_2 = P + Z q_2 + Z f/2,   then  P <- P + Z (q_1 + q_2),   f <- q_1 - q_2

As waves a = p + Z q, the sum of the ends is a unit delay, S+ = 1/z: the trapezoidal rule, and C P is the oil to the
last bit. Their difference must not come from the flows of the same instant, since ends do not know each other within a
step; S- = -1/(2z - 1), the line of one step with a half of its echo kept: -1 at rest, so there is no steady drop, and
-1/3 at Nyquist, so nothing swings from step to step. It is an inertance h dp = 2 h^2/C dq beside a resistance 4 h/C:
that of 3 cm of pipe of 11 mm for 20 cm^3 at 50 us. It falls with the square of the step.

Passive for any step and size: a step gives h (p_1 q_1 + p_2 q_2) = C/2 (P'^2 - P^2) + h Z/4 (f'^2 - f^2) to the stores
and h Z/4 (f' - f)^2 to heat.

Memory of a line: P, f, p_1, p_2, then the elements of the wall of end 1 and of end 2.
"""

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel
from twin.lines import wall
from twin.lines.spec import LineNumbers
from twin.lines.wall import creep_port, inner_flow

WALL = 4  # in the memory of a line
SIZE = WALL + 2 * wall.ELEMENTS
PRESSURES_AT = np.array([0, 2, 3])  # in it
Z, CREEPS, CREEP = range(3)
NUMBERS = CREEP + wall.NUMBERS


def coefficients(line: LineNumbers, step: float) -> NDArray[np.float64]:
    """Of a line; any step will do."""
    return np.array([step / line.capacity, float(bool(line.creep)), *wall.wall_numbers(line, step)])


def inertance(line: LineNumbers, step: float) -> float:
    """What the scheme puts between the ends [Pa s^2/m^3]."""
    return 2.0 * step**2 / line.capacity


@kernel
def arriving(lines, place, numbers, memory, c, z) -> None:
    """Fill c and Z of the ends of these lines. Reads only."""
    for k in range(len(lines)):
        i, m, n = lines[k], memory[place[k] :], numbers[k]
        lean = 0.5 * n[Z] * m[1]
        c[2 * i], c[2 * i + 1], z[2 * i], z[2 * i + 1] = m[0] - lean, m[0] + lean, n[Z], n[Z]
        if n[CREEPS] > 0.0:
            for end in range(2):
                e = 2 * i + end
                c[e], z[e] = creep_port(c[e], z[e], n[CREEP:], m[WALL + end * wall.ELEMENTS :])


@kernel
def departing(lines, place, numbers, memory, q) -> None:
    """Take the flows [m^3/s] of the instant and move on to the next."""
    for k in range(len(lines)):
        i, m, n = lines[k], memory[place[k] :], numbers[k]
        q_1, q_2, lean = q[2 * i], q[2 * i + 1], 0.5 * n[Z] * m[1]
        if n[CREEPS] > 0.0:
            q_1 = inner_flow(m[0] - lean, n[Z], q_1, n[CREEP:], m[WALL:])
            q_2 = inner_flow(m[0] + lean, n[Z], q_2, n[CREEP:], m[WALL + wall.ELEMENTS :])
        m[2], m[3] = m[0] - lean + n[Z] * q_1, m[0] + lean + n[Z] * q_2
        m[0] += n[Z] * (q_1 + q_2)
        m[1] = q_1 - q_2


@kernel
def settle(lines, place, numbers, memory, p, q) -> None:
    """Steady flows from end 1 to end 2 since ever, under the pressures p at the ends, which are alike."""
    for k in range(len(lines)):
        i, m = lines[k], memory[place[k] :]
        p_1, p_2 = p[2 * i], p[2 * i + 1]
        m[0], m[1], m[2], m[3] = 0.5 * (p_1 + p_2), 2.0 * q[i], p_1, p_2
        for j in range(wall.ELEMENTS):
            m[WALL + j], m[WALL + wall.ELEMENTS + j] = p_1, p_2


@kernel
def profile(place: int, memory, xi, out) -> None:
    """Pressure [Pa] at places xi after `departing`: linear between the ends."""
    for i in range(len(xi)):
        out[i] = memory[place + 2] + xi[i] * (memory[place + 3] - memory[place + 2])
