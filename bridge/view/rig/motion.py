"""What moves in the 3-D picture of the rig, sent to Rerun as columns over time."""

from typing import Any

import numpy as np

from bridge.drawing.colours import CAVITY, pressure_colours
from bridge.recording.frames import Frames
from bridge.view.rig.stage import (
    BARREL_AT,
    LIFT_SCALE,
    PISTON,
    RELIEF_AT,
    RIGHT,
    SPOOL_TRAVEL,
    UP,
    Stage,
    ball_radius,
)
from bridge.view.timeline import time_column
from twin.topology import CHANNELS, PRESSURES

INSIDE = 0.94  # oil within its barrel, of the diameter
SPILL = 0.01 * 6e4  # [m] of arrow for a flow over the relief valve: 10 mm a l/min


def move(stream: Any, stage: Stage, frames: Frames) -> None:
    """Send all that moves."""
    if not len(frames.stamps):
        return
    time = [time_column(frames.stamps)]
    _move_pipes(stream, time, frames)
    _move_cylinder(stream, time, stage, frames)
    _move_valves(stream, time, frames)
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


def _move_cylinder(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    import rerun as rr

    x = frames.state["position"]
    stream.send_columns("rig/piston", time, rr.Transform3D.columns(translation=np.outer(x, UP)))
    if stage.added_height > 0.0:
        lifted = np.maximum(x - stage.added_at, 0.0)
        stream.send_columns("rig/weight", time, rr.Transform3D.columns(translation=np.outer(lifted, UP)))
    for name, bottom, top in (("lower", 0.0 * x, x), ("upper", x + PISTON, 0.0 * x + stage.stroke + PISTON)):
        oil = rr.Cylinders3D.columns(
            lengths=np.maximum(top - bottom, 1e-4),
            centers=np.outer(BARREL_AT + 0.5 * (top + bottom), UP),
            radii=np.full(len(x), INSIDE * 0.5 * stage.bore),
            colors=pressure_colours(frames.state[f"p_{name}"]),
        )
        stream.log(f"rig/oil/{name}", rr.Cylinders3D.from_fields(fill_mode="solid"), static=True)
        stream.send_columns(f"rig/oil/{name}", time, oil)


def _move_valves(stream: Any, time: list[Any], frames: Frames) -> None:
    import rerun as rr

    s = frames.state
    moves = {
        "spool": np.outer(SPOOL_TRAVEL * s["spool"], RIGHT),
        "relief_spool": np.outer(np.minimum(LIFT_SCALE * s["relief_spool"], 0.04), UP),
        "pilot": np.outer(np.minimum(LIFT_SCALE * s["relief_pilot"], 0.02), UP),
    }
    for name, translation in moves.items():
        stream.send_columns(f"rig/valves/{name}", time, rr.Transform3D.columns(translation=translation))
    flow = SPILL * np.maximum(s["flow_relief"], 0.0)
    spill = rr.Arrows3D.columns(vectors=np.outer(flow + 1e-4, RIGHT))
    style = rr.Arrows3D.from_fields(origins=[RELIEF_AT + 0.05 * RIGHT], radii=0.006, colors=[(240, 136, 46)])
    stream.log("rig/valves/spill", style, static=True)
    stream.send_columns("rig/valves/spill", time, spill)


def _move_cavities(stream: Any, time: list[Any], stage: Stage, frames: Frames) -> None:
    import rerun as rr

    count, places = frames.cavity.shape
    centres = np.repeat(stage.hollows[None], count, axis=0)
    front = np.array([0.0, -0.5 * stage.bore, 0.0])
    centres[:, 0] = front + np.outer(BARREL_AT + frames.state["position"], UP)
    centres[:, 1] = front + np.outer(BARREL_AT + PISTON + frames.state["position"], UP)
    radii = np.repeat(ball_radius(frames.cavity).reshape(-1, 1), 3, axis=1)
    balls = rr.Ellipsoids3D.columns(half_sizes=radii, centers=centres.reshape(-1, 3)).partition([places] * count)
    stream.log("rig/cavities", rr.Ellipsoids3D.from_fields(colors=[CAVITY], fill_mode="solid"), static=True)
    stream.send_columns("rig/cavities", time, balls)


def _move_taps(stream: Any, time: list[Any], frames: Frames) -> None:
    """The taps with their pressures in words."""
    import rerun as rr

    for tap in PRESSURES:
        words = [f"{tap}  {value / 1e5:.1f} bar" for value in frames.state[CHANNELS[tap].reads].tolist()]
        stream.send_columns(f"rig/taps/{tap}", time, rr.Points3D.columns(labels=words))
