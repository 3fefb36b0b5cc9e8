"""Losses of the elbows, tees and mouths of a line, dp = zeta rho/2 v|v|; fitted or not, which is known when a step is
compiled.

Half of a line's losses stands at each of its ends, in series, as does its turbulent friction: r = k |q| from the flow
of the instant before. r q^2 takes energy whatever q does, and what flows into a loss flows out of it.
"""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type, inlined


class NoLosses(NamedTuple):
    """Straight lines alone."""


class MinorLosses(NamedTuple):
    """Drop over the flow squared [Pa s^2/m^6] at each end of a line."""

    line_1: float
    line_2: float
    line_3: float
    line_4: float
    line_5: float
    line_6: float


Losses = NoLosses | MinorLosses


def loss_per_flow_squared(zeta: float, diameter: float, density: float) -> float:
    """zeta rho/(2 A^2) [Pa s^2/m^6] of a coefficient for the speed in a pipe."""
    return 0.5 * zeta * density / (math.pi / 4.0 * diameter**2) ** 2


@inlined
def _per_line(losses: MinorLosses) -> tuple[float, ...]:
    """A record has no order that a kernel could go through."""
    return losses.line_1, losses.line_2, losses.line_3, losses.line_4, losses.line_5, losses.line_6


@by_type
def loss_at_end(losses: Any, line: int) -> float:
    """Drop over the flow squared [Pa s^2/m^6] at each end of a line, counted from 0."""
    raise TypeError(f"{losses} are not losses")


@loss_at_end.register
def _(losses: NoLosses, line: int) -> float:
    return 0.0


@loss_at_end.register
def _(losses: MinorLosses, line: int) -> float:
    return _per_line(losses)[line]


@by_type
def resist(losses: Any, flow: NDArray, impedance: NDArray) -> None:
    """Put the losses in series with all line ends: flow [m^3/s] of the instant before, impedance [Pa s/m^3]."""
    raise TypeError(f"{losses} are not losses")


@resist.register
def _(losses: NoLosses, flow: NDArray, impedance: NDArray) -> None:
    pass


@resist.register
def _(losses: MinorLosses, flow: NDArray, impedance: NDArray) -> None:
    per_line = _per_line(losses)
    for end in range(2 * len(per_line)):
        impedance[end] += per_line[end // 2] * abs(flow[end])


@inlined
def minor_drop(losses: Any, line: int, flow: float) -> float:
    """Drop [Pa] of both ends of a line at a steady flow [m^3/s]."""
    return 2.0 * loss_at_end(losses, line) * abs(flow) * flow
