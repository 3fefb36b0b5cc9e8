"""Words and the scale of colours in the 3-D picture of the rig."""

from typing import Any

import numpy as np

from bridge.drawing.colours import LEGEND, pressure_colours
from bridge.view.rig.routes import Points
from bridge.view.rig.stage import (
    CAVITY_SCALE,
    LIFT_SCALE,
    PUMP,
    RELIEF_AT,
    TANK,
    UP,
    VALVE,
    Stage,
)
from twin.topology import CHAMBERS, TAPS

PAPER, INK = (236, 240, 246), (190, 198, 208)
FRONT, ASIDE = np.array([0.0, -0.03, -0.03]), np.array([0.14, -0.03, 0.03])
OFFSET: dict[str, Points] = dict.fromkeys(CHAMBERS, ASIDE)  # of a tap's label
LEGEND_X, LEGEND_LOW, BARS = -0.62, 0.25, 60  # [m], [m], colours; a metre high


def label(stream: Any, stage: Stage) -> None:
    """Taps, names, and the bar of colours."""
    _taps(stream, stage)
    _names(stream, stage)
    _bar(stream)
    _marks(stream)


def _taps(stream: Any, stage: Stage) -> None:
    """Points beside the taps: what they read follows."""
    import rerun as rr

    for tap, place in TAPS.items():
        at = stage.ports[place] + OFFSET.get(place, FRONT)
        point = rr.Points3D([at], radii=0.001, colors=[PAPER], show_labels=True)
        stream.log(f"rig/taps/{tap}", point, static=True)


def _names(stream: Any, stage: Stage) -> None:
    words = {
        "valve, travel enlarged": VALVE + 0.13 * UP,
        f"relief valve, lifts x{LIFT_SCALE:g}": RELIEF_AT + 0.14 * UP,
        "pump": PUMP + np.array([0.0, -0.07, -0.06]),
        "tank": TANK + np.array([0.25, -0.2, -0.2]),
        f"violet: vapour; balls: cavities, x{CAVITY_SCALE:g}": np.array([-0.24, 0.0, 0.14]),
    }
    for number, pipe in enumerate(stage.pipes, 1):
        middle = pipe.pieces[len(pipe.pieces) // 2][0]
        words[f"{number}: {'hose' if pipe.hose else 'steel'}, {pipe.length:g} m"] = middle + np.array([0.0, -0.02, 0.0])
    _write(stream, "rig/labels", list(words.values()), list(words))


def _bar(stream: Any) -> None:
    import rerun as rr

    boxes = rr.Boxes3D(
        half_sizes=[[0.03, 0.01, 0.51 / BARS]] * BARS,
        centers=[[LEGEND_X, 0.0, LEGEND_LOW + z] for z in np.linspace(0.0, 1.0, BARS)],
        colors=pressure_colours(np.linspace(LEGEND[0], LEGEND[-1], BARS) * 1e5),
        fill_mode="solid",
    )
    stream.log("rig/legend/bar", boxes, static=True)


def _marks(stream: Any) -> None:
    span = LEGEND[-1] - LEGEND[0]
    at = [[LEGEND_X + 0.06, 0.0, LEGEND_LOW + (mark - LEGEND[0]) / span] for mark in LEGEND]
    _write(stream, "rig/legend/marks", at, [f"{mark:g} bar" for mark in LEGEND])


def _write(stream: Any, entity: str, at: list[Any], words: list[str]) -> None:
    import rerun as rr

    points = rr.Points3D(at, radii=0.001, labels=words, colors=[INK], show_labels=True)
    stream.log(entity, points, static=True)
