"""Which curves a recording shows: in which picture, from which message, in the units people read."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.recording.reader import Recording

BAR, MM, US, PER_MINUTE, UM, CM3, PLAIN = 1e-5, 1e3, 1e-3, 6e4, 1e6, 1e6, 1.0
PICTURES = {
    "position_mm": "position [mm]",
    "pressure_bar": "pressure [bar]: p1 at the relief valve, p2 lower chamber, p3 upper chamber",
    "valve": "valve [of full travel]",
    "flow_l_min": "flow [l/min]",
    "wall_time_us": "wall time [us]",
    "relief_um": "relief lifts [um]",
    "cavity_cm3": "cavities [cm^3]",
    "measured_bar": "measured [bar]",
    "places_bar": "all places [bar]",
}
BLUE, ORANGE, RED, GREY = (76, 146, 230), (240, 150, 50), (225, 85, 85), (150, 150, 150)
PALE_BLUE, PALE_ORANGE, GREEN, VIOLET = (60, 90, 130), (130, 95, 50), (95, 185, 110), (180, 120, 230)
LIVE = {  # what the axes hold before anybody knows
    "position_mm": (-10.0, 280.0),
    "pressure_bar": (-5.0, 85.0),
    "valve": (-1.1, 1.1),
    "flow_l_min": (-70.0, 50.0),
    "places_bar": (-5.0, 85.0),
}
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
    Curve("measured_bar", "p2", "p2", "measurement", "p2", BAR, BLUE, 1.0),
    Curve("measured_bar", "p3", "p3", "measurement", "p3", BAR, ORANGE, 1.0),
    Curve("measured_bar", "p1", "p1", "measurement", "p1", BAR, RED, 1.0),
    Curve("pressure_bar", "p1", "p1", "state", "p1", BAR, RED, 1.5),
    Curve("pressure_bar", "p_lower", "p2", "state", "p_lower", BAR, BLUE, 1.5),
    Curve("pressure_bar", "p_upper", "p3", "state", "p_upper", BAR, ORANGE, 1.5),
    Curve("valve", "command", "command", "state", "reference", PLAIN, GREY, 1.0, held=True),
    Curve("valve", "spool", "spool", "state", "spool", PLAIN, RED, 1.5),
    Curve("flow_l_min", "pump", "pump", "state", "flow_pump", PER_MINUTE, GREY, 1.0),
    Curve("flow_l_min", "relief", "relief valve", "state", "flow_relief", PER_MINUTE, RED, 1.5),
    Curve("flow_l_min", "lower", "to the lower chamber", "state", "flow_3", PER_MINUTE, BLUE, 1.5),
    Curve("flow_l_min", "upper", "to the upper chamber", "state", "flow_4", PER_MINUTE, ORANGE, 1.5),
    Curve("relief_um", "spool", "main spool", "state", "relief_spool", UM, BLUE, 1.5),
    Curve("relief_um", "pilot", "pilot poppet", "state", "relief_pilot", UM, RED, 1.5),
    *(
        Curve("cavity_cm3", name, words, "state", f"cavity_{name}", CM3, colour, 1.5)
        for name, words, colour in (
            ("lower", "lower chamber", BLUE),
            ("upper", "upper chamber", ORANGE),
            ("a", "port A", PALE_BLUE),
            ("b", "port B", PALE_ORANGE),
            ("t", "port T", GREEN),
            ("return", "return tee", GREY),
            ("tee", "tee of the relief valve", RED),
            ("lines", "inside the lines", VIOLET),
        )
    ),
    *(
        Curve("places_bar", name, words, "state", name, BAR, colour, 1.0)
        for name, words, colour in (
            ("p_pump", "pump", GREY),
            ("p1", "tee, p1", RED),
            ("p_p", "port P", VIOLET),
            ("p_a", "port A", PALE_BLUE),
            ("p_lower", "lower chamber, p2", BLUE),
            ("p_b", "port B", PALE_ORANGE),
            ("p_upper", "upper chamber, p3", ORANGE),
            ("p_t", "port T", GREEN),
            ("p_return", "return tee", (200, 200, 120)),
        )
    ),
    Curve("wall_time_us", "lateness", "lateness of the tick", "timing", "lateness", US, GREEN, 1.0),
    Curve("wall_time_us", "round_trip", "measurement to command", "timing", "round_trip", US, ORANGE, 1.0),
)


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
    filled = [Drawn(curve, *samples(curve, columns[curve.topic])) for curve in CURVES]
    return [drawn for drawn in filled if len(drawn.stamps)]


def span(curves: list[Drawn], picture: str) -> tuple[float, float]:
    """What the vertical axis of a picture must hold, with a margin."""
    inside = [drawn.values for drawn in curves if drawn.curve.picture == picture]
    low, high = min(map(np.min, inside)), max(map(np.max, inside))
    margin = MARGIN * (high - low) or 1.0
    return float(low - margin), float(high + margin)
