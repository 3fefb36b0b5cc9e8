"""Words and the scale of colours in the 3-D picture of the rig."""

from typing import Any

import numpy as np

from bridge.drawing.colours import LEGEND, pressure_colours
from bridge.scenario.fitted import is_motor, kind_of
from bridge.view.rig.extras import accessories, block_at, bottle_at
from bridge.view.rig.routes import Points
from bridge.view.rig.stage import (
    CAVITY_SCALE,
    DRUM,
    LIFT_SCALE,
    PUMP,
    RELIEF_AT,
    TANK,
    UP,
    VALVE,
    Pipe,
    Stage,
)
from twin.topology import CHAMBERS, TAPS

PAPER, INK = (236, 240, 246), (190, 198, 208)
FRONT, ASIDE = np.array([0.0, -0.03, -0.03]), np.array([0.14, -0.03, 0.03])
OFFSET: dict[str, Points] = dict.fromkeys(CHAMBERS, ASIDE)  # of a tap's label
VALVE_WORDS = {
    "proportional": "valve, travel enlarged",
    "switching": "valve, travel enlarged",
    "servo": "servo valve, travel enlarged",
}
SUPPLY_WORDS = {"gear": "pump", "fixed": "fixed pump", "variable": "variable pump", "pressure": "pressure source"}
RELIEF_WORDS = {"two-stage": f"relief valve, lifts x{LIFT_SCALE:g}", "direct": "relief valve, direct"}
LOAD_WORDS = {"environment": "load in springs", "compliant": "two masses on a link", "lever": "lever"}
PORT_OF = {"lower": "A", "upper": "B"}
LEGEND_X, LEGEND_LOW, BARS = -0.62, 0.25, 60  # [m], [m], colours; a metre high


def label(stream: Any, stage: Stage) -> None:
    """Taps, names, and the bar of colours."""
    _taps(stream, stage)
    _names(stream, stage)
    _bar(stream, legend_x(stage))
    _marks(stream, legend_x(stage))


def _taps(stream: Any, stage: Stage) -> None:
    """Points beside the taps: what they read follows."""
    import rerun as rr

    for tap, place in TAPS.items():
        at = stage.ports[place] + OFFSET.get(place, FRONT)
        point = rr.Points3D([at], radii=0.001, colors=[PAPER], show_labels=True)
        stream.log(f"rig/taps/{tap}", point, static=True)


def _names(stream: Any, stage: Stage) -> None:
    words = {
        VALVE_WORDS[kind_of(stage.values, "directional valve")]: VALVE + 0.13 * UP,
        SUPPLY_WORDS[kind_of(stage.values, "supply")]: PUMP + np.array([0.0, -0.07, -0.06]),
        "tank": TANK + np.array([0.25, -0.2, -0.2]),
        f"violet: vapour; balls: cavities, x{CAVITY_SCALE:g}": np.array([-0.24, 0.0, 0.14]),
        **_further(stage),
    }
    for number, pipe in enumerate(stage.pipes, 1):
        middle = pipe.pieces[len(pipe.pieces) // 2][0]
        words[f"{number}: {_pipe_words(pipe)}"] = middle + np.array([0.0, -0.02, 0.0])
    _write(stream, "rig/labels", list(words.values()), list(words))


def _pipe_words(pipe: Pipe) -> str:
    if pipe.model == "none":
        return "manifold"
    words = f"{'hose' if pipe.hose else 'steel'}, {pipe.length:g} m"
    return f"{words}, as a volume" if pipe.model == "volume" else words


def _further(stage: Stage) -> dict[str, Points]:
    """Names of what the drive has beside that."""
    values, axis, words = stage.values, stage.axis, {}
    relief = kind_of(values, "relief valve")
    if relief != "none":
        words[RELIEF_WORDS[relief]] = RELIEF_AT + 0.14 * UP
    if kind_of(values, "accumulator") != "none":
        words["accumulator"] = bottle_at(stage) - 0.1 * UP
    for chamber, kind in accessories(stage).items():
        words[f"{PORT_OF[chamber]}: {kind}"] = block_at(stage, chamber) + np.array([-0.3, -0.06, 0.0])
    if is_motor(values):
        words["motor, its size not to scale"] = axis.base + np.array([-0.1, -0.1, -DRUM - 0.08])
        return words
    if kind_of(values, "cushions") != "none":
        words["cushioned ends"] = axis.at(stage.stroke + 0.1) - 0.12 * axis.normal
    load = LOAD_WORDS.get(kind_of(values, "load"))
    if load:
        words[load] = axis.at(axis.outer_face + 0.5 * stage.stroke) + np.array([0.0, -0.5 * axis.plate, 0.05])
    return words


def legend_x(stage: Stage) -> float:
    """Where the colours stand: to the left of all bodies [m]."""
    axis = stage.axis
    places = axis.at([0.0, stage.stroke, axis.outer_face, axis.outer_face + stage.stroke])
    return min(LEGEND_X, float(places[:, 0].min()) - 0.45)


def _bar(stream: Any, x: float) -> None:
    import rerun as rr

    boxes = rr.Boxes3D(
        half_sizes=[[0.03, 0.01, 0.51 / BARS]] * BARS,
        centers=[[x, 0.0, LEGEND_LOW + z] for z in np.linspace(0.0, 1.0, BARS)],
        colors=pressure_colours(np.linspace(LEGEND[0], LEGEND[-1], BARS) * 1e5),
        fill_mode="solid",
    )
    stream.log("rig/legend/bar", boxes, static=True)


def _marks(stream: Any, x: float) -> None:
    span = LEGEND[-1] - LEGEND[0]
    at = [[x + 0.06, 0.0, LEGEND_LOW + (mark - LEGEND[0]) / span] for mark in LEGEND]
    _write(stream, "rig/legend/marks", at, [f"{mark:g} bar" for mark in LEGEND])


def _write(stream: Any, entity: str, at: list[Any], words: list[str]) -> None:
    import rerun as rr

    points = rr.Points3D(at, radii=0.001, labels=words, colors=[INK], show_labels=True)
    stream.log(entity, points, static=True)
