"""A line with nodes inside: method of characteristics, unsteady friction and a vapour cavity at every node.

The pipe is cut into an odd number of lossless segments with the friction of each lumped in two halves at its ends.
Segments are whole steps long, except the middle one, a Lagrange filter of six taps (|H| <= 1, sum and first moment
exact: no oil is lost). Friction in series with a segment, w = its travel time/2 in units of t_v:

    F(z) = 8 + sum r_j (1 - z^-1)/(1 - p_j z^-1) ~ sigma (N - 1),  r_j >= 0:      drop at one end = Z0 w F q

Every term is positive real, so the line is passive by construction; the 8 is Hagen-Poiseuille's, exact. At a node the
two segments offer p = c + Z q each. A cavity V >= 0 stands against p >= p_v:  V_(k+1) = V_k - h n, n = -(q_l + q_r) the
net inflow; p = max(p_v, (c_l/Z_l + c_r/Z_r - V_k/h)/(1/Z_l + 1/Z_r)) decides which of both is zero. No oil is lost.

The ends of all segments stand side by side, so that loops over them are vectors.
"""

import math

import numpy as np
from numpy.typing import NDArray

from twin.kernel import kernel
from twin.lines.filters import lagrange
from twin.lines.friction import LAMINAR_LIMIT, turbulence
from twin.lines.mesh import MIDDLE, POLES, cut, friction_poles
from twin.lines.spec import LineNumbers

TAPS = 6
LANES = 32  # ends of segments side by side, end 1 of the line first
# rows of LANES numbers in memory, the ring's last; P and V count nodes, the others ends of segments
WAVE, SUM, EXCESS, FLOW, PRESSURE, CAVITY, STATES = range(7)
RING = STATES + POLES
# coefficients of a line: scalars, LENGTH the sum of Z0 w over one side, taps, p and (1 - p) r, then a row of Z0 w
Z0, F_0, HEAVY, PER_FLOW, STEP, VAPOUR, LENGTH, TAPS_AT = range(8)
P = TAPS_AT + TAPS
WEIGHT = P + 2 * POLES
NUMBERS = WEIGHT + LANES
LAYOUT = 4  # whole numbers of a line: mask of the ring, segments, steps of an outer one, first tap of the middle one


def prepare(line: LineNumbers, step: float, vapour_pressure: float) -> tuple[list[int], NDArray[np.float64], int]:
    """Layout, coefficients and size of the memory of a line; ValueError if it is too short."""
    m = line.travel_time / step
    if m < MIDDLE:
        raise ValueError(f"travel time {line.travel_time:.3g} s is {m:.2f} steps, limit {MIDDLE:g} for model nodes")
    segments, delay, middle = cut(m)
    first = math.floor(middle) - TAPS // 2 + 1
    p, r = friction_poles(line.viscous_time, line.losses, step)
    steady = 0.0 if line.losses == "none" else 8.0
    share = line.z0 * step / (2.0 * line.viscous_time)
    heavy = 0.5 * line.resistance / (m * share)  # turbulent extra of an end over its Z0 w
    scalars = [line.z0, steady + float(r.sum()), heavy, line.turbulent_per_flow]
    scalars += [step, vapour_pressure, share * m]
    weight = np.zeros(LANES)
    weight[: 2 * segments] = share * delay
    weight[segments - 1 : segments + 1] = share * middle
    numbers = np.concatenate([scalars, lagrange(middle - first, TAPS), p, (1.0 - p) * r, weight])
    ring = 2 ** math.ceil(math.log2(max(delay, first + TAPS) + 1))
    return [ring - 1, segments, delay, first], numbers, (RING + ring) * LANES


@kernel
def _fetch(m, f, count: int, mask: int, delay: int, first: int, tick: int) -> None:
    """The waves that reach all ends of segments now."""
    row = (RING + ((tick - delay) & mask)) * LANES
    for e in range(2 * count):
        m[WAVE * LANES + e] = m[row + e]
    for e in (count - 1, count):  # the middle segment's two ends
        total = 0.0
        for j in range(TAPS):
            total += f[TAPS_AT + j] * m[(RING + ((tick - first - j) & mask)) * LANES + e]
        m[WAVE * LANES + e] = total


@kernel
def arriving(lines, place, layout, numbers, memory, tick: int, c, z) -> None:
    """Fill c and Z of the ends of these lines. Changes nothing but what `departing` finds anew."""
    for k in range(len(lines)):
        m, f, last = memory[place[k] :], numbers[k], 2 * layout[k, 1] - 1
        _fetch(m, f, layout[k, 1], layout[k, 0], layout[k, 2], layout[k, 3], tick)
        for end, e in ((2 * lines[k], 0), (2 * lines[k] + 1, last)):
            c[end] = m[WAVE * LANES + e] + f[WEIGHT + e] * m[SUM * LANES + e]
            z[end] = f[Z0] + f[WEIGHT + e] * f[F_0] + m[EXCESS * LANES + e]


@kernel
def departing(lines, place, layout, numbers, memory, tick: int, q) -> None:
    """Take the flows of the instant, solve every inner node, send the waves, move the friction on."""
    for k in range(len(lines)):
        m, f, count = memory[place[k] :], numbers[k], layout[k, 1]
        _inner_nodes(m, f, count)
        _end_node(m, f, 0, 0, q[2 * lines[k]])
        _end_node(m, f, 2 * count - 1, count, q[2 * lines[k] + 1])
        row = (RING + (tick & layout[k, 0])) * LANES
        for e in range(2 * count):
            m[row + (e ^ 1)] = m[WAVE * LANES + e] + 2.0 * f[Z0] * m[FLOW * LANES + e]
        _move(m, f)
        if f[PER_FLOW] > 0.0:
            for e in range(2 * count):
                m[EXCESS * LANES + e] = _excess(f, e, m[FLOW * LANES + e])


@kernel
def _inner_nodes(m, f, count: int) -> None:
    """Pressure, cavity and flows of the nodes between segments."""
    for j in range(1, count):
        left, right = 2 * j - 1, 2 * j
        c_l = m[WAVE * LANES + left] + f[WEIGHT + left] * m[SUM * LANES + left]
        c_r = m[WAVE * LANES + right] + f[WEIGHT + right] * m[SUM * LANES + right]
        y_l = 1.0 / (f[Z0] + f[WEIGHT + left] * f[F_0] + m[EXCESS * LANES + left])
        y_r = 1.0 / (f[Z0] + f[WEIGHT + right] * f[F_0] + m[EXCESS * LANES + right])
        p, cavity = _node(c_l * y_l + c_r * y_r, y_l + y_r, m[CAVITY * LANES + j], f[STEP], f[VAPOUR])
        m[CAVITY * LANES + j], m[PRESSURE * LANES + j] = cavity, p
        m[FLOW * LANES + left], m[FLOW * LANES + right] = (p - c_l) * y_l, (p - c_r) * y_r


@kernel
def _node(supply: float, admittance: float, cavity: float, step: float, vapour: float):
    """p and V after the step: n = supply - admittance p flows in, V' = V - h n >= 0 against p >= p_v."""
    p = (supply - cavity / step) / admittance
    if p >= vapour:
        return p, 0.0
    return vapour, max(0.0, cavity - step * (supply - admittance * vapour))


@kernel
def _end_node(m, f, e: int, node: int, q: float) -> None:
    """Flow and inner pressure of an end of the line."""
    z = f[Z0] + f[WEIGHT + e] * f[F_0] + m[EXCESS * LANES + e]
    m[FLOW * LANES + e] = q
    m[PRESSURE * LANES + node] = m[WAVE * LANES + e] + f[WEIGHT + e] * m[SUM * LANES + e] + z * q


@kernel
def _move(m, f) -> None:
    """The memory of friction at all ends of segments, M <- p M - (1 - p) r q, and its sum."""
    for e in range(LANES):
        q, total = m[FLOW * LANES + e], 0.0
        for j in range(POLES):
            new = f[P + j] * m[(STATES + j) * LANES + e] - f[P + POLES + j] * q
            m[(STATES + j) * LANES + e] = new
            total += new
        m[SUM * LANES + e] = total


@kernel
def _excess(f, e: int, q: float) -> float:
    """Turbulent over laminar resistance of one end of a segment [Pa s/m^3]."""
    reynolds = abs(q) * f[PER_FLOW]
    return f[HEAVY] * f[WEIGHT + e] * (turbulence(reynolds) - 1.0) if reynolds > LAMINAR_LIMIT else 0.0


@kernel
def settle(lines, place, layout, numbers, memory, p, q) -> None:
    """Steady flows from end 1 to end 2 since ever, under the pressures p at the ends, without cavities."""
    for k in range(len(lines)):
        m, f, count, flow = memory[place[k] :], numbers[k], layout[k, 1], q[lines[k]]
        at, end = p[2 * lines[k]], p[2 * lines[k] + 1]
        slope = (end - at) / f[LENGTH]
        for j in range(count):
            after = at + slope * f[WEIGHT + 2 * j]
            m[PRESSURE * LANES + j] = at
            _settle_end(m, f, 2 * j, flow)
            _settle_end(m, f, 2 * j + 1, -flow)
            for i in range(layout[k, 0] + 1):  # arriving at end 2 from end 1 and the other way round
                m[(RING + i) * LANES + 2 * j + 1] = 0.5 * (at + after) + f[Z0] * flow
                m[(RING + i) * LANES + 2 * j] = 0.5 * (at + after) - f[Z0] * flow
            at = after
        m[PRESSURE * LANES + count] = end


@kernel
def _settle_end(m, f, e: int, q: float) -> None:
    total = 0.0
    for j in range(POLES):
        m[(STATES + j) * LANES + e] = -q * f[P + POLES + j] / (1.0 - f[P + j])
        total += m[(STATES + j) * LANES + e]
    m[SUM * LANES + e], m[FLOW * LANES + e], m[EXCESS * LANES + e] = total, q, _excess(f, e, q)


@kernel
def profile(place: int, layout, f, memory, xi, out) -> None:
    """Pressure [Pa] at places xi after `departing`: that of the nodes, linear between them."""
    m, count = memory[place:], layout[1]
    for i in range(len(xi)):
        x, j = xi[i] * f[LENGTH], 0
        while x > f[WEIGHT + 2 * j] and j < count - 1:
            x, j = x - f[WEIGHT + 2 * j], j + 1
        left, right = m[PRESSURE * LANES + j], m[PRESSURE * LANES + j + 1]
        out[i] = left + min(1.0, x / f[WEIGHT + 2 * j]) * (right - left)


@kernel
def cavity(place: int, layout, memory) -> float:
    """Vapour [m^3] in all inner nodes."""
    total = 0.0
    for j in range(1, layout[1]):
        total += memory[place + CAVITY * LANES + j]
    return total
