"""Pressure as a colour: violet at the vapour pressure, blue at the tank's, red at the highest; the same everywhere."""

import numpy as np
from numpy.typing import NDArray

STOPS = (  # [bar], red, green, blue
    (-1.0, 214, 66, 214),
    (-0.5, 120, 70, 190),
    (0.0, 46, 84, 166),
    (12.0, 40, 136, 190),
    (25.0, 44, 172, 142),
    (40.0, 158, 202, 76),
    (55.0, 246, 206, 70),
    (70.0, 240, 136, 46),
    (100.0, 204, 36, 44),
)
LEGEND = (0.0, 20.0, 40.0, 60.0, 80.0, 100.0)  # [bar], where a bar of colours has its marks
LIGHT = {  # of curves on paper
    "blue": "#2a6fbb",
    "orange": "#e08a1e",
    "red": "#c8413b",
    "green": "#3a9150",
    "grey": "#8a8f98",
    "violet": "#8a5cc2",
    "pale blue": "#8fb4dc",
    "pale orange": "#efc48a",
    "yellow": "#b5a642",
}
DARK = {  # of curves in the view
    "blue": (76, 146, 230),
    "orange": (240, 150, 50),
    "red": (225, 85, 85),
    "green": (95, 185, 110),
    "grey": (150, 150, 150),
    "violet": (180, 120, 230),
    "pale blue": (60, 90, 130),
    "pale orange": (130, 95, 50),
    "yellow": (200, 200, 120),
}
CAVITY = (255, 90, 255)
UNKNOWN = (24, 28, 36)  # no pressure, NaN: the background


def pressure_colours(pressure: NDArray[np.float64]) -> NDArray[np.uint8]:
    """RGB for pressures [Pa], one more axis; beyond the ends the colours of the ends, UNKNOWN for NaN."""
    bar = np.asarray(pressure) * 1e-5
    at, *channels = zip(*STOPS, strict=True)
    known = np.isfinite(bar)[..., None]
    shown = np.stack([np.interp(bar, at, channel) for channel in channels], axis=-1)
    return np.where(known, shown, UNKNOWN).round().astype(np.uint8)
