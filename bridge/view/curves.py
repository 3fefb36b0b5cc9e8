"""Which curves a recording shows: in which picture, from which message, in the units people read."""

import re
from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.colours import DARK
from bridge.recording.own_signals import own_units
from bridge.recording.reader import Recording
from bridge.recording.seen import STATE, seen
from bridge.recording.shown import GROUPS, MEASURED, ORDER, tap_words
from bridge.scenario.units import shown
from bridge.view import followed
from bridge.view.curve import Curve
from bridge.wire.channels import Layout
from bridge.wire.messages import CHANNELS_TOPIC
from twin.topology import PRESSURES

US = 1e-3  # from [ns]
PICTURES = {  # in the viewer: its title
    "position_mm": GROUPS["position"].axis,
    "pressure_bar": f"{GROUPS['pressure'].axis}: {', '.join(map(tap_words, PRESSURES))}",
    **{name: GROUPS[name].axis for name in MEASURED},
    "valve": GROUPS["valve"].axis,
    "flow_l_min": GROUPS["flow"].axis,
    "wall_time_us": "wall time [us]",
    "relief_um": f"relief valve: {GROUPS['relief'].axis}",
    "cavity_cm3": GROUPS["cavities"].axis,
    "measured_bar": "measured [bar]",
    "places_bar": GROUPS["places"].axis,
}
TRUE = {  # group: picture, width of its curves [points]
    "position": ("position_mm", 2.0),
    "pressure": ("pressure_bar", 1.5),
    **{name: (name, 1.5) for name in MEASURED},
    "valve": ("valve", 1.5),
    "flow": ("flow_l_min", 1.5),
    "relief": ("relief_um", 1.5),
    "cavities": ("cavity_cm3", 1.5),
    "places": ("places_bar", 1.0),
}
LIVE = {  # what the axes hold before anybody knows
    "position_mm": (-10.0, 280.0),
    "pressure_bar": (-5.0, 85.0),
    "valve": (-1.1, 1.1),
    "flow_l_min": (-70.0, 50.0),
    "places_bar": (-5.0, 85.0),
}
MARGIN = 0.06  # of an axis, above and below its curves


def _true(group: str) -> list[Curve]:
    """The curves of a group; what is held or delivered stays thin in the background."""
    picture, width = TRUE[group]
    return [
        Curve(
            picture,
            curve.name,
            curve.label,
            "state",
            curve.field,
            GROUPS[group].scale,
            DARK[curve.colour],
            min(width, 1.0) if curve.colour == "grey" else width,
            curve.held,
        )
        for curve in GROUPS[group].curves
    ]


def _measured(tap: str) -> Curve:
    """What the card read at a tap, in the colour of what stood there."""
    pressure = GROUPS["pressure"]
    colour = next(curve.colour for curve in pressure.curves if curve.label == tap_words(tap))
    return Curve("measured_bar", tap, tap, "measurement", tap, pressure.scale, DARK[colour], 1.0)


_REFERENCE = Curve(
    "position_mm",
    "reference",
    "reference",
    "reference",
    "position",
    GROUPS["position"].scale,
    DARK["grey"],
    1.5,
    held=True,
)
CURVES = (
    _REFERENCE,
    *map(_measured, PRESSURES),
    *(curve for group in TRUE for curve in _true(group)),
    Curve("wall_time_us", "lateness", "lateness of the tick", "timing", "lateness", US, DARK["green"], 1.0),
    Curve("wall_time_us", "round_trip", "measurement to command", "timing", "round_trip", US, DARK["orange"], 1.0),
)


class Own(NamedTuple):
    """Where curves come from that only some runs have."""

    topic: str
    pictures: str  # their names begin so
    words: str  # and their titles
    held: bool  # a value is in force until the next one


OWN = Own("signals", "own_signals", "law", True)
FURTHER = Own(CHANNELS_TOPIC, "channels", "further channels", False)


def own_picture(unit: str, own: Own = OWN) -> str:
    """The picture of such signals of a unit."""
    return "_".join([own.pictures, *re.findall(r"[A-Za-z0-9]+", unit)])


def own_curves(units: Mapping[str, str], own: Own = OWN) -> list[Curve]:
    """The curves of such signals, by name and unit: a picture for each unit."""
    curves: list[Curve] = []
    for name, unit in units.items():
        picture, scale = own_picture(unit, own), shown(unit)[0]
        before = sum(curve.picture == picture for curve in curves)
        colour = DARK[ORDER[before % len(ORDER)]]
        curves.append(Curve(picture, name, name, own.topic, name, scale, colour, 1.5, held=own.held))
    return curves


def own_titles(units: Mapping[str, str], own: Own = OWN) -> dict[str, str]:
    """The titles of those pictures."""
    return {own_picture(unit, own): f"{own.words} [{shown(unit)[1]}]".replace(" []", "") for unit in units.values()}


class Chosen(NamedTuple):
    """The curves that a recording has of its own, and the titles of their pictures."""

    curves: list[Curve]
    titles: dict[str, str]


def chosen(layout: Layout, logged: Mapping[str, str], topics: Collection[str] = ()) -> Chosen:
    """Those of a follower among the topics, of further channels, and of what a law logs, by name and unit."""
    units = {field.name: field.unit for field in layout}
    curves = [*followed.curves(topics), *own_curves(units, FURTHER), *own_curves(logged)]
    return Chosen(curves, followed.titles(topics) | own_titles(units, FURTHER) | own_titles(logged))


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


def chosen_in(recording: Recording) -> Chosen:
    """What a recording has of its own."""
    return chosen(recording.layout(), own_units(recording), {*recording.counts})


def draw(recording: Recording) -> list[Drawn]:
    """The curves that have something to show."""
    curves = [*CURVES, *chosen_in(recording).curves]
    topics = {curve.topic for curve in curves}
    columns = {topic: seen(recording) if topic == STATE else followed.columns_of(recording, topic) for topic in topics}
    filled = [Drawn(curve, *samples(curve, columns[curve.topic])) for curve in curves]
    return [drawn for drawn in filled if len(drawn.stamps)]


def span(curves: list[Drawn], picture: str) -> tuple[float, float]:
    """What the vertical axis of a picture must hold, with a margin."""
    inside = [drawn.values for drawn in curves if drawn.curve.picture == picture]
    low, high = min(map(np.min, inside)), max(map(np.max, inside))
    margin = MARGIN * (high - low) or 1.0
    return float(low - margin), float(high + margin)
