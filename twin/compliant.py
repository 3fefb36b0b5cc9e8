"""A compliant structure: the piston's mass and the load's, with a spring and a damper between.

    m_1 x'' = F_oil - m_1 g + k s + c s' - friction,   m_2 (x + s)'' = -m_2 g - k s - c s' + F_ext + environment

s is the stretch, how far the load is ahead of where it would be on a rigid link. The force from outside and the
environment act on the load. In a kick the spring has the force of the place; the damper acts on the means of the
speeds before and after, of both masses: solved for the load's, it is a viscous friction of the piston, and so a heavier
mass of its kick.
"""

from typing import NamedTuple

from numpy.typing import NDArray

from twin.environment import Environment, environment_force, inertia_of_dampers
from twin.kernel import inlined

MEMORY = ("stretch", "speed")  # s [m], of the load [m/s]
STRETCH, SPEED = range(len(MEMORY))


class Compliant(NamedTuple):
    """Two masses and their link."""

    near: float  # m_1 [kg], with the piston
    far: float  # m_2 [kg], the load
    link_stiffness: float  # k [N/m]
    link_damping: float  # c [N s/m]
    gravity: float  # g [m/s^2]
    force: float  # F_ext [N]
    around: Environment


@inlined
def _far_alone(load: Compliant, position: float, memory: NDArray, time: float) -> tuple[float, float]:
    """Mean speed [m/s] of the load in a kick without the damper, and the ratio t c/(2 m_2)."""
    stretch, speed = memory[STRETCH], memory[SPEED]
    mass = load.far + inertia_of_dampers(speed, load.around, time)
    force = load.force - load.far * load.gravity - load.link_stiffness * stretch
    force += environment_force(position + stretch, speed, load.around)
    return speed + 0.5 * time * force / mass, 0.5 * time * load.link_damping / mass


@inlined
def linked_push(
    load: Compliant, oil: float, position: float, speed: float, memory: NDArray, time: float
) -> tuple[float, float]:
    """Mass [kg] that a kick of a time [s] moves, and all forces [N] but the friction; oil: the force of the oil."""
    free, ratio = _far_alone(load, position, memory, time)
    damping = load.link_damping / (1.0 + ratio)
    force = oil - load.near * load.gravity + load.link_stiffness * memory[STRETCH] + damping * (free - speed)
    return load.near + 0.5 * time * damping, force


@inlined
def link_force(speed: float, load: Compliant, memory: NDArray) -> float:
    """Force of the link on the piston [N], which has a speed [m/s]."""
    return load.link_stiffness * memory[STRETCH] + load.link_damping * (memory[SPEED] - speed)


@inlined
def kick_far(load: Compliant, position: float, mean: float, memory: NDArray, time: float) -> None:
    """The load after a kick in which the piston has a mean speed [m/s]."""
    free, ratio = _far_alone(load, position, memory, time)
    memory[SPEED] = 2.0 * (free + ratio * mean) / (1.0 + ratio) - memory[SPEED]


@inlined
def move_far(travelled: float, memory: NDArray, time: float) -> None:
    """The stretch after a time [s] in which the piston has travelled [m]."""
    memory[STRETCH] += time * memory[SPEED] - travelled


def resting_stretch(load: Compliant, position: float) -> float:
    """s [m] at rest, the piston at a position [m]."""
    around = load.around
    pulled = load.force - load.far * load.gravity - around.stiffness * (position - around.neutral)
    return pulled / (load.link_stiffness + around.stiffness)
