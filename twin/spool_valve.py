"""Proportional directional valve: a second-order spool with limits, and four lands with overlap.

Positive spool positions connect P with A and B with T (the piston lifts), negative ones P with B and A with T.
"""

import math
from typing import NamedTuple

from twin.kernel import inlined
from twin.lands import Lands
from twin.orifice import Orifice


class SpoolValve(NamedTuple):
    """Spool position s in -1..1 of its travel. The step matrix is exact for a reference held over a step."""

    natural_frequency: float  # [rad/s]
    damping: float  # [-]
    rate: float  # largest spool speed [travel/s]
    overlap: float  # share of the travel at which a land opens, >= 0
    area: float  # of one fully open land [m^2]
    orifice: Orifice
    position_from_position: float  # step matrix of (s - reference, s')
    position_from_speed: float
    speed_from_position: float
    speed_from_speed: float


def step_matrix(natural_frequency: float, damping: float, step: float) -> tuple[float, float, float, float]:
    """Rows of expm(step [[0, 1], [-omega^2, -2 zeta omega]])."""
    from scipy.linalg import expm

    matrix = expm(step * _system(natural_frequency, damping))
    return float(matrix[0, 0]), float(matrix[0, 1]), float(matrix[1, 0]), float(matrix[1, 1])


def _system(natural_frequency: float, damping: float):
    import numpy as np

    return np.array([[0.0, 1.0], [-(natural_frequency**2), -2.0 * damping * natural_frequency]])


@inlined
def move_spool(position: float, speed: float, reference: float, valve: SpoolValve, step: float) -> tuple[float, float]:
    """Spool position and speed a step later. The rate limit caps the travel of the step, the stops end it at rest."""
    away = position - reference
    target = reference + valve.position_from_position * away + valve.position_from_speed * speed
    speed_then = valve.speed_from_position * away + valve.speed_from_speed * speed
    reach = valve.rate * step
    moved = position + min(max(target - position, -reach), reach)
    speed_then = min(max(speed_then, -valve.rate), valve.rate)
    if abs(moved) >= 1.0:
        moved = math.copysign(1.0, moved)
        speed_then = min(speed_then, 0.0) if moved > 0.0 else max(speed_then, 0.0)
    return moved, speed_then


@inlined
def closed_centre_lands(spool: float, valve: SpoolValve) -> Lands:
    """Areas [m^2] at a spool position."""
    up, down = opening(spool, valve), opening(-spool, valve)
    return Lands(up, up, down, down, 0.0)


@inlined
def opening(spool: float, valve: SpoolValve) -> float:
    """Area [m^2] of the lands that open towards positive spool positions; use -spool for the other pair."""
    return valve.area * max(0.0, spool - valve.overlap) / (1.0 - valve.overlap)
