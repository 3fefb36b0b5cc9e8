"""The slot of the load: what the piston moves. Which kind is fitted is known when a step is compiled.

`mass`: twin/load.py, with a weight that may join. `environment`: a mass in an `Environment`. `compliant`:
twin/compliant.py. `lever`: twin/lever.py. A step is half a kick, the travel, half a kick: a kick changes speeds under
the forces of one place, the travel changes places without a force but the stops'. g is the acceleration of gravity
along the axis, against the positive direction.
"""

import math
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.compliant import Compliant, kick_far, link_force, linked_push, move_far
from twin.contact import move_freely
from twin.environment import Environment, environment_force, inertia_of_dampers
from twin.kernel import by_type
from twin.lever import Lever, glide, lever_force, lever_mass
from twin.load import Load, Weight, carried_mass, contact_force, kick_weight, move_weight, pick_up
from twin.table import value_and_slope


class HeldLoad(NamedTuple):
    """A mass in an environment."""

    mass: float  # m [kg], piston included
    gravity: float  # g [m/s^2]
    force: float  # F_ext [N]
    around: Environment


class Push(NamedTuple):
    """What a kick moves, and how hard."""

    mass: float  # [kg], with what dampers add
    force: float  # [N], all but the friction
    contact: float  # of it, on a weight that has not yet joined [N]


AnyLoad = Load | HeldLoad | Compliant | Lever


@by_type
def push_of(load: Any, oil: float, place: float, speed: float, weight: Weight, memory: NDArray, time: float) -> Push:
    """What a kick of a time [s] moves under the force of the oil [N], at a place [m]; memory: of the slot."""
    raise TypeError(f"{load} is not a load")


@push_of.register
def _(load: Load, oil: float, place: float, speed: float, weight: Weight, memory: NDArray, time: float) -> Push:
    mass, push = carried_mass(weight, load), contact_force(place, weight, load)
    return Push(mass, oil - mass * load.gravity + load.force - push, push)


@push_of.register
def _(load: HeldLoad, oil: float, place: float, speed: float, weight: Weight, memory: NDArray, time: float) -> Push:
    held = environment_force(place, speed, load.around)
    mass = load.mass + inertia_of_dampers(speed, load.around, time)
    return Push(mass, oil - load.mass * load.gravity + load.force + held, 0.0)


@push_of.register
def _(load: Compliant, oil: float, place: float, speed: float, weight: Weight, memory: NDArray, time: float) -> Push:
    mass, force = linked_push(load, oil, place, speed, memory, time)
    return Push(mass, force, 0.0)


@push_of.register
def _(load: Lever, oil: float, place: float, speed: float, weight: Weight, memory: NDArray, time: float) -> Push:
    held = environment_force(place, speed, load.around)
    mass = lever_mass(place, load) + inertia_of_dampers(speed, load.around, time)
    return Push(mass, oil + lever_force(place, load) + load.force + held, 0.0)


@by_type
def kick_second(
    load: Any, push: Push, place: float, mean: float, weight: Weight, memory: NDArray, time: float
) -> Weight:
    """The second body after a kick in which the piston has a mean speed [m/s]: the weight, or what `memory` holds."""
    raise TypeError(f"{load} is not a load")


@kick_second.register
def _(load: Load, push: Push, place: float, mean: float, weight: Weight, memory: NDArray, time: float) -> Weight:
    return kick_weight(weight, push.contact, load, time)


@kick_second.register
def _(
    load: HeldLoad | Lever, push: Push, place: float, mean: float, weight: Weight, memory: NDArray, time: float
) -> Weight:
    return weight


@kick_second.register
def _(load: Compliant, push: Push, place: float, mean: float, weight: Weight, memory: NDArray, time: float) -> Weight:
    kick_far(load, place, mean, memory, time)
    return weight


@by_type
def move_load(
    load: Any, place: float, speed: float, weight: Weight, stops: Any, memory: NDArray, time: float
) -> tuple[float, float, Weight]:
    """Place [m], speed [m/s] and weight after a time [s] without a force but the stops'."""
    raise TypeError(f"{load} is not a load")


@move_load.register
def _(
    load: Load, place: float, speed: float, weight: Weight, stops: Any, memory: NDArray, time: float
) -> tuple[float, float, Weight]:
    x, v = move_freely(stops, place, speed, time)
    return x, v, move_weight(weight, x, load, time)


@move_load.register
def _(
    load: HeldLoad, place: float, speed: float, weight: Weight, stops: Any, memory: NDArray, time: float
) -> tuple[float, float, Weight]:
    x, v = move_freely(stops, place, speed, time)
    return x, v, weight


@move_load.register
def _(
    load: Compliant, place: float, speed: float, weight: Weight, stops: Any, memory: NDArray, time: float
) -> tuple[float, float, Weight]:
    x, v = move_freely(stops, place, speed, time)
    move_far(x - place, memory, time)
    return x, v, weight


@move_load.register
def _(
    load: Lever, place: float, speed: float, weight: Weight, stops: Any, memory: NDArray, time: float
) -> tuple[float, float, Weight]:
    if speed == 0.0:
        return place, speed, weight
    mean, root = glide(place, speed, load, time)
    x, v = move_freely(stops, place, mean, time)
    return x, v / mean * speed * root / math.sqrt(lever_mass(x, load)), weight


@by_type
def join(load: Any, place: float, speed: float, weight: Weight) -> tuple[float, Weight]:
    """Speed of the piston [m/s] and the weight at the end of a step, where they may have become one body."""
    raise TypeError(f"{load} is not a load")


@join.register
def _(load: Load, place: float, speed: float, weight: Weight) -> tuple[float, Weight]:
    return pick_up(place, speed, weight, load)


@join.register
def _(load: HeldLoad | Compliant | Lever, place: float, speed: float, weight: Weight) -> tuple[float, Weight]:
    return speed, weight


@by_type
def moving_mass(load: Any, place: float, weight: Weight) -> float:
    """Mass that moves with the piston at a place [kg]."""
    raise TypeError(f"{load} is not a load")


@moving_mass.register
def _(load: Load, place: float, weight: Weight) -> float:
    return carried_mass(weight, load)


@moving_mass.register
def _(load: HeldLoad, place: float, weight: Weight) -> float:
    return load.mass


@moving_mass.register
def _(load: Compliant, place: float, weight: Weight) -> float:
    return load.near


@moving_mass.register
def _(load: Lever, place: float, weight: Weight) -> float:
    return lever_mass(place, load)


@by_type
def acceleration(load: Any, oil: float, place: float, speed: float, viscous: float) -> float:
    """Of the piston [m/s^2] under the force of the oil [N] and a viscous friction [N s/m]; a link counts as rigid."""
    raise TypeError(f"{load} is not a load")


@acceleration.register
def _(load: Load, oil: float, place: float, speed: float, viscous: float) -> float:
    return (oil + load.force - viscous * speed) / load.mass - load.gravity


@acceleration.register
def _(load: HeldLoad, oil: float, place: float, speed: float, viscous: float) -> float:
    force = oil + load.force + environment_force(place, speed, load.around)
    return (force - viscous * speed) / load.mass - load.gravity


@acceleration.register
def _(load: Compliant, oil: float, place: float, speed: float, viscous: float) -> float:
    force = oil + load.force + environment_force(place, speed, load.around)
    return (force - viscous * speed) / (load.near + load.far) - load.gravity


@acceleration.register
def _(load: Lever, oil: float, place: float, speed: float, viscous: float) -> float:
    force = oil + lever_force(place, load) + load.force + environment_force(place, speed, load.around)
    mass, slope = lever_mass(place, load), value_and_slope(place, load.inertia)[1]
    return (force - viscous * speed - 0.5 * slope * speed * speed) / mass


@by_type
def rod_force(load: Any, place: float, speed: float, acceleration: float, weight: Weight, memory: NDArray) -> float:
    """Force of the rod on its load [N], whose mass the piston's counts to."""
    raise TypeError(f"{load} is not a load")


@rod_force.register
def _(load: Load, place: float, speed: float, acceleration: float, weight: Weight, memory: NDArray) -> float:
    pressed = (1.0 - weight.carried) * max(0.0, place - weight.position)
    return carried_mass(weight, load) * (load.gravity + acceleration) - load.force + load.stiffness * pressed


@rod_force.register
def _(load: HeldLoad, place: float, speed: float, acceleration: float, weight: Weight, memory: NDArray) -> float:
    around = environment_force(place, speed, load.around)
    return load.mass * (load.gravity + acceleration) - load.force - around


@rod_force.register
def _(load: Compliant, place: float, speed: float, acceleration: float, weight: Weight, memory: NDArray) -> float:
    return load.near * (load.gravity + acceleration) - link_force(speed, load, memory)


@rod_force.register
def _(load: Lever, place: float, speed: float, acceleration: float, weight: Weight, memory: NDArray) -> float:
    mass, slope = lever_mass(place, load), value_and_slope(place, load.inertia)[1]
    around = environment_force(place, speed, load.around)
    return mass * acceleration + 0.5 * slope * speed * speed - lever_force(place, load) - load.force - around
