"""What the piston carries, and a further weight that waits on a support until the piston picks it up.

Source: (2.10) and 2.6. The weight rests with its face at a height; from there the piston presses a buffer against it,
k = m (pi/t)^2 with t the half-period (3 ms, found by trial and error in the thesis). The contact pushes and never
pulls. When the weight has come to the piston's speed they are one body, without rebound: the work left in the buffer
is lost. Set down again on its support, the weight stays there.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined


class Load(NamedTuple):
    """What hangs on the piston, and what may join it."""

    mass: float  # m [kg], piston included
    gravity: float  # g [m/s^2]
    force: float  # F_ext [N], upwards
    added: float  # mass of the weight [kg]; 0.0 for none
    support: float  # position of the piston where it meets the weight [m]
    stiffness: float  # k of the buffer [N/m]


class Weight(NamedTuple):
    """The weight that joins."""

    position: float  # of its face [m], in the piston's coordinate
    velocity: float  # [m/s]
    carried: float  # 1.0: one body with the piston


def buffer_stiffness(added: float, half_period: float) -> float:
    """k [N/m] on which a mass [kg] swings with a half-period [s]."""
    return added * (math.pi / half_period) ** 2


def weight_at(position: float, load: Load) -> Weight:
    """The weight at rest, the piston at rest at a position [m]."""
    if load.added > 0.0 and position >= load.support:
        return Weight(position, 0.0, 1.0)
    return Weight(load.support, 0.0, 0.0)


@inlined
def carried_mass(weight: Weight, load: Load) -> float:
    """Mass that moves with the piston [kg]."""
    return load.mass + load.added * weight.carried


@inlined
def contact_force(position: float, weight: Weight, load: Load) -> float:
    """Force of the piston on the weight it has not yet picked up [N], upwards."""
    if weight.carried == 1.0:
        return 0.0
    return load.stiffness * max(0.0, position - weight.position)


@inlined
def kick_weight(weight: Weight, force: float, load: Load, time: float) -> Weight:
    """The weight after a time [s] under a force [N] of the piston; the support holds it from below."""
    if load.added == 0.0 or weight.carried == 1.0:
        return weight
    velocity = weight.velocity + time * (force / load.added - load.gravity)
    if weight.position <= load.support:
        velocity = max(velocity, 0.0)
    return Weight(weight.position, velocity, 0.0)


@inlined
def move_weight(weight: Weight, position: float, load: Load, time: float) -> Weight:
    """The weight after a time [s]: with the piston, now at a position [m], or by itself, not below its support."""
    if load.added == 0.0:
        return weight
    if weight.carried == 1.0:
        if position < load.support:
            return Weight(load.support, 0.0, 0.0)
        return Weight(position, 0.0, 1.0)
    then = weight.position + time * weight.velocity
    return Weight(load.support, 0.0, 0.0) if then <= load.support else Weight(then, weight.velocity, 0.0)


@inlined
def pick_up(position: float, velocity: float, weight: Weight, load: Load) -> tuple[float, Weight]:
    """Speed of the piston [m/s] and the weight: one body once the pressed buffer opens again, momentum kept."""
    if load.added == 0.0 or weight.carried == 1.0:
        return velocity, weight
    if position <= weight.position or weight.velocity < velocity:
        return velocity, weight
    common = (load.mass * velocity + load.added * weight.velocity) / (load.mass + load.added)
    return common, Weight(position, 0.0, 1.0)
