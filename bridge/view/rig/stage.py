"""The rig as it stands in space: where its parts are and how large [m], from the numbers of a scenario.

x to the right, z upwards. True to scale: bore, rod, stroke, masses as steel plates, pipes in length and thickness.
Enlarged, and labelled so: the strokes of the valves, and cavities.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.scenario.fitted import Values, is_motor
from bridge.view.rig.axis import PISTON, STEEL, Axis, axis_of, plates
from bridge.view.rig.routes import Points, route, segments
from twin.topology import PIPES, POINTS, PORTS

DRUM = 0.15  # [m], radius of a motor's drum; its size says nothing
SPOOL_TRAVEL = 0.035  # [m] in the picture for full travel
LIFT_SCALE = 100.0  # of the relief valve's bodies
CAVITY_SCALE = 3.0  # of the diameter of a cavity's ball
VALVE, PUMP, TEE, BACK, TANK = (  # [m]
    np.array([0.88, 0.0, 0.92]),
    np.array([2.34, 0.0, 0.42]),
    np.array([1.92, 0.0, 0.92]),
    np.array([1.92, 0.0, 0.55]),
    np.array([2.30, 0.0, 0.30]),
)
UP, DOWN, RIGHT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
DETOURS = (UP, UP, DOWN, UP, DOWN, DOWN)  # of the pipes
RELIEF_AT = TEE + 0.13 * RIGHT + 0.05 * UP


class Pipe(NamedTuple):
    """One line in space."""

    length: float  # [m], of the rig
    radius: float  # outer [m]
    hose: bool
    model: str
    pieces: list[Points]  # one between each two places of a profile


class Stage(NamedTuple):
    """All that does not move, and the sizes of what does."""

    values: Values  # of the rig
    axis: Axis  # of the actuator
    bore: float
    rod: float
    stroke: float
    added_height: float  # 0.0 without a weight to pick up
    added_at: float  # position of the piston where it meets the weight
    pipes: tuple[Pipe, ...]
    ports: dict[str, Points]
    hollows: Points  # (15, 3): where cavities of a profile are; those of the chambers move

    @property
    def load_height(self) -> float:
        """Of the load's plates."""
        return self.axis.load_height


def stage(values: dict[str, dict[str, Any]]) -> Stage:
    """The stage of a rig's values."""
    cylinder, load = values["cylinder"], values["load"]
    stroke, bore = cylinder["stroke"], cylinder["bore"]
    added = load["added"] / (STEEL * plates(load["mass"])[0] ** 2)
    axis = axis_of(values, stroke, added)
    pipes, ports = _pipes(values, axis, bore, stroke)
    middles = [np.concatenate(pipe.pieces)[len(np.concatenate(pipe.pieces)) // 2] for pipe in pipes]
    at = [pipes[0].pieces[0][0], *(ports[place] for place in PORTS[1:])]
    return Stage(
        values=values,
        axis=axis,
        bore=bore,
        rod=cylinder["rod"],
        stroke=stroke,
        added_height=added,
        added_at=load["added_at"],
        pipes=pipes,
        ports=ports,
        hollows=np.array([*_chambers(values, axis, stroke, ports), *at, *middles]),
    )


def _pipes(
    values: dict[str, dict[str, Any]], axis: Axis, bore: float, stroke: float
) -> tuple[tuple[Pipe, ...], dict[str, Points]]:
    lower, upper = _chamber_ports(values, axis, bore, stroke)
    ports = {
        "pump": PUMP,
        "tee": TEE,
        "return": BACK,
        "tank": TANK,
        "p": VALVE + 0.06 * RIGHT + 0.05 * UP,
        "t": VALVE + 0.06 * RIGHT + 0.05 * DOWN,
        "a": VALVE - 0.06 * RIGHT + 0.05 * DOWN,
        "b": VALVE - 0.06 * RIGHT + 0.05 * UP,
        "lower": lower,
        "upper": upper,
    }
    ways = zip(PIPES.items(), DETOURS, strict=True)
    return tuple(_pipe(values[n], ports[pipe.first], ports[pipe.second], detour) for (n, pipe), detour in ways), ports


def _chambers(values: Values, axis: Axis, stroke: float, ports: dict[str, Points]) -> tuple[Points, Points]:
    """Where the cavities of the chambers are; those of a cylinder move."""
    return (ports["lower"], ports["upper"]) if is_motor(values) else (axis.at(0.0), axis.at(stroke))


def _chamber_ports(values: Values, axis: Axis, bore: float, stroke: float) -> tuple[Points, Points]:
    """Where lines 3 and 4 end."""
    if is_motor(values):
        return axis.base + DRUM * (RIGHT + 0.5 * DOWN), axis.base + DRUM * (RIGHT + 0.5 * UP)
    side = 0.5 * bore * axis.normal
    return side + axis.at(0.01), side + axis.at(stroke + PISTON - 0.01)


def _pipe(pipe: dict[str, Any], start: Points, end: Points, detour: Points) -> Pipe:
    way = route(start, end, 0.0 if pipe["model"] == "none" else pipe["length"], detour)
    radius, hose = 0.5 * pipe["diameter"] + pipe["wall"], pipe["young"] < 1e10
    return Pipe(pipe["length"], radius, hose, pipe["model"], segments(way, POINTS - 1))


def ball_radius(volume: NDArray[np.float64]) -> NDArray[np.float64]:
    """Radius [m] of the ball that a cavity [m^3] is shown as."""
    return CAVITY_SCALE * np.cbrt(3.0 * np.maximum(volume, 0.0) / (4.0 * math.pi))
