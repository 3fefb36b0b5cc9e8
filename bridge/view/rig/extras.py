"""What a drive may have beside its lines, valves and cylinder in the 3-D picture, drawn where it is fitted.

An accumulator is a bottle whose oil rises with the pressure at its place, as if its inlet took none. Accessories are
blocks at the chambers' ports. Springs, the second mass of a compliant load and the arm of a lever go with the piston.
"""

from typing import Any

import numpy as np

from bridge.scenario.fitted import has_relief_line, is_motor, kind_of, word
from bridge.view.rig.axis import STEEL as DENSITY
from bridge.view.rig.bodies import plates
from bridge.view.rig.looks import BRASS, GAS, GREEN, STEEL
from bridge.view.rig.routes import Points, route
from bridge.view.rig.stage import RELIEF_AT, RIGHT, TEE, UP, VALVE, Stage

BOTTLE, BOTTLE_RADIUS = 0.24, 0.045  # [m]; its size says nothing
ATMOSPHERE = 1e5  # [Pa]
WALL_GAP, LINK_GAP = 0.28, 0.14  # [m], of a spring around the load, of the link between two masses
TURNS, COIL = 8, 0.03  # of a spring; [m], half its width
ARM, TIP = 2.2, 0.05  # of a lever: its length over that to the rod; [m], radius of the ball at its end
Array = Any


def extras(stream: Any, stage: Stage) -> None:
    """All that stands still, or moves with the piston."""
    values = stage.values
    if kind_of(values, "accumulator") != "none":
        _bottle(stream, stage)
    for port in accessories(stage):
        _block(stream, stage, port)
    if has_relief_line(values):
        _relief_line(stream, values["pipe_7"]["length"])
    if kind_of(values, "load") == "compliant" and not is_motor(values):
        _second_mass(stream, stage)


def bottle_at(stage: Stage) -> Points:
    """The middle of the accumulator's foot."""
    if word(stage.values, "accumulator.at") == "p":
        return VALVE + np.array([0.26, -0.1, -0.33])
    return TEE + np.array([-0.16, -0.1, -0.33])


def _bottle(stream: Any, stage: Stage) -> None:
    """Foot to bottom, with a pipe to where it hangs on."""
    import rerun as rr

    foot = bottle_at(stage)
    port = stage.ports["p" if word(stage.values, "accumulator.at") == "p" else "tee"]
    low = foot - 0.03 * UP
    pipe = rr.LineStrips3D([[port, np.array([port[0], low[1], low[2]]), low, foot]], radii=0.0075, colors=[STEEL])
    stream.log("rig/accumulator/pipe", pipe, static=True)
    glass = rr.components.FillMode.TransparentFillMajorWireframe
    shell = rr.Capsules3D(
        lengths=[BOTTLE], radii=[1.1 * BOTTLE_RADIUS], translations=[foot], colors=[(*GAS, 50)], fill_mode=glass
    )
    stream.log("rig/accumulator/bottle", shell, static=True)


def oil_share(stage: Stage, pressure: Array) -> Array:
    """Share of the bottle that is oil at pressures [Pa] of its place: of the gas on its polytrope."""
    own = stage.values["accumulator"]
    absolute = np.maximum(pressure + ATMOSPHERE, 1.0)
    return np.clip(1.0 - ((own["precharge"] + ATMOSPHERE) / absolute) ** (1.0 / own["exponent"]), 0.0, 1.0)


def accessories(stage: Stage) -> dict[str, str]:
    """Chamber -> kind of what sits at its port."""
    kinds = {"lower": kind_of(stage.values, "accessory at A"), "upper": kind_of(stage.values, "accessory at B")}
    return {chamber: kind for chamber, kind in kinds.items() if kind != "none"}


def block_at(stage: Stage, chamber: str) -> Points:
    """The middle of an accessory's block."""
    return stage.ports[chamber] + 0.045 * (RIGHT if is_motor(stage.values) else stage.axis.normal)


def _block(stream: Any, stage: Stage, chamber: str) -> None:
    import rerun as rr

    block = rr.Boxes3D(half_sizes=[[0.035] * 3], centers=[block_at(stage, chamber)], colors=[GREEN], fill_mode="solid")
    stream.log(f"rig/accessories/{chamber}", block, static=True)


def _relief_line(stream: Any, length: float) -> None:
    import rerun as rr

    way = route(TEE, RELIEF_AT - 0.075 * UP, length, RIGHT)
    stream.log("rig/valves/seat", rr.LineStrips3D([way], radii=0.0075, colors=[STEEL]), static=True)


def coil(start: Points, end: Points, across: Points) -> Points:
    """A spring between two points."""
    share = np.linspace(0.0, 1.0, 2 * TURNS + 2)[:, None]
    side = np.array([0.0, *([1.0, -1.0] * TURNS), 0.0])[:, None]
    return start + share * (end - start) + COIL * side * across


def far_height(stage: Stage) -> float:
    """Height [m] of the second mass as plates."""
    return word(stage.values, "load.far_mass", 0.0) / (DENSITY * stage.axis.plate**2)


def _second_mass(stream: Any, stage: Stage) -> None:
    """Plates behind a spring, drawn as if the link were rigid: it gives by less than can be seen."""
    import rerun as rr

    axis = stage.axis
    height = far_height(stage)
    near, far = axis.outer_face, axis.outer_face + axis.side * LINK_GAP
    plates(stream, stage, "rig/piston/second", far + 0.5 * axis.side * height, height)
    link = rr.LineStrips3D([coil(axis.at(near), axis.at(far), axis.normal)], radii=0.008, colors=[BRASS])
    stream.log("rig/piston/link", link, static=True)


def has_spring(stage: Stage) -> bool:
    """Does a spring hold the load?"""
    kind = kind_of(stage.values, "load")
    return kind in ("environment", "compliant", "lever") and word(stage.values, "load.stiffness", 0.0) > 0.0


def spring_strips(stage: Stage, position: Array) -> list[Points]:
    """The spring around the load at positions of the piston [m], from its wall."""
    axis = stage.axis
    second = LINK_GAP + far_height(stage) if kind_of(stage.values, "load") == "compliant" else 0.0
    face = axis.outer_face + axis.side * second
    wall = face + (stage.stroke + WALL_GAP if axis.side > 0 else -WALL_GAP)
    ends = axis.at(face + np.asarray(position))
    return [coil(end, axis.at(wall), axis.normal) for end in ends]


def lever_strips(stage: Stage, position: Array) -> list[Points]:
    """The arm at positions of the piston [m]: from its pivot over the end of the rod to the tip."""
    axis = stage.axis
    end = axis.load_at - 0.5 * axis.side * axis.load_height
    reach = max(0.35, stage.stroke)
    pivot = axis.at(end + 0.5 * stage.stroke) - reach * axis.normal
    return [np.array([pivot, pivot + ARM * (rod - pivot)]) for rod in axis.at(end + np.asarray(position))]
