"""Lumped line: half of the oil at each end, its inertia and steady friction between them.

    p_k = p_(k-1) + h/(C/2) ((q_(k-1) + q_k)/2 -+ Q_(k-1/2)),       C = V/B, I = rho l/A
    I (Q_(k+1/2) - Q_(k-1/2))/h = p_1,k - p_2,k - R Q_(k-1/2) - S (Q_(k+1/2) - Q_(k-1/2))/2,   R, S at Q_(k-1/2)

Flows q into the line, Q from end 1 to end 2 at half instants: explicit, nothing iterates. As c and Z at an end, with
Z = h/C: `c <- c + 2 Z q -+ 2 Z Q`. No oil is lost: every Q is taken from one end and given to the other.

Passive while h < sqrt(I C) = l/a. Ends alike (q_1 = q_2) see the trapezoidal rule of a capacity, which is lossless.
Ends opposite see, at z = exp(i th), the reactance X = -(Z/2) sin th/(sin^2(th/2) - k), k = (h a/l)^2: it grows with th
everywhere, as Foster asks of a lossless element, if and only if 0 < k < 1. R >= 0 only takes.

The first mode of a real line is met 10 % low when one end is open (quarter wave), 36 % low when both are shut; a
chamber at an end brings it closer. Waves are not met.

Memory of a line: c_1, c_2, Q, p_1, p_2, then the elements of the wall of end 1 and of end 2.
"""

import numpy as np
from numpy.typing import NDArray

from twin.kernel import inlined, kernel
from twin.lines import wall
from twin.lines.friction import turbulence, turbulence_slope
from twin.lines.spec import LineNumbers
from twin.lines.wall import creep_port, inner_flow

WALL = 5  # in the memory of a line
SIZE = 12  # of it
SECOND_FREE, FLOW, SECOND_PRESSURE = 1, 2, 4  # in it: c_2, Q, p_2
PRESSURES_AT = np.array([0, 1, 3, 4])
SECOND_AT = np.array([SECOND_FREE, SECOND_PRESSURE])
Z, PER_INERTANCE, RESISTANCE, PER_FLOW, CREEPS, CREEP = range(6)
NUMBERS = CREEP + wall.NUMBERS


def coefficients(line: LineNumbers, step: float) -> NDArray[np.float64]:
    """Of a line; ValueError if the step is too coarse."""
    if step >= line.travel_time:
        raise ValueError(f"step {step:g} s, limit {line.travel_time:.3g} s (its travel time) for model lumped")
    own = [step / line.capacity, step / line.inertance, line.resistance, line.turbulent_per_flow]
    return np.array([*own, float(bool(line.creep)), *wall.wall_numbers(line, step)])


@kernel
def arriving(lines, place, numbers, memory, c, z) -> None:
    """Fill c and Z of the ends of these lines. Reads only."""
    for k in range(len(lines)):
        i, at = lines[k], place[k]
        c[2 * i], c[2 * i + 1] = memory[at], memory[at + 1]
        z[2 * i] = z[2 * i + 1] = numbers[k, Z]
        if numbers[k, CREEPS] > 0.0:
            for e in (2 * i, 2 * i + 1):
                states = memory[at + WALL + (e & 1) * wall.ELEMENTS :]
                c[e], z[e] = creep_port(c[e], z[e], numbers[k, CREEP:], states)


@kernel
def departing(lines, place, numbers, memory, q) -> None:
    """Take the flows [m^3/s] of the instant and move on to the next."""
    for k in range(len(lines)):
        i, at, z, push = lines[k], place[k], numbers[k, Z], numbers[k, PER_INERTANCE]
        q_1, q_2, flow = q[2 * i], q[2 * i + 1], memory[at + 2]
        if numbers[k, CREEPS] > 0.0:
            n = numbers[k, CREEP:]
            q_1 = inner_flow(memory[at], z, q_1, n, memory[at + WALL :])
            q_2 = inner_flow(memory[at + 1], z, q_2, n, memory[at + WALL + wall.ELEMENTS :])
        p_1, p_2 = memory[at] + z * q_1, memory[at + 1] + z * q_2
        flow = _accelerated(flow, p_1 - p_2, push, numbers[k, RESISTANCE], numbers[k, PER_FLOW])
        memory[at], memory[at + 1] = p_1 + z * q_1 - 2.0 * z * flow, p_2 + z * q_2 + 2.0 * z * flow
        memory[at + 2], memory[at + 3], memory[at + 4] = flow, p_1, p_2


@inlined
def _accelerated(flow: float, drop: float, push: float, laminar: float, per_flow: float) -> float:
    """The inner flow [m^3/s] an instant later: trapezoidal rule, friction linearised about the flow.

    Friction then is R m + (S - R) d/2 at the mean flow m, d its change, S the slope of the drop. Where that would give
    energy, m d < 0 in a hard stop, its resistance R alone is taken, which never does.
    """
    reynolds = abs(flow) * per_flow
    r, slope = laminar * turbulence(reynolds), laminar * turbulence_slope(reynolds)
    then = flow + push * (drop - r * flow) / (1.0 + 0.5 * push * slope)
    if abs(then - flow) * (slope - r) <= r * abs(then + flow):
        return then
    return flow + push * (drop - r * flow) / (1.0 + 0.5 * push * r)


@kernel
def settle(lines, place, numbers, memory, p, q) -> None:
    """Steady flows from end 1 to end 2 since ever, under the pressures p at the ends."""
    for k in range(len(lines)):
        i, at, z = lines[k], place[k], numbers[k, Z]
        p_1, p_2 = p[2 * i], p[2 * i + 1]
        memory[at], memory[at + 1] = p_1 - z * q[i], p_2 + z * q[i]
        memory[at + 2], memory[at + 3], memory[at + 4] = q[i], p_1, p_2
        for j in range(wall.ELEMENTS):
            memory[at + WALL + j], memory[at + WALL + wall.ELEMENTS + j] = p_1, p_2


@kernel
def profile(place: int, memory, xi, out) -> None:
    """Pressure [Pa] at places xi after `departing`: linear between the ends."""
    for i in range(len(xi)):
        out[i] = memory[place + 3] + xi[i] * (memory[place + 4] - memory[place + 3])
