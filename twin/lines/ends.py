"""Lines seen from their ends: scattering filters with steady and unsteady friction; length does not change the cost.

Per end the filters of `fit.py` become a difference equation in the waves a = p + Z0 q, b = p - Z0 q [Pa]:

    x <- p (x + gA a_own(k)) + gB a_own(k+1 - round 2M) + gD a_other(k+1 - round M),     gX = (1 - p) aX
    h(k+1) = sum x + echo taps on a_own + taps on a_other,     b = dA a_own + h,     dA = a0 + sum gA

so that p = c + Z q with c = h/(1 - dA) from the past alone, Z = Z0 (1 + dA)/(1 - dA) constant. All delays are one
step at least: the ends decouple within a step. Taps are a chain, s_j <- s_(j+1) + f_(j+1) u, u the wave m0 steps old.

Sixteen ends make a chunk and are moved together: the same quantity of all stands side by side, so that loops over them
are vectors. Turbulent resistance r stands at each end in series, from its own flow of the instant before.
"""

import math

import numpy as np

from twin.kernel import kernel
from twin.lines.chunks import (
    CHAIN,
    D_ECHO,
    D_ECHO_TAP,
    D_FAR,
    D_TAP,
    ECHO,
    ECHO_0,
    ECHO_1,
    ECHO_TAP,
    END,
    FAR,
    HALF,
    LANES,
    LATE,
    MASK,
    OWN,
    PER_FLOW,
    PER_H,
    PUSH,
    RING,
    SERIES,
    STATES,
    TAP,
    TAPS_AT,
    Z0,
    C,
    M,
    P,
    Q,
    Z,
)
from twin.lines.filters import POLES, TAPS
from twin.lines.friction import LAMINAR_LIMIT, turbulence


@kernel
def arriving(place, layout, numbers, memory, c, z) -> None:
    """Fill c and Z of all ends. Reads only: asking twice changes nothing."""
    for k in range(len(place)):
        m, f, whole = memory[place[k] :], numbers[k], layout[k]
        for i in range(LANES):
            end = whole[END * LANES + i]
            if end >= 0:
                c[end] = m[C * LANES + i]
                z[end] = f[Z * LANES + i] + m[SERIES * LANES + i]


@kernel
def departing(place, layout, numbers, memory, tick: int, q) -> None:
    """Take the flows [m^3/s] of the instant and move the states on to the next."""
    for k in range(len(place)):
        m, f, whole = memory[place[k] :], numbers[k], layout[k]
        for i in range(LANES):
            end = whole[END * LANES + i]
            if end >= 0:
                a = m[C * LANES + i] + f[PUSH * LANES + i] * q[end]
                m[OWN * LANES + i], m[Q * LANES + i] = a, q[end]
                memory[np.uint64(whole[RING * LANES + i] + (tick & whole[MASK * LANES + i]))] = a
                m[SERIES * LANES + i] = _series(f, i, q[end])
        for i in range(LANES):
            if whole[END * LANES + i] >= 0:
                _receive(memory, m, whole, i, tick + 1)
        _move(m, f)


@kernel
def _receive(memory, m, whole, i: int, tick: int) -> None:
    """What the rings of both ends hold for the next instant; the other end is the neighbouring lane."""
    own, far, mask = whole[RING * LANES + i], whole[RING * LANES + (i ^ 1)], whole[MASK * LANES + i]
    m[ECHO * LANES + i] = memory[np.uint64(own + ((tick - whole[D_ECHO * LANES + i]) & mask))]
    m[ECHO_TAP * LANES + i] = memory[np.uint64(own + ((tick - whole[D_ECHO_TAP * LANES + i]) & mask))]
    m[FAR * LANES + i] = memory[np.uint64(far + ((tick - whole[D_FAR * LANES + i]) & mask))]
    m[TAP * LANES + i] = memory[np.uint64(far + ((tick - whole[D_TAP * LANES + i]) & mask))]


@kernel
def _move(m, f) -> None:
    """States and c of a chunk from what has come: m its memory, f its coefficients."""
    for i in range(LANES):
        own, echo, far, tap = m[OWN * LANES + i], m[ECHO * LANES + i], m[FAR * LANES + i], m[TAP * LANES + i]
        h = m[LATE * LANES + i] + f[ECHO_0 * LANES + i] * m[ECHO_TAP * LANES + i]
        m[LATE * LANES + i] = f[ECHO_1 * LANES + i] * m[ECHO_TAP * LANES + i]
        h += m[CHAIN * LANES + i] + f[TAPS_AT * LANES + i] * tap
        for j in range(TAPS - 1):
            m[(CHAIN + j) * LANES + i] = m[(CHAIN + j + 1) * LANES + i] + f[(TAPS_AT + j + 1) * LANES + i] * tap
        for j in range(POLES):
            x = f[(P + j) * LANES + i] * m[(STATES + j) * LANES + i] + f[(P + POLES + j) * LANES + i] * own
            x += f[(P + 2 * POLES + j) * LANES + i] * echo + f[(P + 3 * POLES + j) * LANES + i] * far
            m[(STATES + j) * LANES + i] = x
            h += x
        m[C * LANES + i] = f[PER_H * LANES + i] * h


@kernel
def _series(f, i: int, q: float) -> float:
    """What stands in series with an end: half of the turbulent resistance beyond the laminar one [Pa s/m^3]."""
    reynolds = abs(q) * f[PER_FLOW * LANES + i]
    if reynolds <= LAMINAR_LIMIT:
        return 0.0
    return f[HALF * LANES + i] * (turbulence(reynolds) - 1.0)


@kernel
def settle(place, layout, numbers, memory, p, q) -> None:
    """Steady flows from end 1 to end 2 since ever, under the pressures p at the ends."""
    for k in range(len(place)):
        m, f, whole = memory[place[k] :], numbers[k], layout[k]
        for i in range(LANES):
            end = whole[END * LANES + i]
            if end >= 0:
                flow = q[end // 2] if i % 2 == 0 else -q[end // 2]
                m[Q * LANES + i], m[SERIES * LANES + i] = flow, _series(f, i, flow)
                a = p[end] + (f[Z0 * LANES + i] - m[SERIES * LANES + i]) * flow
                m[OWN * LANES + i] = a
                for j in range(whole[MASK * LANES + i] + 1):
                    memory[whole[RING * LANES + i] + j] = a
        for i in range(LANES):
            if whole[END * LANES + i] >= 0:
                _settle_states(m, f, i)


@kernel
def _settle_states(m, f, i: int) -> None:
    """States of an end whose own and far waves have been constant."""
    own, far = m[OWN * LANES + i], m[OWN * LANES + (i ^ 1)]
    m[LATE * LANES + i] = f[ECHO_1 * LANES + i] * own
    h = (f[ECHO_0 * LANES + i] + f[ECHO_1 * LANES + i]) * own
    rest = 0.0
    for j in range(TAPS - 1, -1, -1):
        m[(CHAIN + j) * LANES + i] = rest
        rest += f[(TAPS_AT + j) * LANES + i] * far
    h += rest
    for j in range(POLES):
        x = (f[(P + POLES + j) * LANES + i] + f[(P + 2 * POLES + j) * LANES + i]) * own
        x = (x + f[(P + 3 * POLES + j) * LANES + i] * far) / (1.0 - f[(P + j) * LANES + i])
        m[(STATES + j) * LANES + i] = x
        h += x
    m[C * LANES + i] = f[PER_H * LANES + i] * h


@kernel
def profile(place, layout, numbers, memory, number: int, tick: int, xi, out) -> None:
    """Inner pressure [Pa] at places xi of the ends line of a number among them, after `departing`, from its waves:

    p = (a1(t - xi T) + a2(t - (1 - xi) T))/2 + (1 - xi) e1 + xi e2, e1 = (b1(t) - a2(t - T))/2 and its mirror. Exact at
    both ends, in steady flow and without friction.
    """
    k, i = number // (LANES // 2), 2 * (number % (LANES // 2))
    m, f, whole = memory[place[k] :], numbers[k], layout[k]
    ring_1, ring_2, mask = whole[RING * LANES + i], whole[RING * LANES + i + 1], whole[MASK * LANES + i]
    travel, twice = f[M * LANES + i], 2.0 * f[Z0 * LANES + i]
    b_1 = m[OWN * LANES + i] - twice * m[Q * LANES + i]  # the wave that came out last
    b_2 = m[OWN * LANES + i + 1] - twice * m[Q * LANES + i + 1]
    e_1 = 0.5 * (b_1 - _past(memory, ring_2, mask, tick, travel))
    e_2 = 0.5 * (b_2 - _past(memory, ring_1, mask, tick, travel))
    for j in range(len(xi)):
        right = _past(memory, ring_1, mask, tick, xi[j] * travel)
        left = _past(memory, ring_2, mask, tick, (1.0 - xi[j]) * travel)
        out[j] = 0.5 * (right + left) + (1.0 - xi[j]) * e_1 + xi[j] * e_2


@kernel
def _past(memory, ring: int, mask: int, tick: int, steps: float) -> float:
    """The wave of some steps ago, linear between steps."""
    whole = math.floor(steps)
    part = steps - whole
    here, before = memory[ring + ((tick - whole) & mask)], memory[ring + ((tick - whole - 1) & mask)]
    return here + part * (before - here)
