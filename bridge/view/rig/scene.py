"""What stands still in the 3-D picture of the rig, logged to Rerun once."""

from typing import Any

from bridge.view.rig.labels import label
from bridge.view.rig.stage import (
    BACK,
    BARREL_AT,
    PISTON,
    PLATE,
    PUMP,
    RELIEF_AT,
    RIGHT,
    TANK,
    TEE,
    UP,
    VALVE,
    Stage,
)

STEEL, DARK, GLASS, BRASS, PAPER = (176, 184, 194), (92, 100, 112), (150, 170, 190, 40), (208, 168, 92), (228, 232, 238)
BLUE, COPPER, WATER, RED = (78, 112, 160), (176, 108, 70), (90, 130, 180, 60), (220, 90, 70)


def stand(stream: Any, stage: Stage) -> None:
    """Log all that does not move."""
    import rerun as rr

    stream.log("rig", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    _pipes(stream, stage)
    _cylinder(stream, stage)
    _valves(stream)
    _supply(stream)
    label(stream, stage)


def _pipes(stream: Any, stage: Stage) -> None:
    import rerun as rr

    strips = [piece for pipe in stage.pipes for piece in pipe.pieces]
    radii = [pipe.radius for pipe in stage.pipes for _ in pipe.pieces]
    stream.log("rig/pipes", rr.LineStrips3D(strips, radii=radii), static=True)


def _cylinder(stream: Any, stage: Stage) -> None:
    import rerun as rr

    height, radius = stage.stroke + PISTON, 0.5 * stage.bore
    glass = rr.components.FillMode.TransparentFillMajorWireframe
    barrel = rr.Cylinders3D(
        lengths=[height + 0.01],
        radii=[1.12 * radius],
        centers=[(BARREL_AT + 0.5 * height) * UP],
        colors=[GLASS],
        fill_mode=glass,
    )
    stream.log("rig/cylinder/barrel", barrel, static=True)
    caps = [(BARREL_AT - 0.02) * UP, (BARREL_AT + height + 0.02) * UP]
    heads = rr.Boxes3D(
        half_sizes=[[1.5 * radius, 1.5 * radius, 0.02]] * 2, centers=caps, colors=[DARK], fill_mode="solid"
    )
    stream.log("rig/cylinder/heads", heads, static=True)
    _frame(stream, stage)
    _piston(stream, stage)
    if stage.added_height > 0.0:
        _added(stream, stage)


def _frame(stream: Any, stage: Stage) -> None:
    """Two columns and a beam that the cylinder hangs from."""
    import rerun as rr

    top, x, y = BARREL_AT + stage.stroke + PISTON + 0.06, 0.5 * PLATE + 0.05, 0.12
    posts = [[[s * x, y, 0.0], [s * x, y, top]] for s in (-1, 1)]
    beam = [[[-x, y, top], [x, y, top]], [[0.0, y, top], [0.0, 0.0, top - 0.02]]]
    stream.log("rig/frame", rr.LineStrips3D([*posts, *beam], radii=0.018, colors=[DARK]), static=True)


def _piston(stream: Any, stage: Stage) -> None:
    """Piston, rod and load: drawn for the lower stop, moved by a transform."""
    import rerun as rr

    rod, radius = stage.rod_length, 0.5 * stage.bore
    metal = rr.Cylinders3D(
        lengths=[PISTON, rod],
        radii=[0.94 * radius, 0.5 * stage.rod],
        centers=[(BARREL_AT + 0.5 * PISTON) * UP, (BARREL_AT - 0.5 * rod) * UP],
        colors=[PAPER, STEEL],
        fill_mode="solid",
    )
    stream.log("rig/piston/metal", metal, static=True)
    half = [0.5 * PLATE, 0.5 * PLATE, 0.5 * stage.load_height]
    centre = (stage.load_top - 0.5 * stage.load_height) * UP
    stream.log(
        "rig/piston/load",
        rr.Boxes3D(half_sizes=[half], centers=[centre], colors=[BLUE], fill_mode="solid"),
        static=True,
    )


def _added(stream: Any, stage: Stage) -> None:
    """The weight to pick up: plates around the rod, on two rails until the load lifts them."""
    import rerun as rr

    bottom, half = stage.load_top + stage.added_at, 0.5 * PLATE
    box = rr.Boxes3D(
        half_sizes=[[half, half, 0.5 * stage.added_height]],
        centers=[(bottom + 0.5 * stage.added_height) * UP],
        colors=[COPPER],
        fill_mode="solid",
    )
    stream.log("rig/weight/plates", box, static=True)
    rails = [[[s * (half + 0.05), 0.12, bottom - 0.012], [s * (half - 0.03), -half, bottom - 0.012]] for s in (-1, 1)]
    stream.log("rig/rails", rr.LineStrips3D(rails, radii=0.012, colors=[DARK]), static=True)


def _valves(stream: Any) -> None:
    """Both valves: glass bodies; spool and poppet drawn shut."""
    import rerun as rr

    glass = rr.components.FillMode.TransparentFillMajorWireframe
    bodies = rr.Boxes3D(
        half_sizes=[[0.12, 0.05, 0.05], [0.05, 0.045, 0.075]],
        centers=[VALVE, RELIEF_AT],
        colors=[GLASS],
        fill_mode=glass,
    )
    stream.log("rig/valves/bodies", bodies, static=True)
    lands = [VALVE + d * RIGHT for d in (-0.06, 0.0, 0.06)]
    _bar(stream, "rig/valves/spool", [*lands, VALVE], [0.026] * 3 + [0.17], [0.02] * 3 + [0.007], BRASS)
    _bar(stream, "rig/valves/relief_spool", [RELIEF_AT - 0.03 * UP], [0.05], [0.024], BRASS, upright=True)
    _bar(stream, "rig/valves/pilot", [RELIEF_AT + 0.045 * UP], [0.02], [0.012], RED, upright=True)
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


def _supply(stream: Any) -> None:
    """Pump and tank."""
    import rerun as rr

    glass = rr.components.FillMode.TransparentFillMajorWireframe
    centre = TANK - 0.12 * UP + 0.1 * RIGHT
    tank = rr.Boxes3D(half_sizes=[[0.32, 0.2, 0.15]], centers=[centre], colors=[WATER], fill_mode=glass)
    stream.log("rig/tank", tank, static=True)
    pump = rr.Cylinders3D(lengths=[0.16], radii=[0.06], centers=[PUMP - 0.06 * UP], colors=[DARK], fill_mode="solid")
    stream.log("rig/pump", pump, static=True)
    knots = rr.Ellipsoids3D(radii=[0.016] * 2, centers=[TEE, BACK], colors=[STEEL], fill_mode="solid")
    stream.log("rig/tees", knots, static=True)
