"""PID with a limited output: the integral does not wind up, and the reference's velocity is fed forward.

With e = x_ref - x, the velocity v estimated as for `pd`, and L the limit of the spool before the overlap is jumped,

    w_k = P e_k + I_k - D v_k + F x_ref'_k         u_k = w_k within -L..L, the overlap jumped
    I_k+1 = I_k + T K e_k + (T/T_t) (u_k - w_k)    back-calculation: I follows what the valve can do, with lag T_t
    I_k+1 = I_k + T K e_k                          clamping: I rests while w is beyond L and K e drives it further

The integral is the forward difference of K e, so a sample's own error acts through it from the next sample on:
I(z) = T K E(z)/(z - 1). "filtered" gives the derivative D (1 - a)(1 - 1/z)/(T (1 - a/z)) with a = exp(-T/filter_time),
and acts on the position alone. Memory forgotten is the law at its first sample: I = 0, and no difference is taken
across the gap, so at the target the valve stays where the safe state put it.
"""

import math
from typing import NamedTuple

from controller.law import Memory, Sample, jumped, saturate, velocity
from controller.reference import Target

BACK_CALCULATION, CLAMPING = "back-calculation", "clamping"  # and "none"


class PidGains(NamedTuple):
    """Of `pid`."""

    proportional: float  # P [1/m], spool (-1..1) per metre of error
    integral: float  # K [1/(m s)]
    derivative: float  # D [s/m], spool per metre a second of the piston
    feed_forward: float  # F [s/m], spool per metre a second of the reference
    source: str  # of the velocity: "measured" | "backward" | "filtered"
    filter_time: float  # [s], lag of the filtered difference
    sample_period: float  # T [s], > 0
    limit: float  # of the spool reference, 0..1
    overlap: float  # of the valve lands to jump over, 0..1 of travel; 0.0: no dead-band compensation
    anti_windup: str  # "back-calculation" | "clamping" | "none"
    tracking_time: float  # T_t [s], >= T, of back-calculation
    rest: float = 0.0  # of w up to which a valve that is shut stays shut, as in Gains


class PidMemory(NamedTuple):
    motion: Memory  # at the previous sample
    integral: float  # I, spool that the next sample adds


def pid(sample: Sample, target: Target, memory: PidMemory | None, gains: PidGains) -> tuple[float, PidMemory]:
    """Spool reference, dead band jumped over, then saturated."""
    v = velocity(sample, memory.motion if memory else None, gains)
    integral = memory.integral if memory else 0.0
    error = target.position - sample.position
    w = gains.proportional * error + integral - gains.derivative * v + gains.feed_forward * target.velocity
    u, opened = jumped(w, memory is not None and memory.motion.opened, gains)
    return u, PidMemory(Memory(sample.position, v, opened), _next(integral, error, w, gains))


def reach(gains: PidGains) -> float:
    """L: w that takes the spool to its limit, once the overlap is jumped; 0.0 where the limit lies inside it."""
    return max(gains.limit - gains.overlap, 0.0) / (1.0 - gains.overlap)


def _next(integral: float, error: float, w: float, gains: PidGains) -> float:
    """The integral for the next sample; a sample that is not a number leaves it as it is."""
    if math.isnan(w):
        return integral
    beyond = w - saturate(w, reach(gains))
    rate = gains.integral * error
    if gains.anti_windup == CLAMPING and beyond * rate > 0.0:
        return integral
    if gains.anti_windup == BACK_CALCULATION:
        rate -= beyond / gains.tracking_time
    return integral + gains.sample_period * rate
