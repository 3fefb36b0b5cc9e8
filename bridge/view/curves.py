"""Which curves a recording shows: in which picture, from which message, in the units people read."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import Recording

BAR, MM, US, PLAIN = 1e-5, 1e3, 1e-3, 1.0
UM, CM3, L_MIN = 1e6, 1e6, 6e4
PICTURES = {
    "position_mm": "position [mm]",
    "pressure_bar": "pressure [bar]: p1 relief valve, p2 lower chamber, p3 upper chamber",
    "valve": "valve [of full travel]",
    "relief_l_min": "flow over the relief valve [l/min]",
    "relief_um": "lifts in the relief valve [um]",
    "vapour_cm3": "vapour in all cavities [cm^3]",
    "wall_time_us": "wall time [us]",
}
BLUE, ORANGE, RED, GREY = (76, 146, 230), (240, 150, 50), (225, 85, 85), (150, 150, 150)
LEAST_VAPOUR = 1e-8  # [m^3], less is no cavity to look at
PALE_BLUE, PALE_ORANGE, GREEN = (60, 90, 130), (130, 95, 50), (95, 185, 110)
MARGIN = 0.06  # of an axis, above and below its curves


class Curve(NamedTuple):
    """One line of a picture."""

    picture: str
    name: str
    label: str
    topic: str
    field: str
    scale: float  # from what the message holds (SI, or ns of wall time) to what is shown
    colour: tuple[int, int, int]
    width: float  # [points]
    held: bool = False  # a value is in force until the next one

    @property
    def entity(self) -> str:
        """Where it stands in the viewer."""
        return f"{self.picture}/{self.name}"


CURVES = (
    Curve("position_mm", "reference", "reference", "reference", "position", MM, GREY, 1.5, held=True),
    Curve("position_mm", "piston", "piston", "state", "position", MM, BLUE, 2.0),
    Curve("pressure_bar", "p2_measured", "p2", "measurement", "p2", BAR, PALE_BLUE, 1.0),
    Curve("pressure_bar", "p3_measured", "p3", "measurement", "p3", BAR, PALE_ORANGE, 1.0),
    Curve("pressure_bar", "p1_measured", "p1", "measurement", "p1", BAR, GREY, 1.0),
    Curve("pressure_bar", "p_lower", "p2 true", "state", "p_lower", BAR, BLUE, 1.5),
    Curve("pressure_bar", "p_upper", "p3 true", "state", "p_upper", BAR, ORANGE, 1.5),
    Curve("valve", "command", "command", "state", "reference", PLAIN, GREY, 1.0, held=True),
    Curve("valve", "spool", "spool", "state", "spool", PLAIN, RED, 1.5),
    Curve("wall_time_us", "lateness", "lateness of the tick", "timing", "lateness", US, GREEN, 1.0),
    Curve("wall_time_us", "round_trip", "measurement to command", "timing", "round_trip", US, ORANGE, 1.0),
)

HAPPENINGS = (  # shown where something happened
    Curve("relief_l_min", "flow", "flow", "state", "flow_relief", L_MIN, BLUE, 1.5),
    Curve("relief_um", "pilot", "pilot", "state", "relief_pilot", UM, ORANGE, 1.0),
    Curve("relief_um", "main_stage", "main stage", "state", "relief_spool", UM, BLUE, 1.5),
    Curve("vapour_cm3", "vapour", "vapour", "state", "vapour", CM3, RED, 1.5),
)


def vapour(state: Mapping[str, NDArray]) -> NDArray[np.float64]:
    """Volume of all cavities [m^3] at every stamp."""
    return np.sum([values for name, values in state.items() if name.startswith("cavity_")], axis=0)


def happened(state: Mapping[str, NDArray]) -> dict[str, bool]:
    """By picture, whether a run has anything to show in it: the relief valve opened or shut, oil became vapour."""
    passing = state["flow_relief"] > 0.0
    moved = bool(passing.any() and not passing.all())
    return {
        "relief_l_min": moved,
        "relief_um": moved,
        "vapour_cm3": float(vapour(state).max(initial=0.0)) > LEAST_VAPOUR,
    }


def samples(curve: Curve, columns: dict[str, NDArray]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Stamps [ns] and values as shown; what was not measured (NaN, a round trip of -1) is left out."""
    values = columns[curve.field]
    there = values >= 0 if curve.topic == "timing" else np.isfinite(values)
    return columns["stamp"][there], values[there] * curve.scale


class Drawn(NamedTuple):
    """A curve with its points."""

    curve: Curve
    stamps: NDArray[np.int64]  # [ns] of simulated time
    values: NDArray[np.float64]  # in the picture's unit


def draw(recording: Recording) -> list[Drawn]:
    """The curves that have something to show."""
    columns = {topic: recording.columns(topic) for topic in {curve.topic for curve in CURVES}}
    shown = happened(columns["state"])
    columns["state"] |= {"vapour": vapour(columns["state"])}
    chosen = [*CURVES, *(curve for curve in HAPPENINGS if shown[curve.picture])]
    filled = [Drawn(curve, *samples(curve, columns[curve.topic])) for curve in chosen]
    return [drawn for drawn in filled if len(drawn.stamps)]


def span(curves: list[Drawn], picture: str) -> tuple[float, float]:
    """What the vertical axis of a picture must hold, with a margin."""
    inside = [drawn.values for drawn in curves if drawn.curve.picture == picture]
    low, high = min(map(np.min, inside)), max(map(np.max, inside))
    margin = MARGIN * (high - low) or 1.0
    return float(low - margin), float(high + margin)
