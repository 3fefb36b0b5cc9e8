"""How the signals of the true state are shown: in which picture, with which words, unit and colour.

One table for the report, the view and the picture of a run; a further channel of the card has its curve by its row in
`twin.topology`.
"""

from typing import NamedTuple

from bridge.scenario.fitted import Values, of_drive
from bridge.scenario.units import shown
from twin.topology import CHAMBERS, CHANNELS, OBSERVED, PIPES, PLACES, PRESSURES, TANK, TAPS, cavity

ORDER = ("red", "blue", "orange", "green", "violet", "grey")  # of curves that have no colour of their own
SEEN_ELSEWHERE = ("position", "velocity", *PRESSURES)  # channels with a picture, or the slope of one


class Curve(NamedTuple):
    """One signal of the true state."""

    name: str  # within its picture
    field: str
    label: str
    colour: str  # in LIGHT and DARK of `bridge.drawing.colours`
    held: bool = False  # a value is in force until the next one


class Group(NamedTuple):
    """Signals that share a picture and its axis."""

    title: str
    what: str  # on the axis
    scale: float  # from SI to what is shown
    unit: str
    curves: tuple[Curve, ...]

    @property
    def axis(self) -> str:
        """What the axis says, with its unit."""
        return f"{self.what} [{self.unit.replace('^3', '³')}]"


def place_words(place: str) -> str:
    """A place of the circuit for people, with its taps: "tee, p1"."""
    words = PLACES[place].words if place in PLACES else TANK
    return ", ".join((words, *(tap for tap, at in TAPS.items() if at == place)))


def tap_words(channel: str) -> str:
    """A channel with what it is: "p2 lower chamber"."""
    return f"{channel} {CHANNELS[channel].words}"


def line_ends(values: Values) -> tuple[tuple[str, str], ...]:
    """The places at both ends of each line, for people, in the words of a drive."""
    return tuple(
        (of_drive(place_words(pipe.first), values), of_drive(place_words(pipe.second), values))
        for pipe in PIPES.values()
    )


PLACE_COLOURS = {
    "pump": "grey",
    "tee": "red",
    "p": "violet",
    "a": "pale blue",
    "lower": "blue",
    "upper": "orange",
    "b": "pale orange",
    "t": "green",
    "return": "yellow",
}
HOLLOW = {place: PLACE_COLOURS[place] for place in (*CHAMBERS, "a", "b", "t", "return", "tee")}


def _measured(unit: str) -> Group:
    """The channels of a unit that no other picture shows."""
    names = [name for name in FURTHER if CHANNELS[name].unit == unit]
    curves = (Curve(n, CHANNELS[n].reads, tap_words(n), c) for n, c in zip(names, ORDER * len(names), strict=False))
    return Group(f"Measured [{unit}]", ", ".join(names), *shown(unit), tuple(curves))


FURTHER = tuple(name for name in CHANNELS if name not in SEEN_ELSEWHERE)
GROUPS = {
    "position": Group("Position", "position", *shown("m"), (Curve("piston", "position", "piston", "blue"),)),
    "pressure": Group(
        "Pressures",
        "pressure",
        *shown("Pa"),
        tuple(
            Curve(CHANNELS[tap].reads, CHANNELS[tap].reads, tap_words(tap), colour)
            for tap, colour in zip(PRESSURES, ORDER * len(PRESSURES), strict=False)
        ),
    ),
    "valve": Group(
        "Valve",
        "valve",
        1.0,
        "of travel",
        (Curve("command", "reference", "command", "grey", held=True), Curve("spool", "spool", "spool", "red")),
    ),
    "flow": Group(
        "Flows",
        "flow",
        *shown("m^3/s"),
        (
            Curve("pump", "flow_pump", "pump", "grey"),
            Curve("relief", "flow_relief", "relief valve", "red"),
            Curve("lower", "flow_3", "to the lower chamber", "blue"),
            Curve("upper", "flow_4", "to the upper chamber", "orange"),
        ),
    ),
    "relief": Group(
        "Relief valve",
        "lift",
        *shown("m", "um"),
        (
            Curve("spool", "relief_spool", "main spool", "blue"),
            Curve("pilot", "relief_pilot", "pilot poppet", "red"),
        ),
    ),
    "cavities": Group(
        "Cavities",
        "vapour",
        *shown("m^3"),
        (
            *(Curve(place, cavity(place), PLACES[place].words, colour) for place, colour in HOLLOW.items()),
            Curve("lines", cavity("lines"), "inside the lines", "violet"),
        ),
    ),
    "places": Group(
        "Places",
        "all places",
        *shown("Pa"),
        tuple(Curve(p.pressure, p.pressure, place_words(name), PLACE_COLOURS[name]) for name, p in PLACES.items()),
    ),
    **{f"measured_{unit}": _measured(unit) for unit in dict.fromkeys(CHANNELS[name].unit for name in FURTHER)},
}
MEASURED = tuple(name for name in GROUPS if name.startswith("measured_"))
assert {curve.field for group in GROUPS.values() for curve in group.curves} <= {*OBSERVED, "reference"}
