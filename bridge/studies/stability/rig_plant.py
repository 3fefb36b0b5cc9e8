"""The rig as the theory of the sampled loop takes it: linear, about the points where a loop that holds can be.

Held by a controller the piston stands still although oil leaks past it, so the valve is open by what the leak takes:
the point "rest". A swing larger than this opening changes side at each turn; the limits of slow motion up and down,
"up" and "down", are what it meets there. Without a leak, or with too large an opening for it, only these two are left.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.fitted_valve import overlap_of
from controller.stability import Plant, movable
from twin.circuit.land_slopes import edge_of, joins, spool_slopes
from twin.circuit.linear import (
    STATES,
    edge_point,
    jacobian,
    moving_point,
    to_vector,
)
from twin.circuit.state import State
from twin.circuit.step import LOWER, UPPER, Circuit
from twin.friction import largest_at_rest
from twin.kernel import interpreted
from twin.load_at_rest import inertia_at
from twin.servo_valve import ServoValve

POINTS = ("rest", "up", "down")
WIDEST = 0.2  # opening [of travel] that is looked for beyond the overlap
NARROWEST = 1e-6  # and the smallest: less than a leak worth the name needs


class RigPlant(NamedTuple):
    """The rig about a point, with u the controller's output, -1..1; SI."""

    point: str  # one of POINTS
    linear: Plant  # with all the rig's states, in the order of twin.linear.STATES
    opening: float  # of the valve there, beyond the overlap, share of the travel
    mass: float  # [kg], that moves
    friction: float  # [N], the least of both directions, of a piston that hardly moves

    def plant(self, damping: float = 0.0) -> Plant:
        """What a loop can move, with a viscous friction [N s/m] of the piston."""
        row = np.zeros(len(STATES)) if self.linear.velocity is None else self.linear.velocity
        return movable(self.linear._replace(a=self.linear.a - damping / self.mass * np.outer(row, row)))


def plants(scenario: Scenario) -> dict[str, RigPlant]:
    """The linear plants of a scenario's rig at its start, by their point. ValueError where the oil cannot follow."""
    circuit = circuit_of(scenario)
    found = {}
    resting = rest_point(circuit, scenario.start.position)
    if resting is not None:
        opening = abs(resting.spool.position) - overlap_of(scenario)
        found["rest"] = _plant("rest", resting, None, opening, scenario, circuit)
    for name, edge in (("up", "+"), ("down", "-")):
        point = edge_point(circuit, scenario.start.position, edge)
        found[name] = _plant(name, point, edge, 0.0, scenario, circuit)
    return found


def rest_point(circuit: Circuit, position: float) -> State | None:
    """The point at which the valve passes what leaks and the piston stands still; None without a leak."""
    if isinstance(circuit.parts.valve, ServoValve) and joins(circuit.parts.valve, circuit.parts.valve.null_bias):
        return _rest_through_null(circuit, position)
    overlap = max(0.0, edge_of(circuit.parts.valve, "+"))

    def speed(opening: float) -> float:
        spool = np.sign(opening) * (overlap + abs(opening))
        return moving_point(circuit, position, float(spool)).piston.velocity

    for side in (1.0, -1.0):
        far = side * WIDEST
        while abs(far) > NARROWEST:  # narrower ones may not exist, so they are come near to from outside
            near = 0.5 * far
            try:
                turned = speed(near) * speed(far) < 0.0
            except ValueError:
                break
            if turned:
                opening: Any = brentq(speed, near, far, xtol=1e-9)
                return moving_point(circuit, position, float(np.sign(opening) * (overlap + abs(opening))))
            far = near
    return None


def _rest_through_null(circuit: Circuit, position: float) -> State | None:
    """The same of a valve that lets oil through in the middle, so that there is a steady motion at every place."""

    def speed(spool: float) -> float:
        return moving_point(circuit, position, spool).piston.velocity

    try:
        return moving_point(circuit, position, float(brentq(speed, -WIDEST, WIDEST, xtol=1e-9)))  # pyright: ignore
    except ValueError:
        return None


def _plant(name: str, point: State, edge: str | None, opening: float, scenario: Scenario, circuit: Circuit) -> RigPlant:
    entry, position, velocity = np.zeros(len(STATES)), *(_row(state) for state in ("position", "velocity"))
    entry[[STATES.index("spool"), STATES.index("spool_velocity")]] = spool_slopes(circuit.parts.valve)[1]
    travel = 1.0 - scenario.controller.jumped_share * overlap_of(scenario)
    a = jacobian(to_vector(point), circuit, edge)
    linear = Plant(a, travel * entry, position, velocity)
    sealing = abs(point.ends.pressure[LOWER] - point.ends.pressure[UPPER])
    friction = min(interpreted(largest_at_rest)(circuit.parts.seal, way, sealing) for way in (1.0, -1.0))
    mass = inertia_at(circuit.parts.load, point.piston.position)
    return RigPlant(name, linear, opening, mass, float(friction))


def _row(state: str) -> np.ndarray:
    return np.eye(len(STATES))[STATES.index(state)]


def at_rest(scenario: Scenario) -> Scenario:
    """The scenario, started with the upper chamber's pressure of its rest; without a leak midway from up to down."""
    circuit = circuit_of(scenario)
    resting = rest_point(circuit, scenario.start.position)
    points = [resting] if resting else [edge_point(circuit, scenario.start.position, edge) for edge in ("+", "-")]
    upper = float(np.mean([point.ends.pressure[UPPER] for point in points]))
    return scenario.model_copy(update={"start": scenario.start.model_copy(update={"p_upper": upper})})
