"""The circuit of a drive as a picture: what is fitted, with lengths, wave speeds and settings read from its numbers.

Symbols follow ISO 1219 where it has one. The weight that waits on its support is that of the load-change scenario.
"""

import math
from typing import NamedTuple

import numpy as np

from bridge.drawing.canvas import (
    Axes,
    Columns,
    Sheet,
    drawing,
)
from bridge.figures.circuit.kinds import METAL, ROD, beside, held, motor
from bridge.figures.circuit.symbols import (
    INK,
    OIL,
    STEEL,
    Points,
    arrow,
    box,
    circle,
    directional_valve,
    dot,
    fittings,
    part_of,
    pipe,
    shape,
    spring,
    tank,
    text,
    thin,
)
from bridge.scenario import load
from bridge.scenario.fitted import Values, has_relief_line, is_motor, kind_of, positive_words, rod_at, rod_words
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium, supply_at_rest
from twin.circuit.kinds import of_kind
from twin.circuit.step import Circuit
from twin.pump import Pump, pump_flow
from twin.rig import values
from twin.topology import ENDS, LINES

STEP = 50e-6  # [s]
BARREL, PISTON, THICK = (6.1, 8.9), 7.2, 0.32  # heights of the barrel's ends, of the piston drawn, and of its body
PIPE, CHAMBERS, MOVING, TRAVELLED = "pipe", "chambers", "moving", "travelled"  # parts that change in a live picture
TAP, KEY = "tap", "key"  # and parts that a small one leaves in or out
DARK_HOSE, ACCENT, BLUSH = "#a85a10", "#b3261e", "#fdecea"
LOW, TOP, RODS_ROOM = 0.35, 9.67, 1.5  # of the sheet; what a rod upwards needs
VALVES = {"proportional": "proportional\nor switching", "switching": "switching", "servo": "servo valve"}
ROUTES: tuple[Points, ...] = (  # of the six lines, in the direction of flow when the piston lifts
    ((1.3, 2.75), (1.3, 3.7), (3.9, 3.7)),
    ((3.9, 3.7), (8.9, 3.7), (8.9, 4.8)),
    ((9.7, 5.9), (9.7, 6.45), (12.55, 6.45)),
    ((12.55, 8.55), (8.9, 8.55), (8.9, 5.9)),
    ((9.7, 4.8), (9.7, 2.2), (11.1, 2.2)),
    ((11.1, 2.2), (11.9, 2.2), (11.9, 1.0)),
)
LABELS = ((1.45, 4.35), (6.75, 2.95), (10.65, 6.9), (10.55, 9.0), (8.6, 2.2), (13.35, 1.3))  # where each line is named
HEADS = ((2.6, 3.7), (5.98, 3.7), (10.4, 6.45), (10.2, 8.55), (9.7, 3.4), (11.6, 2.2))  # where its flow is shown
MARKS = ">>><v>"


class LineData(NamedTuple):
    """What is written beside a line."""

    number: int
    length: float  # [m]
    speed: float  # a [m/s]
    hose: bool
    model: str = "ends"

    @property
    def words(self) -> str:
        """Kind, length, wave speed and travel time."""
        if self.model == "none":
            return f"{self.number}: manifold"
        kind, travel = "hose" if self.hose else "steel", 1e3 * self.length / self.speed
        if self.model == "volume":
            return f"line {self.number}: {kind}, {self.length:g} m\nas a volume"
        return f"line {self.number}: {kind}, {self.length:g} m\n{self.speed:.0f} m/s, {travel:.2f} ms"


def rig_circuit() -> Circuit:
    """The rig as it stands."""
    return build(values(), STEP)


def line_data(rig: Values | None = None, circuit: Circuit | None = None) -> list[LineData]:
    """The six lines, from a rig and from what was built of it."""
    rig, circuit = rig or values(), circuit or rig_circuit()
    found = []
    for number in range(1, LINES + 1):
        entries = rig[f"pipe_{number}"]
        speed = entries["length"] / max(float(circuit.lines.travel_time[number - 1]), 1e-9)
        found.append(LineData(number, entries["length"], speed, entries["young"] < 1e10, entries["model"]))
    return found


def circuit_columns() -> Columns:
    """A row for each line end, in the order of the circuit's own; pressures at rest, the piston at 0.1 m."""
    circuit, lines = rig_circuit(), [line for line in line_data() for _ in range(2)]
    pressure = equilibrium(circuit, 0.1).ends.pressure
    return {
        "line [-]": np.array([float(line.number) for line in lines]),
        "end [1 first; 2 second]": np.tile([1.0, 2.0], LINES),
        "length [m]": np.array([line.length for line in lines]),
        "kind [0 steel; 1 hose]": np.array([float(line.hose) for line in lines]),
        "wave speed [m/s]": np.array([line.speed for line in lines]),
        "travel time [s]": np.repeat(circuit.lines.travel_time, 2),
        "impedance [Pa s/m^3]": np.repeat(circuit.lines.z0, 2),
        "pressure at rest [Pa]": np.array(pressure[: len(ENDS)]),
    }


def draw_circuit() -> tuple[Columns, Sheet]:
    """The whole picture of the rig."""
    rig = values() | {"load": load("load-change").rig_values()["load"]}
    return circuit_columns(), draw_drive(rig, rig_circuit())


def draw_drive(rig: Values, circuit: Circuit) -> Sheet:
    """The picture of a drive, of its values and the circuit that is built of them."""
    top = TOP + (0.0 if is_motor(rig) or rod_at(rig) == "a" else RODS_ROOM)
    page, axes = drawing(11.4, 6.25 * (top - LOW) / (TOP - LOW), (0.2, 17.2, LOW, top))
    for line, route, at in zip(line_data(rig, circuit), ROUTES, LABELS, strict=True):
        with part_of(axes, f"{PIPE}{line.number}"):
            pipe(axes, route, line.hose and line.model != "none")
        text(axes, *at, line.words, colour=DARK_HOSE if line.hose and line.model != "none" else STEEL)
    for (x, y), mark in zip(HEADS, MARKS, strict=True):
        axes.plot([x], [y], mark, color=INK, markersize=7.0, zorder=5)
    _pump(axes, rig, circuit)
    _relief_valve(axes, rig)
    fittings(axes, *(rig[name]["drop"] > 0.0 for name in ("filter", "two_position_valve")))
    directional_valve(axes, VALVES[kind_of(rig, "directional valve")], _moves(rig))
    beside(axes, rig)
    if is_motor(rig):
        motor(axes, rig)
    else:
        _cylinder(axes, rig)
    if rig["load"]["added"] > 0.0 and rod_at(rig) == "a":
        _weight(axes, rig)
    tank(axes, ROUTES[-1][-1][0], 1.0)
    dot(axes, 11.1, 2.2)
    text(axes, 11.1, 2.55, "return tee")
    with part_of(axes, TAP):
        _taps(axes)
    with part_of(axes, KEY):
        _key(axes, rig, circuit)
    return page


def _moves(rig: Values) -> tuple[str, str]:
    """What both ends of the valve's travel do."""
    word = positive_words(rig)
    return {"lifts": ("lowers", "lifts"), "lowers": ("lifts", "lowers")}.get(word, ("B", "A"))


def _pump(axes: Axes, rig: Values, circuit: Circuit) -> None:
    """Suction from the tank, the pump, its speed and flow."""
    tank(axes, 1.3, 1.0)
    thin(axes, (1.3, 0.8), (1.3, 1.75))
    circle(axes, 1.3, 2.25, 0.5)
    shape(axes, ((1.1, 2.45), (1.5, 2.45), (1.3, 2.75)), INK)
    if kind_of(rig, "supply") == "variable":
        arrow(axes, (0.75, 1.8), (1.85, 2.7))
    text(axes, 1.95, 2.25, _supply_words(rig, circuit), ha="left", size=8.5)


def _supply_words(rig: Values, circuit: Circuit) -> str:
    kind = kind_of(rig, "supply")
    if kind == "pressure":
        return f"constant\npressure\n{1e-5 * rig['pressure_source']['pressure']:.0f} bar"
    if kind != "gear":
        own = rig[f"{kind}_pump"]
        volume, speed = f"{1e6 * own['displacement']:.3g} cm³", f"{60.0 * own['speed']:.0f} rpm"
        cut = f"\ncut-off {1e-5 * own['cut_off']:.0f} bar" if kind == "variable" else ""
        return f"{kind} pump\n{volume}\n{speed}{cut}"
    at = rig["pump"]["efficiency_pressure"]
    flow = 6e4 * pump_flow(at, 1.0, of_kind(circuit.parts.supply, Pump))
    return f"gear pump\n{60.0 * rig['pump']['speed']:.0f} rpm\n{flow:.1f} l/min\nat {1e-5 * at:.0f} bar"


def _relief_valve(axes: Axes, rig: Values) -> None:
    """Main seat and the pilot that opens it, set for all of the pump's flow; a direct-operated one has its spring."""
    if (kind := kind_of(rig, "relief valve")) != "none":
        _relief_body(axes, rig, kind)
    dot(axes, 3.9, 3.7)


def _relief_body(axes: Axes, rig: Values, kind: str) -> None:
    x = 3.9
    thin(axes, (x, 3.7), (x, 2.65))
    box(axes, x - 0.4, 1.85, 0.8, 0.8)
    arrow(axes, (x - 0.12, 2.6), (x - 0.12, 1.9))
    thin(axes, (x, 1.85), (x, 0.8))
    tank(axes, x, 1.0)
    thin(axes, (x, 3.05), (x - 0.75, 3.05), (x - 0.75, 2.25), (x - 0.4, 2.25), dashed=True, width=1.1)
    pilot = 0.42 if kind == "two-stage" else 0.0
    if pilot:
        box(axes, x + 0.4, 2.03, pilot, 0.44)
        shape(axes, ((x + 0.74, 2.1), (x + 0.74, 2.4), (x + 0.46, 2.25)), INK)
    spring(axes, x + 0.4 + pilot, 2.25, 0.55)
    arrow(axes, (x + 0.5 + pilot, 1.98), (x + 0.88 + pilot, 2.56))
    if kind == "two-stage":
        words = f"relief valve, two stages\nset to {1e-5 * rig['relief']['setting']:.0f} bar"
    else:
        words = f"relief valve, direct\nopens at {1e-5 * rig['direct_relief']['cracking_pressure']:.0f} bar"
    text(axes, x + 0.6, 1.45, words, ha="left", size=8.5)
    if has_relief_line(rig):
        text(axes, x + 0.15, 3.2, f"line 7: {rig['pipe_7']['length']:g} m", ha="left", size=8.5, colour=STEEL)


def _cylinder(axes: Axes, rig: Values) -> None:
    """Barrel, piston, rods, and the load; the lower chamber below, whatever the axis of the drive."""
    bore, rod, stroke = (1e3 * rig["cylinder"][name] for name in ("bore", "rod", "stroke"))
    with part_of(axes, CHAMBERS):
        box(axes, 12.55, BARREL[0], 1.5, BARREL[1] - BARREL[0], OIL)
    below, above = rod_at(rig) in ("a", "both"), rod_at(rig) in ("b", "both")
    with part_of(axes, MOVING):
        box(axes, 12.55, PISTON, 1.5, THICK, METAL)
        if below:
            box(axes, 13.1, 3.55, 0.4, PISTON - 3.55, ROD)
        if above:
            box(axes, 13.1, PISTON + THICK, 0.4, 10.2 - PISTON - THICK, ROD)
        held(axes, rig, 10.2 if above else 2.95)
    words = f"cylinder, in mm:\nbore {bore:.0f}, rod {rod:.0f},\nstroke {stroke:.0f}"
    if not (below and not above and rod_words(rig) == "rod down"):
        words += f",\n{rod_words(rig).replace(', ', chr(10))}\n(chamber A drawn below)"
    text(axes, 14.25, 8.2, words, ha="left", size=8.5)
    thin(axes, (14.05, BARREL[0]), (14.55, BARREL[0]), width=0.8)
    with part_of(axes, TRAVELLED):
        arrow(axes, (14.4, BARREL[0]), (14.4, PISTON), ACCENT)
    with part_of(axes, MOVING):
        thin(axes, (14.05, PISTON), (14.55, PISTON), width=0.8)


def _weight(axes: Axes, rig: Values) -> None:
    """A weight with room for the rod, waiting on its support; the load meets it from below."""
    change = rig["load"]
    for x, support in ((12.35, 12.0), (13.6, 14.25)):
        box(axes, x, 4.55, 0.65, 0.55, "#e3c9a0")
        box(axes, support, 4.35, 0.4, 0.2, "white", hatch="////")
    thin(axes, (12.0, 4.25), (12.0, 4.65), width=2.0)
    thin(axes, (14.65, 4.25), (14.65, 4.65), width=2.0)
    words = f"{change['added']:.0f} kg on a support:\nload change at {1e3 * change['added_at']:.0f} mm"
    text(axes, 14.45, 5.05, words, ha="left", size=8.5)


def _taps(axes: Axes) -> None:
    for x, y, name, foot in ((3.9, 4.75, "$p_1$", 3.7), (11.95, 7.2, "$p_2$", 6.45), (11.95, 9.25, "$p_3$", 8.55)):
        thin(axes, (x, y + math.copysign(0.32, foot - y)), (x, foot), width=1.0)
        circle(axes, x, y, 0.32, BLUSH)
        text(axes, x, y, name, ACCENT, 10.5)
    text(axes, 14.7, 6.75, "$x$", ACCENT, 11.0)


def _key(axes: Axes, rig: Values, circuit: Circuit) -> None:
    for y, hose, words in ((9.1, False, "steel pipe"), (8.65, True, "hose")):
        pipe(axes, ((0.5, y), (1.4, y)), hose)
        text(axes, 1.6, y, words, ha="left")
    circle(axes, 0.95, 8.1, 0.22, BLUSH)
    text(axes, 1.6, 8.1, "pressure tap", ha="left")
    supply = supply_at_rest(circuit)
    rises = "the piston rises" if positive_words(rig) == "lifts" else "port A drives"
    for y, words in (
        (7.5, f"arrowheads: flow while {rises}"),
        (7.2, "beside each line: length, wave speed, travel time"),
        (6.9, f"at rest, valve shut: $p_1$ = {1e-5 * supply.tee:.1f} bar"),
    ):
        text(axes, 0.5, y, words, ha="left", size=8.5, colour="0.35")
