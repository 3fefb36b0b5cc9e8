"""What stands still in the 3-D picture of the rig, logged to Rerun once."""

from typing import Any

from bridge.scenario.fitted import kind_of
from bridge.view.rig.bodies import actuator
from bridge.view.rig.extras import extras
from bridge.view.rig.labels import label
from bridge.view.rig.looks import BRASS, DARK, GLASS, RED, STEEL, WATER
from bridge.view.rig.motion import prepare
from bridge.view.rig.stage import BACK, PUMP, RELIEF_AT, RIGHT, TANK, TEE, UP, VALVE, Stage


def stand(stream: Any, stage: Stage) -> None:
    """Log all that does not move, and how the rest looks."""
    import rerun as rr

    stream.log("rig", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    _pipes(stream, stage)
    actuator(stream, stage)
    _valve(stream)
    _relief(stream, kind_of(stage.values, "relief valve"))
    _supply(stream, kind_of(stage.values, "supply"))
    extras(stream, stage)
    label(stream, stage)
    prepare(stream, stage)


def _pipes(stream: Any, stage: Stage) -> None:
    import rerun as rr

    strips = [piece for pipe in stage.pipes for piece in pipe.pieces]
    radii = [pipe.radius for pipe in stage.pipes for _ in pipe.pieces]
    stream.log("rig/pipes", rr.LineStrips3D(strips, radii=radii), static=True)


def _body(stream: Any, entity: str, centre: Any, half: list[float]) -> None:
    import rerun as rr

    glass = rr.components.FillMode.TransparentFillMajorWireframe
    box = rr.Boxes3D(half_sizes=[half], centers=[centre], colors=[GLASS], fill_mode=glass)
    stream.log(entity, box, static=True)


def _valve(stream: Any) -> None:
    """A glass body; the spool drawn shut."""
    _body(stream, "rig/valves/body", VALVE, [0.12, 0.05, 0.05])
    lands = [VALVE + d * RIGHT for d in (-0.06, 0.0, 0.06)]
    _bar(stream, "rig/valves/spool", [*lands, VALVE], [0.026] * 3 + [0.17], [0.02] * 3 + [0.007], BRASS)


def _relief(stream: Any, kind: str) -> None:
    """A glass body with spool and poppet, drawn shut; a direct-operated valve has the poppet alone."""
    import rerun as rr

    if kind == "none":
        return
    _body(stream, "rig/valves/relief_body", RELIEF_AT, [0.05, 0.045, 0.075])
    if kind == "two-stage":
        _bar(stream, "rig/valves/relief_spool", [RELIEF_AT - 0.03 * UP], [0.05], [0.024], BRASS, upright=True)
        _bar(stream, "rig/valves/pilot", [RELIEF_AT + 0.045 * UP], [0.02], [0.012], RED, upright=True)
    else:
        _bar(stream, "rig/valves/pilot", [RELIEF_AT - 0.03 * UP], [0.05], [0.02], RED, upright=True)
    seat = [[TEE, RELIEF_AT - 0.075 * UP]]
    stream.log("rig/valves/seat", rr.LineStrips3D(seat, radii=0.0075, colors=[STEEL]), static=True)


def _bar(
    stream: Any, entity: str, centres: list, lengths: list, radii: list, colour: Any, upright: bool = False
) -> None:
    """Round bodies along x, or upright."""
    import rerun as rr

    turn = None if upright else [rr.RotationAxisAngle([0.0, 1.0, 0.0], degrees=90.0)] * len(centres)
    body = rr.Cylinders3D(
        lengths=lengths, radii=radii, centers=centres, rotation_axis_angles=turn, colors=[colour], fill_mode="solid"
    )
    stream.log(f"{entity}/body", body, static=True)


def _supply(stream: Any, kind: str) -> None:
    """Pump and tank; a source of pressure is a box."""
    import rerun as rr

    glass = rr.components.FillMode.TransparentFillMajorWireframe
    centre = TANK - 0.12 * UP + 0.1 * RIGHT
    tank = rr.Boxes3D(half_sizes=[[0.32, 0.2, 0.15]], centers=[centre], colors=[WATER], fill_mode=glass)
    stream.log("rig/tank", tank, static=True)
    at = [PUMP - 0.06 * UP]
    pump = rr.Cylinders3D(lengths=[0.16], radii=[0.06], centers=at, colors=[DARK], fill_mode="solid")
    box = rr.Boxes3D(half_sizes=[[0.07, 0.05, 0.06]], centers=at, colors=[DARK], fill_mode="solid")
    stream.log("rig/pump", box if kind == "pressure" else pump, static=True)
    knots = rr.Ellipsoids3D(radii=[0.016] * 2, centers=[TEE, BACK], colors=[STEEL], fill_mode="solid")
    stream.log("rig/tees", knots, static=True)
