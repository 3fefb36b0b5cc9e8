"""End stops: rigid, set-valued, with Newton's restitution.

An impact happens at its own instant inside the step. Below `rest_speed` it is dead, so bounces end.
"""

from typing import NamedTuple

from twin.kernel import inlined


class Stops(NamedTuple):
    """Two stops, at 0 and at `stroke`."""

    stroke: float  # [m]
    restitution: float  # [-]
    rest_speed: float  # [m/s]


@inlined
def travel(position: float, speed: float, stops: Stops, time: float) -> tuple[float, float]:
    """Position and speed after a time [s] at constant speed, with one impact at most."""
    then = position + time * speed
    stop = min(max(then, 0.0), stops.stroke)
    if then == stop:
        return then, speed
    rebound = -stops.restitution * speed if abs(speed) > stops.rest_speed else 0.0
    return stop + rebound * (time - (stop - position) / speed), rebound


@inlined
def stopped(position: float, speed: float, stops: Stops) -> float:
    """The speed a stop allows: none into it."""
    if position <= 0.0:
        return max(speed, 0.0)
    if position >= stops.stroke:
        return min(speed, 0.0)
    return speed
