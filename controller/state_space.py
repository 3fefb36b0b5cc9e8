"""A sampled state-space law: z <- A z + B u, h = C z + D u, with u the signals that it reads, in SI.

Then the dead band is jumped over and the command saturated, as for `pd`. The memory is z; it is 0 at first.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from controller.law import Sample, compensate, saturate
from controller.reference import Target

Row = tuple[float, ...]

SIGNALS: dict[str, Callable[[Sample, Target], float]] = {
    "error": lambda sample, target: target.position - sample.position,  # [m]
    "position": lambda sample, target: sample.position,  # [m]
    "velocity": lambda sample, target: sample.velocity,  # [m/s], tachometer
    "p1": lambda sample, target: sample.p1,  # [Pa]
    "p2": lambda sample, target: sample.p2,  # [Pa]
    "p3": lambda sample, target: sample.p3,  # [Pa]
    "reference": lambda sample, target: target.position,  # [m]
    "reference velocity": lambda sample, target: target.velocity,  # [m/s]
}


class StateSpaceGains(NamedTuple):
    """Of `state_space`: n states, as many inputs as signals, one output."""

    a: tuple[Row, ...]  # n rows of n
    b: tuple[Row, ...]  # n rows, a column per input
    c: Row  # n
    d: Row  # a number per input
    inputs: tuple[str, ...]  # names in SIGNALS
    sample_period: float  # T [s], > 0
    limit: float  # of the spool reference, 0..1
    overlap: float  # of the valve lands to jump over, 0..1 of travel


def state_space(
    sample: Sample, target: Target, memory: list[float] | None, gains: StateSpaceGains
) -> tuple[float, list[float]]:
    """Spool reference for h = C z + D u, and the next z."""
    z = memory or [0.0] * len(gains.a)
    u = [SIGNALS[name](sample, target) for name in gains.inputs]
    h = dot(gains.c, z) + dot(gains.d, u)
    then = [dot(row, z) + dot(entry, u) for row, entry in zip(gains.a, gains.b, strict=True)]
    return saturate(compensate(h, gains.overlap), gains.limit), then


def dot(left: Sequence[float], right: Sequence[float]) -> float:
    """The sum of the products."""
    return sum(x * y for x, y in zip(left, right, strict=True))
