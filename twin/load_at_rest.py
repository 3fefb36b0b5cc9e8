"""What a load asks of its actuator at rest, how heavy and how stiff it is: plain numbers for the set-up of a run."""

from functools import singledispatch
from typing import Any

from numpy.typing import NDArray

from twin.compliant import STRETCH, Compliant, resting_stretch
from twin.environment import Environment, environment_force
from twin.kernel import interpreted
from twin.lever import Lever, lever_force, lever_mass
from twin.load import Load, carried_mass, weight_at
from twin.load_slot import HeldLoad


@singledispatch
def held_force(load: Any, position: float) -> float:
    """Force [N] that the actuator must have to hold a load at rest at a position [m], friction left out."""
    raise TypeError(f"{load} is not a load")


@held_force.register
def _(load: Load, position: float) -> float:
    return interpreted(carried_mass)(weight_at(position, load), load) * load.gravity - load.force


@held_force.register
def _(load: HeldLoad, position: float) -> float:
    return load.mass * load.gravity - load.force - interpreted(environment_force)(position, 0.0, load.around)


@held_force.register
def _(load: Compliant, position: float) -> float:
    return load.near * load.gravity - load.link_stiffness * resting_stretch(load, position)


@held_force.register
def _(load: Lever, position: float) -> float:
    around = interpreted(environment_force)(position, 0.0, load.around)
    return -interpreted(lever_force)(position, load) - load.force - around


def moved_weight(load: Any, position: float) -> float:
    """Force [N] that the oil must have in slow motion, a weight that may join left out."""
    return load.mass * load.gravity - load.force if isinstance(load, Load) else held_force(load, position)


@singledispatch
def inertia_at(load: Any, position: float) -> float:
    """Mass [kg] that moves with the piston at a position [m], a weight that may join left out."""
    raise TypeError(f"{load} is not a load")


@inertia_at.register
def _(load: Load, position: float) -> float:
    return load.mass


@inertia_at.register
def _(load: HeldLoad, position: float) -> float:
    return load.mass


@inertia_at.register
def _(load: Compliant, position: float) -> float:
    return load.near


@inertia_at.register
def _(load: Lever, position: float) -> float:
    return interpreted(lever_mass)(position, load)


def rigid_mass(load: Any, position: float) -> float:
    """Mass [kg] that moves with the piston as if a link were rigid."""
    return inertia_at(load, position) + (load.far if isinstance(load, Compliant) else 0.0)


@singledispatch
def begin_load(load: Any, position: float, memory: NDArray) -> None:
    """Fill the memory of the slot for rest at a position [m]."""


@begin_load.register
def _(load: Compliant, position: float, memory: NDArray) -> None:
    memory[STRETCH] = resting_stretch(load, position)


def surroundings(load: Any) -> Environment:
    """The springs and dampers around a load."""
    return Environment(0.0, 0.0, 0.0, 0.0) if isinstance(load, Load) else load.around
