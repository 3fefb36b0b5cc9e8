"""The slot of the friction. Which kind is fitted is known when a step is compiled."""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type
from twin.lugre import LuGre, lugre_force, slide_lugre
from twin.seal import Seal, friction, friction_limit
from twin.seal import slide as slide_seal
from twin.stribeck import Stribeck, slide_stribeck, stribeck_force, stribeck_limit


class NoFriction(NamedTuple):
    """Nothing rubs."""


Friction = Seal | Stribeck | LuGre | NoFriction


@by_type
def slide(
    kind: Any, speed: float, drive: float, mass: float, sealing_pressure: float, memory: NDArray, time: float
) -> float:
    """Speed [m/s] after a time [s] under a constant drive [N] and the friction; memory: of the slot."""
    raise TypeError(f"{kind} is not a friction")


@slide.register
def _(
    kind: Seal, speed: float, drive: float, mass: float, sealing_pressure: float, memory: NDArray, time: float
) -> float:
    return slide_seal(speed, drive, mass, sealing_pressure, kind, time)


@slide.register
def _(
    kind: Stribeck, speed: float, drive: float, mass: float, sealing_pressure: float, memory: NDArray, time: float
) -> float:
    return slide_stribeck(speed, drive, mass, sealing_pressure, kind, time)


@slide.register
def _(
    kind: LuGre, speed: float, drive: float, mass: float, sealing_pressure: float, memory: NDArray, time: float
) -> float:
    return slide_lugre(speed, drive, mass, sealing_pressure, kind, memory, time)


@slide.register
def _(
    kind: NoFriction, speed: float, drive: float, mass: float, sealing_pressure: float, memory: NDArray, time: float
) -> float:
    return speed + time * drive / mass


@by_type
def friction_force(kind: Any, speed: float, push: float, sealing_pressure: float, memory: NDArray) -> float:
    """Force of the friction [N], in the positive direction: against the motion; at rest what holds a push [N]."""
    raise TypeError(f"{kind} is not a friction")


@friction_force.register
def _(kind: Seal, speed: float, push: float, sealing_pressure: float, memory: NDArray) -> float:
    if speed != 0.0:
        return -math.copysign(friction(speed, sealing_pressure, kind)[0], speed)
    most = friction_limit(push, sealing_pressure, kind)
    return min(max(-push, -most), most)


@friction_force.register
def _(kind: Stribeck, speed: float, push: float, sealing_pressure: float, memory: NDArray) -> float:
    if speed != 0.0:
        return -math.copysign(stribeck_force(speed, sealing_pressure, kind), speed)
    most = stribeck_limit(push, sealing_pressure, kind)
    return min(max(-push, -most), most)


@friction_force.register
def _(kind: LuGre, speed: float, push: float, sealing_pressure: float, memory: NDArray) -> float:
    return -lugre_force(speed, sealing_pressure, memory, kind)


@friction_force.register
def _(kind: NoFriction, speed: float, push: float, sealing_pressure: float, memory: NDArray) -> float:
    return 0.0


@by_type
def largest_at_rest(kind: Any, direction: float, sealing_pressure: float) -> float:
    """Largest friction [N] against a direction at rest; of bristles the force at which they break away."""
    raise TypeError(f"{kind} is not a friction")


@largest_at_rest.register
def _(kind: Seal, direction: float, sealing_pressure: float) -> float:
    return friction_limit(direction, sealing_pressure, kind)


@largest_at_rest.register
def _(kind: Stribeck, direction: float, sealing_pressure: float) -> float:
    return stribeck_limit(direction, sealing_pressure, kind)


@largest_at_rest.register
def _(kind: LuGre, direction: float, sealing_pressure: float) -> float:
    return stribeck_limit(direction, sealing_pressure, kind.curve)


@largest_at_rest.register
def _(kind: NoFriction, direction: float, sealing_pressure: float) -> float:
    return 0.0
