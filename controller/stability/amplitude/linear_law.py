"""A sampled linear law between card and valve, at one gain: what the theory of the loop needs to know of a controller.

At each sample, w = (reference, position, velocity) as the card reads them, and

    h = c z + d w,      z <- a z + b w + e (u - h).

What the law does to h before the valve gets it is one of two: jump the overlap and saturate (proportional), nothing
while the valve rests, or full limit in the direction of h (relay). u is h cut to what the valve can follow, and e
brings the memory back when it cannot (back-calculation); a clamped memory rests instead, while it would drive h
further. Positions count from where the run starts, so z is 0 at the first sample.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ERROR = np.array([1.0, -1.0, 0.0])  # of the position, in w
SEEN = {"error": ERROR, "reference": np.array([1.0, 0.0, 0.0]), "position": np.array([0.0, 1.0, 0.0])}
SEEN |= {"velocity": np.array([0.0, 0.0, 1.0])}  # signals of a law, in w
NOT_CLAMPED = -1
ROUNDING = 1e-12  # of the greatest number of a law


class LinearLaw(NamedTuple):
    """A law between card and valve."""

    a: Array  # (n, n)
    b: Array  # (n, 3)
    c: Array  # (n,)
    d: Array  # (3,)
    back: Array  # (n,), e
    clamped: int  # which of z is clamped, or NOT_CLAMPED
    limit: float  # of the spool reference
    overlap: float  # jumped over; 0.0: nothing is
    relay: bool
    rest: float = 0.0  # of h up to which a valve that is shut stays shut; 0.0: it is never at rest


def of_error(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, d: float, gain: float, limit: float, overlap: float
) -> LinearLaw:
    """A linear system (a, b, c, d) on the position error, its output times a gain."""
    a, b, c = (np.asarray(m, float) for m in (a, b, c))
    n = b.size
    row = np.outer(b.reshape(n), ERROR)
    none = np.zeros(n)
    return LinearLaw(
        a.reshape(n, n), row, gain * c.reshape(n), gain * d * ERROR, none, NOT_CLAMPED, limit, overlap, False
    )


def of_signals(
    a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike, inputs: Sequence[str], limit: float, overlap: float
) -> LinearLaw | None:
    """A linear system (a, b, c, d) on several signals; None where w does not say all that it reads.

    That is so for a signal that is not in SEEN, and for a law that tells where reference and position stand, and not
    only how far they are apart.
    """
    if not set(inputs) <= SEEN.keys():
        return None
    seen, n = np.array([SEEN[name] for name in inputs]), len(np.asarray(c, float))
    entry, direct = np.asarray(b, float).reshape(n, len(inputs)) @ seen, np.asarray(d, float) @ seen
    place = np.append(entry[:, :2].sum(axis=1), direct[:2].sum())
    if np.any(np.abs(place) > ROUNDING * max(np.abs(entry).max(initial=0.0), np.abs(direct).max())):
        return None
    a, c, none = np.asarray(a, float).reshape(n, n), np.asarray(c, float), np.zeros(n)
    return LinearLaw(a, entry, c, direct, none, NOT_CLAMPED, limit, overlap, False)


def pd_law(
    gain: float,
    derivative: float,
    source: str,
    filter_time: float,
    period: float,
    limit: float,
    overlap: float,
    rest: float = 0.0,
) -> LinearLaw:
    """h = P e - D v, the velocity from a tachometer ("measured"), a difference, or a filtered one, as the law's own."""
    if source == "measured":
        law = of_error(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0, gain, limit, overlap)
        return law._replace(d=law.d + np.array([0.0, 0.0, -derivative]), rest=rest)
    kept = math.exp(-period / filter_time) if source == "filtered" and filter_time > 0.0 else 0.0
    share = (1.0 - kept) / period
    # z = (last position, last estimate)
    a, b = np.array([[0.0, 0.0], [-share, kept]]), np.array([[0.0, 1.0, 0.0], [0.0, share, 0.0]])
    d = gain * ERROR - derivative * b[1]
    return LinearLaw(a, b, -derivative * a[1], d, np.zeros(2), NOT_CLAMPED, limit, overlap, False, rest)


def relay_law(derivative_time: float, source: str, filter_time: float, period: float, limit: float) -> LinearLaw:
    """Full limit in the direction of e - T_d v."""
    return pd_law(1.0, derivative_time, source, filter_time, period, limit, 0.0)._replace(relay=True)


def with_integral(law: LinearLaw, per_sample: float, back: float, clamped: bool) -> LinearLaw:
    """The law and an integral: I <- I + per_sample e + back (u - h), or clamped."""
    n = len(law.c)
    return law._replace(
        a=np.block([[law.a, np.zeros((n, 1))], [np.zeros((1, n)), np.ones((1, 1))]]),
        b=np.vstack([law.b, per_sample * ERROR]),
        c=np.append(law.c, 1.0),
        back=np.append(law.back, 0.0 if clamped else back),
        clamped=n if clamped else NOT_CLAMPED,
    )
