"""LuGre friction: bristles that bend before they slide.

Source: Canudas de Wit, Olsson, Astrom and Lischinsky, IEEE Transactions on Automatic Control 40 (1995).

    z' = v - sigma_0 |v| z/g(v),   F = sigma_0 z + sigma_1 z' + sigma_2 v,
    g(v) = F_c + (F_s - F_c) exp(-(v/v_s)^2)

z is the mean deflection of the bristles. With a = sigma_0 |v|/g the power F v is the rate of the bristles' energy
sigma_0 z^2/2, plus sigma_1 z'^2 + sigma_1 a z z' + sigma_0 a z^2 + sigma_2 v^2. The first three are a loss for every z
and z' only as long as sigma_1 |v| <= 4 g, so sigma_1 is taken as 4 g/|v| where it is more; there the bristles slide and
z' is small.

Implicit midpoint rule: with means over the step in place of z and v the balance above holds exactly, so the scheme
creates no energy whatever the step. F_c and F_s depend on direction and pressure as in `stribeck`.
"""

from typing import NamedTuple

from numpy.typing import NDArray

from twin.kernel import inlined
from twin.stribeck import Stribeck, dry, share

MEMORY = ("deflection",)  # z [m]
ITERATIONS = 4  # of the speed in g and in |v|


class LuGre(NamedTuple):
    """A Stribeck curve and its bristles; the curve's viscous part is sigma_2."""

    curve: Stribeck
    stiffness: float  # sigma_0 [N/m]
    damping: float  # sigma_1 [N s/m]


@inlined
def relaxation(speed: float, sealing_pressure: float, friction: LuGre) -> float:
    """a = sigma_0 |v|/g [1/s]."""
    level = share(speed, friction.curve) * dry(abs(speed), sealing_pressure, friction.curve)
    return friction.stiffness * abs(speed) / level


@inlined
def bristle_damping(rate: float, friction: LuGre) -> float:
    """sigma_1 [N s/m] at a relaxation a [1/s], at most 4 sigma_0/a."""
    return friction.damping if friction.damping * rate <= 4.0 * friction.stiffness else 4.0 * friction.stiffness / rate


@inlined
def lugre_force(speed: float, sealing_pressure: float, memory: NDArray, friction: LuGre) -> float:
    """Force F [N] against the positive direction."""
    a = relaxation(speed, sealing_pressure, friction)
    bending = speed - a * memory[0]
    viscous = share(speed, friction.curve) * friction.curve.viscous
    return friction.stiffness * memory[0] + bristle_damping(a, friction) * bending + viscous * speed


@inlined
def slide_lugre(
    speed: float, drive: float, mass: float, sealing_pressure: float, friction: LuGre, memory: NDArray, time: float
) -> float:
    """Speed [m/s] after a time [s] under a constant drive [N]; the bristles in `memory` follow."""
    z, mean, bent = memory[0], speed, memory[0]
    for _ in range(ITERATIONS):
        half_a = 0.5 * time * relaxation(mean, sealing_pressure, friction)
        sigma_1 = bristle_damping(2.0 * half_a / time, friction)
        per_mean = time / (1.0 + half_a)  # dz/dv of the deflection at the end
        kept = (1.0 - half_a) / (1.0 + half_a) * z
        by_speed = (0.5 * friction.stiffness + sigma_1 / time) * per_mean
        by_speed += share(mean, friction.curve) * friction.curve.viscous
        at_rest = 0.5 * friction.stiffness * (kept + z) + sigma_1 / time * (kept - z)
        mean = (speed + 0.5 * time / mass * (drive - at_rest)) / (1.0 + 0.5 * time / mass * by_speed)
        bent = kept + per_mean * mean
    memory[0] = bent
    return 2.0 * mean - speed
