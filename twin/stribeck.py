"""Friction of Coulomb, Stribeck and Newton: set-valued at rest, falling from static to sliding, rising with speed.

    F(v) = F_c + (F_s - F_c) exp(-(v/v_s)^2) + b v,   v > 0,      |F| <= F_s at rest,

after Armstrong-Helouvry, Dupont and Canudas de Wit (Automatica 30, 1994). Both F_c and F_s grow with the pressure that
presses the seals. v_s = 0: sliding friction is F_c from the first moment on. In the negative direction all of it is
multiplied by a share.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined


class Stribeck(NamedTuple):
    """Friction that does not depend on where it slides."""

    coulomb: float  # F_c [N], at no pressure
    static: float  # F_s [N], at no pressure
    stribeck_speed: float  # v_s [m/s]
    viscous: float  # b [N s/m]
    pressure_area: float  # growth of both with the pressure difference of the chambers [N/Pa]
    negative: float  # friction in the negative direction over that in the positive


@inlined
def share(direction: float, friction: Stribeck) -> float:
    """Friction in a direction of the motion, or of the push at rest, over that in the positive one."""
    return friction.negative if direction < 0.0 else 1.0


@inlined
def dry(speed: float, sealing_pressure: float, friction: Stribeck) -> float:
    """Friction [N] at a speed [m/s] of the positive direction, the viscous part left out; at 0.0 for what starts."""
    pressed = friction.pressure_area * sealing_pressure
    if friction.stribeck_speed == 0.0:
        return friction.coulomb + pressed
    ratio = speed / friction.stribeck_speed
    return friction.coulomb + pressed + (friction.static - friction.coulomb) * math.exp(-ratio * ratio)


@inlined
def stribeck_limit(direction: float, sealing_pressure: float, friction: Stribeck) -> float:
    """Largest friction [N] against a direction at rest."""
    return (friction.static + friction.pressure_area * sealing_pressure) * share(direction, friction)


@inlined
def stribeck_force(speed: float, sealing_pressure: float, friction: Stribeck) -> float:
    """Friction [N], positive, at a speed != 0 [m/s]."""
    v = abs(speed)
    return (dry(v, sealing_pressure, friction) + friction.viscous * v) * share(speed, friction)


@inlined
def slide_stribeck(
    speed: float, drive: float, mass: float, sealing_pressure: float, friction: Stribeck, time: float
) -> float:
    """Speed [m/s] after a time [s] under a constant drive [N] and the friction.

    Sliding: trapezoidal rule, implicit in the viscous part, Heun's in the rest, whose mean therefore never drives.
    Where that would turn the motion round: rest, if the static friction can hold; else away from rest against it.
    """
    if speed != 0.0:
        direction = math.copysign(1.0, speed)
        part = share(speed, friction)
        heavier = mass + 0.5 * time * friction.viscous * part
        push = direction * drive - part * friction.viscous * abs(speed)
        first = part * dry(abs(speed), sealing_pressure, friction)
        guess = max(0.0, abs(speed) + time * (push - first) / heavier)
        mean = 0.5 * (first + part * dry(guess, sealing_pressure, friction))
        then = abs(speed) + time * (push - mean) / heavier
        if then > 0.0:
            return direction * then
    push = mass * speed / time + drive
    if abs(push) <= stribeck_limit(push, sealing_pressure, friction):
        return 0.0
    part = share(push, friction)
    excess = abs(push) - part * dry(0.0, sealing_pressure, friction)
    return math.copysign(time * excess / (mass + 0.5 * time * friction.viscous * part), push)
