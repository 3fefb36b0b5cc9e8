"""The circuit in tables: places, pipes, what a run observes, and the channels of the card.

Plain data without numba, for whoever integrates, lists, names or draws the circuit. Rows may be added; the order of
PLACES, PIPES and OBSERVED is that of the arrays of the plant and of the messages.
"""

from typing import Any, NamedTuple


class Place(NamedTuple):
    """Where components and line ends meet."""

    pressure: str  # the observed quantity
    words: str


class Pipe(NamedTuple):
    """A line between two places; flow from the first to the second is positive."""

    first: str
    second: str


class Channel(NamedTuple):
    """A sensor and its channel of the card."""

    reads: str  # the observed quantity that it touches
    span: str  # field of the scenario's `daq` that states its range
    note: str  # in the message definition, behind the unit
    words: str  # where it is or what it is, on pictures
    signed: bool = False  # the range is -span .. span, else 0 .. span
    switch: str = ""  # field of `daq` that says whether it is fitted; without one it always is

    @property
    def unit(self) -> str:
        """SI."""
        return OBSERVED[self.reads]


class Sensor(NamedTuple):
    """What a further channel of the card may read."""

    unit: str  # SI
    span: str  # field of the scenario's `daq` that states its range; without one it is 1
    note: str  # in the message definition, behind the unit
    signed: bool = False  # the range is -span .. span, else 0 .. span

    def ends(self, daq: Any) -> tuple[float, float]:
        """Its range on a card with a section of settings, SI."""
        span = float(getattr(daq, self.span)) if self.span else 1.0
        return -span if self.signed else 0.0, span


TANK = "tank"  # at no pressure, no place of its own
PLACES = {
    "pump": Place("p_pump", "pump"),
    "tee": Place("p1", "tee"),
    "p": Place("p_p", "port P"),
    "a": Place("p_a", "port A"),
    "lower": Place("p_lower", "lower chamber"),
    "upper": Place("p_upper", "upper chamber"),
    "b": Place("p_b", "port B"),
    "t": Place("p_t", "port T"),
    "return": Place("p_return", "return tee"),
}
CHAMBERS = ("lower", "upper")
PORTS = tuple(place for place in PLACES if place not in CHAMBERS)  # places without a volume of their own

PIPES = {  # by their part of the rig
    "pipe_1": Pipe("pump", "tee"),
    "pipe_2": Pipe("tee", "p"),
    "pipe_3": Pipe("a", "lower"),
    "pipe_4": Pipe("b", "upper"),
    "pipe_5": Pipe("t", "return"),
    "pipe_6": Pipe("return", TANK),
}
LINES = len(PIPES)
RELIEF_LINE = "pipe_7"  # from the tee to the relief valve, where it has a line of its own; recordings leave it out
POINTS = 11  # along each line, from its first end (behind a fitting) to its second
ENDS = tuple(place for pipe in PIPES.values() for place in pipe)  # line i has ends 2 i and 2 i + 1, from 0
RELIEF_END = len(ENDS)  # the tee's end of the relief valve's own line; the valve's end follows
END_COUNT = len(ENDS) + 2  # with those of that line
END_OF = {place: ENDS.index(place) for place in PLACES}  # the end that has the pressure of a place
FLOWS = tuple(f"flow_{line}" for line in range(1, LINES + 1))
HOLLOWS = (*CHAMBERS, *PORTS, *(f"line_{line}" for line in range(1, LINES + 1)))  # inside a line: model `nodes` only


def cavity(hollow: str) -> str:
    """The observed quantity that is the cavity at a place."""
    return f"cavity_{hollow}"


OBSERVED = {  # name: SI unit
    "position": "m",
    "velocity": "m/s",
    "spool": "",
    **{place.pressure: "Pa" for place in PLACES.values()},
    **{cavity(place): "m^3" for place in CHAMBERS},
    **dict.fromkeys((*FLOWS, "flow_pump", "flow_relief"), "m^3/s"),
    **dict.fromkeys(("relief_pilot", "relief_spool"), "m"),
    "mass": "kg",
    "friction": "N",
    **{cavity(place): "m^3" for place in (*PORTS, "lines")},
    **dict.fromkeys(("oil_stored", "oil_pumped", "oil_relieved", "oil_returned"), "m^3"),
}
SLOTS = (  # of the circuit whose kinds may keep numbers of their own
    "supply",
    "accumulator",
    "fittings",
    "relief",
    "return_end",
    "valve",
    "accessory_a",
    "accessory_b",
    "cushion",
    "actuator",
    "friction",
    "load",
)
SLOT = 12  # numbers that the kind in a slot may keep
ROOM = {"valve": 136}  # where some need more: the commands of a delay
SLOT_SIZES = tuple(ROOM.get(name, SLOT) for name in SLOTS)

BALANCE_UNITS = {"force_balance": "Pa", "speed_balance": "m/s", "sink_balance": "m/s"}

CAVITIES = tuple(name for name in OBSERVED if name.startswith(cavity("")))

CHANNELS = {  # in the order in which the card reads them
    "position": Channel("position", "position_range", ", positive as port A drives it", "piston"),
    "velocity": Channel(
        "velocity", "velocity_range", ", tachometer; NaN when absent", "piston", signed=True, switch="tachometer"
    ),
    "p1": Channel("p1", "pressure_range", " gauge, tee of the relief valve", "relief valve"),
    "p2": Channel("p_lower", "pressure_range", " gauge, p_lower: chamber of port A (pipe_3)", "lower chamber"),
    "p3": Channel("p_upper", "pressure_range", " gauge, p_upper: chamber of port B (pipe_4)", "upper chamber"),
}
PRESSURES = tuple(name for name, channel in CHANNELS.items() if channel.unit == "Pa")
PLACE_OF = {place.pressure: name for name, place in PLACES.items()}
TAPS = {tap: PLACE_OF[CHANNELS[tap].reads] for tap in PRESSURES}  # where they are

SENSORS = {  # of every drive: what the scenario's `daq.channels` may name
    **{place.pressure: Sensor("Pa", "pressure_range", f" gauge, {place.words}") for place in PLACES.values()},
    **{
        flow: Sensor("m^3/s", "flow_range", f", {name} from {pipe.first} to {pipe.second}", signed=True)
        for flow, (name, pipe) in zip(FLOWS, PIPES.items(), strict=True)
    },
    "flow_pump": Sensor("m^3/s", "flow_range", ", what the supply delivers", signed=True),
    "flow_relief": Sensor("m^3/s", "flow_range", ", through the relief valve", signed=True),
    "spool": Sensor("", "", ", of the directional valve, share of its travel", signed=True),
    "force": Sensor("N", "force_range", ", of the rod on its load, positive as port A pushes", signed=True),
    "acceleration": Sensor("m/s^2", "acceleration_range", ", of the piston, positive as port A drives it", signed=True),
}
