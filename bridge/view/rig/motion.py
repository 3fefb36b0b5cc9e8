"""What moves in the 3-D picture of the rig, sent to Rerun as columns over time."""

from typing import Any

import numpy as np

from bridge.drawing.colours import CAVITY, pressure_colours
from bridge.recording.frames import Frames
from bridge.scenario.fitted import is_motor, kind_of, word
from bridge.view.rig.axis import PISTON
from bridge.view.rig.extras import (
    BOTTLE,
    BOTTLE_RADIUS,
    bottle_at,
    has_spring,
    lever_strips,
    oil_share,
    spring_strips,
)
from bridge.view.rig.looks import BRASS
from bridge.view.rig.stage import LIFT_SCALE, RELIEF_AT, RIGHT, SPOOL_TRAVEL, UP, Stage, ball_radius
from bridge.view.timeline import time_column
from twin.topology import CHAMBERS, CHANNELS, PLACES, PRESSURES

INSIDE = 0.94  # oil within its barrel, of the diameter
SPILL = 0.01 * 6e4  # [m] of arrow for a flow over the relief valve: 10 mm a l/min


def prepare(stream: Any, stage: Stage) -> None:
    """Log once how what moves looks: Rerun's server keeps for good whatever is the same at all times."""
    import rerun as rr

    looks: dict[str, Any] = {"cavities": rr.Ellipsoids3D.from_fields(colors=[CAVITY], fill_mode="solid")}
    solid = rr.Cylinders3D.from_fields(fill_mode="solid", **stage.axis.turn())
    ball = rr.Ellipsoids3D.from_fields(fill_mode="solid")
    looks |= {f"oil/{name}": ball if is_motor(stage.values) else solid for name in CHAMBERS}
    if not is_motor(stage.values) and has_spring(stage):
        looks["spring"] = rr.LineStrips3D.from_fields(radii=0.008, colors=[BRASS])
    if not is_motor(stage.values) and kind_of(stage.values, "load") == "lever":
        looks["lever"] = rr.LineStrips3D.from_fields(radii=0.022, colors=[BRASS])
    if kind_of(stage.values, "relief valve") != "none":
        origin = [RELIEF_AT + 0.05 * RIGHT]
        looks["valves/spill"] = rr.Arrows3D.from_fields(origins=origin, radii=0.006, colors=[(240, 136, 46)])
    if kind_of(stage.values, "accumulator") != "none":
        looks["accumulator/oil"] = rr.Cylinders3D.from_fields(fill_mode="solid")
    for part, look in looks.items():
        stream.log(f"rig/{part}", look, static=True)


def move(stream: Any, stage: Stage, frames: Frames) -> None:
    """Send all that moves; `prepare` has said how it looks."""
    if not len(frames.stamps):
        return
    time = [time_column(frames.stamps)]
    _move_pipes(stream, time, frames)
    _move_actuator(stream, time, stage, frames)
    _move_valves(stream, time, stage, frames)
    if kind_of(stage.values, "accumulator") != "none":
        _move_accumulator(stream, time, stage, frames)
    _move_cavities(stream, time, stage, frames)
    _move_taps(stream, time, frames)


def _move_pipes(stream: Any, time: list[Any], frames: Frames) -> None:
    import rerun as rr

    middle = 0.5 * (frames.pressure[:, :, 1:] + frames.pressure[:, :, :-1])
    count = middle.shape[1] * middle.shape[2]
    colours = pressure_colours(middle).reshape(-1, 3)
    stream.send_columns(
        "rig/pipes", time, rr.LineStrips3D.columns(colors=colours).partition([count] * len(frames.stamps))
    )


def _move_actuator(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    if is_motor(stage.values):
        _move_drum(stream, time, stage, frames)
        return
    import rerun as rr

    x, along = frames.state["position"], stage.axis.along
    stream.send_columns("rig/piston", time, rr.Transform3D.columns(translation=np.outer(x, along)))
    if stage.added_height > 0.0:
        lifted = np.maximum(x - stage.added_at, 0.0)
        stream.send_columns("rig/weight", time, rr.Transform3D.columns(translation=np.outer(lifted, along)))
    for name, bottom, top in (("lower", 0.0 * x, x), ("upper", x + PISTON, 0.0 * x + stage.stroke + PISTON)):
        oil = rr.Cylinders3D.columns(
            lengths=np.maximum(top - bottom, 1e-4),
            centers=stage.axis.at(0.5 * (top + bottom)),
            radii=np.full(len(x), INSIDE * 0.5 * stage.bore),
            colors=pressure_colours(frames.state[f"p_{name}"]),
        )
        stream.send_columns(f"rig/oil/{name}", time, oil)
    if has_spring(stage):
        _move_strips(stream, "rig/spring", time, spring_strips(stage, x))
    if kind_of(stage.values, "load") == "lever":
        _move_strips(stream, "rig/lever", time, lever_strips(stage, x))


def _move_strips(stream: Any, entity: str, time: list[Any], strips: list[Any]) -> None:
    import rerun as rr

    stream.send_columns(entity, time, rr.LineStrips3D.columns(strips=strips))


def _move_drum(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    """The drum turns by the arc over its radius; its ports have the colours of their pressures."""
    import rerun as rr

    half = 0.5 * frames.state["position"] / stage.values["motor"]["radius"]
    none = np.zeros_like(half)
    turn = np.stack([none, np.sin(half), none, np.cos(half)], axis=1)  # x, y, z, w, about the axis of the drum
    places = np.repeat(stage.axis.base[None], len(half), axis=0)
    stream.send_columns("rig/piston", time, rr.Transform3D.columns(translation=places, quaternion=turn))
    for name in CHAMBERS:
        ball = rr.Ellipsoids3D.columns(
            half_sizes=np.full((len(half), 3), 0.03),
            centers=np.repeat(stage.ports[name][None], len(half), axis=0),
            colors=pressure_colours(frames.state[f"p_{name}"]),
        )
        stream.send_columns(f"rig/oil/{name}", time, ball)


def _move_valves(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    import rerun as rr

    s, kind = frames.state, kind_of(stage.values, "relief valve")
    moves = {"spool": np.outer(SPOOL_TRAVEL * s["spool"], RIGHT)}
    if kind == "two-stage":
        moves["relief_spool"] = np.outer(np.minimum(LIFT_SCALE * s["relief_spool"], 0.04), UP)
        moves["pilot"] = np.outer(np.minimum(LIFT_SCALE * s["relief_pilot"], 0.02), UP)
    for name, translation in moves.items():
        stream.send_columns(f"rig/valves/{name}", time, rr.Transform3D.columns(translation=translation))
    if kind == "none":
        return
    flow = SPILL * np.maximum(s["flow_relief"], 0.0)
    spill = rr.Arrows3D.columns(vectors=np.outer(flow + 1e-4, RIGHT))
    stream.send_columns("rig/valves/spill", time, spill)


def _move_accumulator(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    """Oil in the bottle, in the colour of the pressure at its place."""
    import rerun as rr

    place = "p" if word(stage.values, "accumulator.at") == "p" else "tee"
    pressure = frames.state[PLACES[place].pressure]
    height = np.maximum(oil_share(stage, pressure) * BOTTLE, 1e-4)
    oil = rr.Cylinders3D.columns(
        lengths=height,
        centers=bottle_at(stage) + np.outer(0.5 * height, UP),
        radii=np.full(len(height), BOTTLE_RADIUS),
        colors=pressure_colours(pressure),
    )
    stream.send_columns("rig/accumulator/oil", time, oil)


def _move_cavities(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    import rerun as rr

    count, places = frames.cavity.shape
    centres = np.repeat(stage.hollows[None], count, axis=0)
    if not is_motor(stage.values):
        front = np.array([0.0, -0.5 * stage.bore, 0.0])
        centres[:, 0] = front + stage.axis.at(frames.state["position"])
        centres[:, 1] = front + stage.axis.at(PISTON + frames.state["position"])
    radii = np.repeat(ball_radius(frames.cavity).reshape(-1, 1), 3, axis=1)
    balls = rr.Ellipsoids3D.columns(half_sizes=radii, centers=centres.reshape(-1, 3)).partition([places] * count)
    stream.send_columns("rig/cavities", time, balls)


def _move_taps(stream: Any, time: list[Any], frames: Frames) -> None:
    """The taps with their pressures in words."""
    import rerun as rr

    for tap in PRESSURES:
        words = [f"{tap}  {value / 1e5:.1f} bar" for value in frames.state[CHANNELS[tap].reads].tolist()]
        stream.send_columns(f"rig/taps/{tap}", time, rr.Points3D.columns(labels=words))
