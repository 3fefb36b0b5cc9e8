"""The actuator and its load in the 3-D picture: barrel, frame, piston, rods and plates; of a motor its drum."""

from typing import Any

import numpy as np

from bridge.scenario.fitted import is_motor, kind_of
from bridge.view.rig.axis import PISTON
from bridge.view.rig.looks import BLUE, COPPER, DARK, GLASS, PAPER, RED, STEEL
from bridge.view.rig.routes import Points
from bridge.view.rig.stage import DRUM, UP, Stage

BEHIND = np.array([0.0, 0.12, 0.0])  # [m], of a frame


def actuator(stream: Any, stage: Stage) -> None:
    """All of it; what moves is drawn for the lower stop, and moved by a transform."""
    if is_motor(stage.values):
        _motor(stream, stage)
        return
    _barrel(stream, stage)
    _frame(stream, stage)
    _piston(stream, stage)
    if kind_of(stage.values, "load") != "lever":
        plates(stream, stage, "rig/piston/load", stage.axis.load_at, stage.load_height)
    if stage.added_height > 0.0:
        _added(stream, stage)


def _barrel(stream: Any, stage: Stage) -> None:
    import rerun as rr

    height, radius, axis = stage.stroke + PISTON, 0.5 * stage.bore, stage.axis
    glass = rr.components.FillMode.TransparentFillMajorWireframe
    barrel = rr.Cylinders3D(
        lengths=[height + 0.01],
        radii=[1.12 * radius],
        centers=[axis.at(0.5 * height)],
        colors=[GLASS],
        fill_mode=glass,
        **axis.turn(),
    )
    stream.log("rig/cylinder/barrel", barrel, static=True)
    heads = rr.Boxes3D(
        half_sizes=[[1.5 * radius, 1.5 * radius, 0.02]] * 2,
        centers=axis.at([-0.02, height + 0.02]),
        colors=[DARK],
        fill_mode="solid",
        **axis.turn(2),
    )
    stream.log("rig/cylinder/heads", heads, static=True)


def _frame(stream: Any, stage: Stage) -> None:
    """Two columns and a beam that the cylinder hangs from; feet of one that lies, leans or stands."""
    import rerun as rr

    axis, top = stage.axis, stage.stroke + PISTON + 0.06
    if axis.along[2] > 0.99 and axis.side < 0:
        x, y, high = 0.5 * axis.plate + 0.05, BEHIND[1], axis.at(top)[2]
        strips = [[[s * x, y, 0.0], [s * x, y, high]] for s in (-1, 1)]
        strips += [[[-x, y, high], [x, y, high]], [[0.0, y, high], [0.0, 0.0, high - 0.02]]]
    else:
        heads = axis.at([-0.02, top - 0.04])
        strips = [[head, head + BEHIND, (head + BEHIND) * [1.0, 1.0, 0.0]] for head in heads]
    stream.log("rig/frame", rr.LineStrips3D(strips, radii=0.018, colors=[DARK]), static=True)


def _piston(stream: Any, stage: Stage) -> None:
    import rerun as rr

    axis, rods = stage.axis, len(stage.axis.rods)
    middles = [0.5 * PISTON + side * 0.5 * (PISTON + axis.rod_length) for side in axis.rods]
    metal = rr.Cylinders3D(
        lengths=[PISTON, *[axis.rod_length] * rods],
        radii=[0.94 * 0.5 * stage.bore, *[0.5 * stage.rod] * rods],
        centers=axis.at([0.5 * PISTON, *middles]),
        colors=[PAPER, *[STEEL] * rods],
        fill_mode="solid",
        **axis.turn(1 + rods),
    )
    stream.log("rig/piston/metal", metal, static=True)


def plates(stream: Any, stage: Stage, entity: str, middle: float, height: float, colour: Any = BLUE) -> None:
    """Steel plates around a place of the axis."""
    import rerun as rr

    half = [0.5 * stage.axis.plate, 0.5 * stage.axis.plate, 0.5 * height]
    body = rr.Boxes3D(
        half_sizes=[half], centers=[stage.axis.at(middle)], colors=[colour], fill_mode="solid", **stage.axis.turn()
    )
    stream.log(entity, body, static=True)


def _added(stream: Any, stage: Stage) -> None:
    """The weight to pick up: plates around the rod, on two rails until the load lifts them."""
    import rerun as rr

    bottom, half = stage.axis.load_top + stage.added_at, 0.5 * stage.axis.plate
    plates(stream, stage, "rig/weight/plates", bottom + 0.5 * stage.added_height, stage.added_height, COPPER)
    edges = [[s * (half + 0.05), 0.12, -0.012] for s in (-1, 1)], [[s * (half - 0.03), -half, -0.012] for s in (-1, 1)]
    rails = [[_aside(stage, bottom, *edge) for edge in rail] for rail in zip(*edges, strict=True)]
    stream.log("rig/rails", rr.LineStrips3D(rails, radii=0.012, colors=[DARK]), static=True)


def _aside(stage: Stage, place: float, across: float, y: float, along: float) -> Points:
    """A point beside the axis [m]."""
    return stage.axis.at(place + along) + across * stage.axis.normal + np.array([0.0, y, 0.0])


def _motor(stream: Any, stage: Stage) -> None:
    """A drum with a mark that turns, on a foot."""
    import rerun as rr

    base, flat = stage.axis.base, [rr.RotationAxisAngle([1.0, 0.0, 0.0], degrees=90.0)]
    drum = rr.Cylinders3D(
        lengths=[0.12],
        radii=[DRUM],
        centers=[[0.0, 0.0, 0.0]],
        colors=[STEEL],
        fill_mode="solid",
        rotation_axis_angles=flat,
    )
    stream.log("rig/piston/drum", drum, static=True)
    front = np.array([0.0, -0.065, 0.0])
    mark = rr.LineStrips3D([[front, front + 0.92 * DRUM * UP]], radii=0.012, colors=[RED])
    stream.log("rig/piston/mark", mark, static=True)
    foot = [[base + BEHIND, (base + BEHIND) * [1.0, 1.0, 0.0]], [base, base + BEHIND]]
    stream.log("rig/frame", rr.LineStrips3D(foot, radii=0.018, colors=[DARK]), static=True)
