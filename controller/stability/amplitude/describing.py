"""Describing function of dry friction: what it does to a sine, as a damping that depends on the amplitude.

By the first harmonic. It says why small motions under a linearly unstable loop do not grow: friction that does not fall
with amplitude is a damping that does.
"""

import math


def friction_damping(speed: float, force: float) -> float:
    """Viscous damping [N s/m] that takes as much from a sine of a speed amplitude [m/s] as a dry friction [N]."""
    return 4.0 * force / (math.pi * speed)


def held_speed(damping: float, force: float) -> float:
    """Amplitude of speed [m/s] below which a dry friction [N] damps by more than a damping [N s/m]."""
    return 4.0 * force / (math.pi * damping)
