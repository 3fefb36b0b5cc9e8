"""End stops: rigid, set-valued, with Newton's restitution; or none, where a shaft turns on.

An impact happens at its own instant inside the step. Below `rest_speed` it is dead, so bounces end.
"""

from typing import Any, NamedTuple

from twin.kernel import by_type, inlined


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


class NoStops(NamedTuple):
    """Nothing stops the motion."""

    travel: float  # range in which it is expected [m]


AnyStops = Stops | NoStops


@by_type
def move_freely(stops: Any, position: float, speed: float, time: float) -> tuple[float, float]:
    """Position and speed after a time [s] without a force but for the stops'."""
    raise TypeError(f"{stops} are not stops")


@move_freely.register
def _(stops: Stops, position: float, speed: float, time: float) -> tuple[float, float]:
    return travel(position, speed, stops, time)


@move_freely.register
def _(stops: NoStops, position: float, speed: float, time: float) -> tuple[float, float]:
    return position + time * speed, speed


@by_type
def allowed_speed(stops: Any, position: float, speed: float) -> float:
    """The speed that stops allow at a position: none into them."""
    raise TypeError(f"{stops} are not stops")


@allowed_speed.register
def _(stops: Stops, position: float, speed: float) -> float:
    return stopped(position, speed, stops)


@allowed_speed.register
def _(stops: NoStops, position: float, speed: float) -> float:
    return speed
