"""What holds the load from outside: a spring, and dampers of the first and second power of speed.

    F = -k (x - x_0) - b v - d v |v|

In a kick of a time t the spring's force is that of the place, b acts on the mean speed, and d |v| v on the speed before
times that after, which is exact for d alone. So both dampers are a heavier mass and a smaller drive of the kick, and
it stays a matter of one linear equation.
"""

from typing import NamedTuple

from twin.kernel import inlined


class Environment(NamedTuple):
    """All of it may be 0.0."""

    stiffness: float  # k [N/m]
    neutral: float  # x_0 [m], where the spring is slack
    viscous: float  # b [N s/m]
    quadratic: float  # d [N s^2/m^2]


@inlined
def environment_force(position: float, speed: float, around: Environment) -> float:
    """Force [N] on the load."""
    return -around.stiffness * (position - around.neutral) - (around.viscous + around.quadratic * abs(speed)) * speed


@inlined
def inertia_of_dampers(speed: float, around: Environment, time: float) -> float:
    """Mass [kg] by which a kick of a time [s] is heavier, under the force that `environment_force` has before it."""
    return time * (0.5 * around.viscous + around.quadratic * abs(speed))
