"""From where the rig is seen: as far away as its bodies reach."""

from collections.abc import Mapping

import numpy as np

from bridge.scenario.fitted import is_motor
from bridge.view.rig.stage import DRUM, Stage

Place = tuple[float, float, float]  # [m]
Eye = tuple[Place, Place]  # position and target
Eyes = Mapping[str, Eye]
EYES: Eyes = {
    "rig": ((0.98, -2.7, 1.2), (0.98, 0.0, 0.8)),
    "cylinder": ((0.42, -0.8, 1.3), (0.06, 0.0, 1.04)),
    "valves": ((1.0, -0.42, 1.08), (0.88, 0.0, 0.92)),
}
LEFT, RIGHT, HIGH = -0.75, 2.7, 1.6  # [m], what EYES has in sight
SEEN = 1.4  # [m], greatest reach of a cylinder that is seen from near as in EYES


def eyes_of(stage: Stage) -> Eyes:
    """EYES for a drive that has room in them, else from farther away."""
    low, high = _reach(stage)
    wide = max(RIGHT - min(LEFT, low[0] - 0.4), 1.6 * max(HIGH, high[2] + 0.2))
    whole = float(wide / (RIGHT - LEFT))
    near = max(1.0, float(np.max(high - low)) / SEEN)
    middle = 0.5 * (low + high)
    found = dict(EYES)
    if whole > 1.0:
        x, z = 0.5 * (RIGHT + min(LEFT, float(low[0]) - 0.4)), 0.5 * max(HIGH, float(high[2]) + 0.2)
        found["rig"] = (x, -2.7 * whole, z + 0.4 * whole), (x, 0.0, z)
    if near > 1.0 or not _upright(stage):
        x, z = float(middle[0]), float(middle[2])
        found["cylinder"] = (x + 0.3 * near, -1.1 * near, z + 0.25 * near), (x, 0.0, z)
    return found


def _upright(stage: Stage) -> bool:
    return bool(stage.axis.along[2] > 0.99 and stage.axis.side < 0)


def _reach(stage: Stage) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of barrel, rods and load, or of a motor's drum [m]."""
    axis = stage.axis
    if is_motor(stage.values):
        return axis.base - DRUM, axis.base + DRUM
    places = axis.at([0.0, stage.stroke, axis.outer_face, axis.outer_face + stage.stroke])
    return places.min(axis=0), places.max(axis=0)
