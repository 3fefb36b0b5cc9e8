"""The rig as it stands in space: where its parts are and how large [m], from the numbers of a scenario.

x to the right, z upwards. True to scale: bore, rod, stroke, masses as steel plates, pipes in length and thickness.
Enlarged, and labelled so: the strokes of the valves, and cavities.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.shown import place_words
from bridge.view.rig.routes import Points, route, segments
from twin.topology import PIPES, POINTS, PORTS

STEEL = 7850.0  # [kg/m^3]
PLATE = 0.36  # [m], side of the load's plates
PISTON = 0.04  # [m], thickness of the piston
BARREL_AT = 1.05  # [m], inner lower end of the barrel above the floor
ROD_FREE = 0.10  # [m], between barrel and load with the piston at its upper stop
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
    pieces: list[Points]  # one between each two places of a profile


class Stage(NamedTuple):
    """All that does not move, and the sizes of what does."""

    bore: float
    rod: float
    stroke: float
    rod_length: float  # from the piston's lower face to the load
    load_height: float  # of its plates
    added_height: float  # 0.0 without a weight to pick up
    added_at: float  # position of the piston where it meets the weight
    pipes: tuple[Pipe, ...]
    ports: dict[str, Points]
    hollows: Points  # (15, 3): where cavities of a profile are; those of the chambers move

    @property
    def load_top(self) -> float:
        """Height of the load's upper face with the piston at its lower stop."""
        return BARREL_AT - self.rod_length


def stage(values: dict[str, dict[str, Any]]) -> Stage:
    """The stage of a rig's values."""
    cylinder, load = values["cylinder"], values["load"]
    stroke, bore = cylinder["stroke"], cylinder["bore"]
    added = load["added"] / (STEEL * PLATE**2)
    pipes, ports = _pipes(values, bore, stroke)
    middles = [np.concatenate(pipe.pieces)[len(np.concatenate(pipe.pieces)) // 2] for pipe in pipes]
    at = [pipes[0].pieces[0][0], *(ports[place] for place in PORTS[1:])]
    chamber = np.array([0.0, 0.0, BARREL_AT])
    return Stage(
        bore=bore,
        rod=cylinder["rod"],
        stroke=stroke,
        rod_length=stroke + ROD_FREE + added,
        load_height=load["mass"] / (STEEL * PLATE**2),
        added_height=added,
        added_at=load["added_at"],
        pipes=pipes,
        ports=ports,
        hollows=np.array([chamber, chamber + stroke * UP, *at, *middles]),
    )


def _pipes(values: dict[str, dict[str, Any]], bore: float, stroke: float) -> tuple[tuple[Pipe, ...], dict[str, Points]]:
    side = np.array([0.5 * bore, 0.0, 0.0])
    lower, upper = side + (BARREL_AT + 0.01) * UP, side + (BARREL_AT + stroke + PISTON - 0.01) * UP
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


def _pipe(pipe: dict[str, Any], start: Points, end: Points, detour: Points) -> Pipe:
    way = route(start, end, pipe["length"], detour)
    hose = pipe["young"] < 1e10
    return Pipe(pipe["length"], 0.5 * pipe["diameter"] + pipe["wall"], hose, segments(way, POINTS - 1))


def ball_radius(volume: NDArray[np.float64]) -> NDArray[np.float64]:
    """Radius [m] of the ball that a cavity [m^3] is shown as."""
    return CAVITY_SCALE * np.cbrt(3.0 * np.maximum(volume, 0.0) / (4.0 * math.pi))


LINE_ENDS = tuple((place_words(pipe.first), place_words(pipe.second)) for pipe in PIPES.values())
