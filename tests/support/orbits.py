"""Orbits of Figs 5.4 and 5.5, and runs of the same loops by scipy with the equations written out again."""

import math
from collections.abc import Callable

import numpy as np

from controller.stability.actuator.analogue import analogue_edge
from controller.stability.actuator.model import Actuator
from controller.stability.orbits.arc import (
    CROSSED,
    PROPORTIONAL,
    RELAY,
)
from controller.stability.orbits.birth import (
    proportional_birth,
    relay_birth,
)
from controller.stability.orbits.continuation import Branch, Limits, follow_branch
from controller.stability.orbits.limit_cycle import (
    Orbit,
)
from tests.support.stiff_valve import by_radau
from twin.integration import Solution, integrate

PLANT = Actuator(0.01, 0.5, 0.5)  # of Figs 5.4 and 5.5
FALLING = PLANT._replace(k=-0.2)  # friction that falls with speed
S, D = 10.0, 0.1
LEAST = np.array([1e-18, 1e-16, 1e-13, 1e-13])  # absolute errors of scipy: small orbits are small in x first
MOST = 200_000  # evaluations of the rates in a run
EDGE = float(analogue_edge(D, PLANT.k, PLANT.gamma))


def relay_branch(plant: Actuator, least: float, most: float, longest: float = 10.0) -> Branch:
    return follow_branch(relay_birth(plant, S, 0.005), "d", -1.0, Limits(least, most, longest, 0.05, 200))


def proportional_branch(to: float, kind: int = PROPORTIONAL) -> Branch:
    limits = Limits(min(to, EDGE), max(to, EDGE), 10.0, 0.05, 200)
    return follow_branch(proportional_birth(PLANT, D, 1e-6, kind), "s", math.copysign(1.0, to - EDGE), limits)


def root(drop: float) -> float:
    return math.copysign(math.sqrt(abs(drop)), drop)


def rates(orbit: Orbit, side: float) -> Callable[[float, np.ndarray], list[float]]:
    """y' of (5.7), (5.8) with the pure root, written out again; `side` is the relay's u, or of the crossed arc."""
    (alpha, gamma, k), (s, d), kind = orbit.loop.actuator, orbit.loop.gains, orbit.loop.kind

    def of(_t: float, y: np.ndarray) -> list[float]:
        y1, y2, y3, y4 = y
        u = side if kind == RELAY else -(s * y1 + d * y2)
        opens_up = (u > 0.0) if kind == PROPORTIONAL else (side > 0.0) != (kind == CROSSED)
        q1, q2 = (u * root(1.0 - y3), -u * root(y4)) if opens_up else (u * root(y3), -u * root(1.0 - y4))
        speed3, speed4 = (gamma * q1 - y2) / (alpha * (1.0 + y1)), (gamma * q2 + y2) / (alpha * (1.0 - y1))
        return [y2, alpha * (y3 - y4) - k * y2, speed3, speed4]

    return of


def switching(orbit: Orbit, side: float):
    """The event of scipy that ends a run at its next switch."""
    s, d = orbit.loop.gains

    def switch(_t: float, y: np.ndarray) -> float:
        return s * y[0] + d * y[1]

    switch.terminal, switch.direction = True, side  # pyright: ignore[reportFunctionMemberAccess]
    return switch


def run(orbit: Orbit, start: np.ndarray, side: float, time: float, to_switch: bool = False) -> Solution:
    """scipy's run with the valve on one side; to the next switch, if so wanted and if it comes first."""
    limits = {"rtol": 1e-11, "atol": LEAST, "events": switching(orbit, side) if to_switch else None}
    return integrate(rates(orbit, side), (0.0, time), start, "DOP853", most=MOST, **limits)


def run_stiff(orbit: Orbit, start: np.ndarray, side: float, time: float, to_switch: bool = False) -> Solution:
    """The same of a relay whose pressures pass the supply, where they are stiff."""
    events = switching(orbit, side) if to_switch else None
    return by_radau(start, side, time, orbit.loop.actuator, rtol=1e-10, atol=LEAST, events=events)
