"""Describing functions: what a nonlinearity does to a sine, as a gain or a damping that depends on the amplitude.

Classical closed forms, by the first harmonic. They say why small motions under a linearly unstable loop do not grow:
friction that does not fall with amplitude is a damping that does.
"""

import math


def dead_band(amplitude: float, half_width: float) -> float:
    """Gain of a band that swallows inputs up to half_width and passes what is beyond with slope 1."""
    if amplitude <= half_width:
        return 0.0
    share = half_width / amplitude
    return 1.0 - 2.0 / math.pi * (math.asin(share) + share * math.sqrt(1.0 - share**2))


def saturation(amplitude: float, limit: float) -> float:
    """Gain of slope 1 up to a limit."""
    return 1.0 - dead_band(amplitude, limit)


def relay(amplitude: float, output: float) -> float:
    """Gain of a switch between -output and output; also of an overlap that the law jumps over, beside its slope."""
    return 4.0 * output / (math.pi * amplitude)


def friction_damping(speed: float, force: float) -> float:
    """Viscous damping [N s/m] that takes as much from a sine of a speed amplitude [m/s] as a dry friction [N]."""
    return relay(speed, force)


def held_speed(damping: float, force: float) -> float:
    """Amplitude of speed [m/s] below which a dry friction [N] damps by more than a damping [N s/m]."""
    return 4.0 * force / (math.pi * damping)
