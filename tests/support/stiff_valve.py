"""The dimensionless actuator for an implicit witness: (5.7), (5.8) with a smooth root and its own derivatives.

The pure root has an infinite slope at no drop. An implicit method then works on steps and matrices that the last bits
of its linear algebra decide, and on some processors it does not come to an end. Radau on a root that is laminar below
a drop LAMINAR, with the exact derivatives, needs the same thousands of evaluations everywhere.
"""

from typing import Any

import numpy as np

from controller.stability.actuator.model import Actuator
from twin.integration import Solution, integrate

Array = np.ndarray
LAMINAR = 1e-11  # of the supply pressure: far below every tolerance it is compared at
MOST = 40_000  # evaluations


def root(drop: float) -> float:
    return drop / (drop * drop + LAMINAR * LAMINAR) ** 0.25


def root_slope(drop: float) -> float:
    square = drop * drop + LAMINAR * LAMINAR
    return (0.5 * drop * drop + LAMINAR * LAMINAR) / square**1.25


def rates(y: Array, u: float, plant: Actuator) -> Array:
    """y' while the valve is held at u."""
    y1, y2, y3, y4 = y
    high, low = (root(1.0 - y3), -root(y4)) if u > 0.0 else (root(y3), -root(1.0 - y4))
    rate3 = (plant.gamma * u * high - y2) / (plant.alpha * (1.0 + y1))
    rate4 = (plant.gamma * u * low + y2) / (plant.alpha * (1.0 - y1))
    return np.array([y2, plant.alpha * (y3 - y4) - plant.k * y2, rate3, rate4])


def slopes(y: Array, u: float, plant: Actuator) -> Array:
    """d y'/d y, (4, 4)."""
    y1, _, y3, y4 = y
    alpha, gamma, k = plant
    own3, own4 = (-root_slope(1.0 - y3), -root_slope(y4)) if u > 0.0 else (root_slope(y3), root_slope(1.0 - y4))
    by3, by4 = 1.0 / (alpha * (1.0 + y1)), 1.0 / (alpha * (1.0 - y1))
    _, _, rate3, rate4 = rates(y, u, plant)
    return np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [0.0, -k, alpha, -alpha],
            [-rate3 / (1.0 + y1), -by3, gamma * u * own3 * by3, 0.0],
            [rate4 / (1.0 - y1), by4, 0.0, gamma * u * own4 * by4],
        ]
    )


def by_radau(
    start: Array, u: float, time: float, plant: Actuator, rtol: float, atol: float | Array, events: Any = None
) -> Solution:
    """scipy's run from a start over a time with the valve held at u."""
    return integrate(
        lambda _t, y: rates(y, u, plant),
        (0.0, time),
        start,
        "Radau",
        most=MOST,
        rtol=rtol,
        atol=atol,
        events=events,
        jac=lambda _t, y: slopes(y, u, plant),
    )
