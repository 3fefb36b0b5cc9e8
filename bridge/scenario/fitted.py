"""What is fitted in each slot of a drive: the table that the description, the pictures, the view and the report follow.

Of the rig's values alone, without a circuit. A value is in force if what it belongs to is fitted.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from twin.topology import PIPES, RELIEF_LINE

Values = Mapping[str, Mapping[str, Any]]


class Kind(NamedTuple):
    """One kind of a slot."""

    words: str
    sections: tuple[str, ...] = ()  # of the rig, with its numbers


class Slot(NamedTuple):
    """A place of the skeleton, and what may sit in it."""

    place: str  # of the choice in the rig's values
    kinds: Mapping[str, Kind]  # the first one where the rig has no such choice

    @property
    def section(self) -> str:
        """Of the rig, with the choice."""
        return self.place.partition(".")[0]


class Fitted(NamedTuple):
    """What sits in a slot."""

    slot: str
    kind: str
    words: str
    place: str  # of the choice, "" where there is none


ACCESSORY = {
    "none": Kind("none"),
    "counterbalance": Kind("counterbalance valve"),
    "pilot-check": Kind("pilot-operated check valve"),
    "throttle": Kind("throttle"),
    "throttle-check": Kind("throttle-check valve"),
}
SLOTS = {
    "supply": Slot(
        "supply.kind",
        {
            "gear": Kind("gear pump", ("pump",)),
            "fixed": Kind("fixed pump, ideal, with a leak", ("fixed_pump",)),
            "variable": Kind("variable pump, pressure-compensated", ("variable_pump",)),
            "pressure": Kind("constant pressure, with an internal resistance", ("pressure_source",)),
        },
    ),
    "accumulator": Slot("accumulator.kind", {"none": Kind("none"), "bladder": Kind("bladder accumulator")}),
    "relief valve": Slot(
        "relief.kind",
        {
            "two-stage": Kind("two-stage relief valve", ("chatter",)),
            "direct": Kind("direct-operated relief valve", ("direct_relief",)),
            "none": Kind("none"),
        },
    ),
    "check valve": Slot(
        "check_valve.kind", {"none": Kind("none"), "fitted": Kind("check valve in line 2, behind the filter")}
    ),
    "directional valve": Slot(
        "valve.kind",
        {
            "proportional": Kind("proportional valve"),
            "switching": Kind("switching valve", ("switching_valve",)),
            "servo": Kind("servo valve, four lands", ("servo_valve",)),
        },
    ),
    "accessory at A": Slot("accessory_a.kind", ACCESSORY),
    "accessory at B": Slot("accessory_b.kind", ACCESSORY),
    "cushions": Slot(
        "cushion.kind",
        {"none": Kind("none"), "orifice": Kind("cushioning orifices"), "spear": Kind("cushioning spears")},
    ),
    "actuator": Slot(
        "actuator.kind", {"cylinder": Kind("cylinder", ("cylinder",)), "motor": Kind("rotary motor", ("motor",))}
    ),
    "friction": Slot(
        "friction.kind",
        {
            "seal": Kind("of the seal, by pressure and speed", ("seal",)),
            "stribeck": Kind("Coulomb, Stribeck and viscous"),
            "lugre": Kind("LuGre"),
            "none": Kind("none"),
        },
    ),
    "load": Slot(
        "load.kind",
        {
            "mass": Kind("mass"),
            "environment": Kind("mass with springs and dampers around it"),
            "compliant": Kind("two masses on a compliant link"),
            "lever": Kind("lever, inertia and gravity by position"),
        },
    ),
    "return end": Slot(
        "return_end.kind",
        {
            "open": Kind("open into the tank"),
            "orifice": Kind("orifice at the tank"),
            "check": Kind("back-pressure check valve and orifice at the tank"),
        },
    ),
}


def word(values: Values, place: str, otherwise: Any = None) -> Any:
    """The value at a place such as "valve.kind"; `otherwise` where the rig has none."""
    section, _, name = place.partition(".")
    return values.get(section, {}).get(name, otherwise)


def kind_of(values: Values, slot: str) -> str:
    """The kind in a slot; a rig without the choice has the first one."""
    found = SLOTS[slot]
    return str(word(values, found.place, next(iter(found.kinds))))


def is_motor(values: Values) -> bool:
    """Does the drive turn?"""
    return kind_of(values, "actuator") == "motor"


def fitted(values: Values) -> list[Fitted]:
    """What sits in each slot, in the order of the circuit; slots with nothing in them are left out."""
    there = [slot for slot in SLOTS if kind_of(values, slot) != "none" or slot == "friction"]
    rows = [Fitted(slot, kind_of(values, slot), _words(values, slot), SLOTS[slot].place) for slot in there]
    if is_motor(values):
        rows = [row for row in rows if row.slot != "cushions"]
    behind = next(i for i, row in enumerate(rows) if row.slot in ("check valve", "directional valve"))
    return [*rows[:behind], *_fittings(values), *rows[behind:], Fitted("lines", "", _line_words(values), "")]


def is_fitted(values: Values, slot: str) -> bool:
    """Is there anything in a slot?"""
    return any(row.slot == slot for row in fitted(values))


def _words(values: Values, slot: str) -> str:
    kind = kind_of(values, slot)
    words = SLOTS[slot].kinds[kind].words
    if slot == "accumulator" and kind != "none":
        return f"{words} at {'port P' if word(values, 'accumulator.at') == 'p' else 'the tee'}"
    if slot == "relief valve" and has_relief_line(values):
        return f"{words} at the end of a line of its own, pipe_7"
    if slot == "actuator":
        return f"{words}, {orientation(values)}"
    return words


def has_relief_line(values: Values) -> bool:
    """Does the relief valve have a line of its own?"""
    return kind_of(values, "relief valve") != "none" and word(values, "relief.place", "tee") == RELIEF_LINE


def lines_of(values: Values) -> tuple[str, ...]:
    """The lines of the drive."""
    return (*PIPES, *((RELIEF_LINE,) if has_relief_line(values) else ()))


def _fittings(values: Values) -> list[Fitted]:
    names = {"filter": "filter", "two_position_valve": "two-position valve"}
    there = [words for section, words in names.items() if values[section]["drop"] > 0.0]
    return [Fitted("fittings", "", f"{' and '.join(there)} in line 2", "")] if there else []


MODELS = {
    "ends": "waves, end to end",
    "nodes": "waves, nodes inside",
    "lumped": "lumped inertia",
    "volume": "volume without inertia",
    "none": "no pipe, a manifold",
}


def _line_words(values: Values) -> str:
    """Which lines have which model: "1 to 6: waves, end to end"."""
    of_model: dict[str, list[str]] = {}
    for line in lines_of(values):
        of_model.setdefault(values[line]["model"], []).append(line.removeprefix("pipe_"))
    if len(of_model) == 1:
        ((model, numbers),) = of_model.items()
        return f"{numbers[0]} to {numbers[-1]}: {MODELS[model]}"
    return "; ".join(f"{', '.join(numbers)}: {MODELS[model]}" for model, numbers in of_model.items())


def angle_of(values: Values) -> float:
    """Angle [rad] of the positive direction to the horizontal: pi/2 is upwards."""
    return float(word(values, "motor.angle" if is_motor(values) else "cylinder.angle", 0.5 * math.pi))


def rod_at(values: Values) -> str:
    """The chamber whose port the rod is in: a, b or both."""
    return str(word(values, "cylinder.rod_at", "a"))


def _heading(angle: float) -> str:
    """Where a direction with an angle [rad] to the horizontal leads."""
    degrees = round(math.degrees(angle), 1)
    if abs(degrees) == 90.0:
        return "up" if degrees > 0.0 else "down"
    if degrees == 0.0:
        return "horizontal"
    return f"{'up' if degrees > 0.0 else 'down'}, {abs(degrees):g} deg to the horizontal"


def rod_words(values: Values) -> str:
    """Where the rod points: "rod down"."""
    angle, rod = angle_of(values), rod_at(values)
    if rod == "both":
        heading = _heading(angle).removeprefix("up, ").removeprefix("down, ")
        return f"double rod, {'upright' if heading in ('up', 'down') else heading}"
    return f"rod {_heading(angle if rod == 'b' else -angle)}"


def orientation(values: Values) -> str:
    """How the actuator lies."""
    if not is_motor(values):
        return rod_words(values)
    turn = math.degrees(angle_of(values))
    return "shaft" if abs(turn) < 0.05 else "shaft, the load hangs on a rope"


def positive_words(values: Values) -> str:
    """What the positive direction is, as a verb of the piston: "lifts"."""
    if is_motor(values):
        return "turns forward"
    degrees = round(math.degrees(angle_of(values)), 1)
    if degrees != 0.0:
        return "lifts" if degrees > 0.0 else "lowers"
    return {"a": "retracts the rod", "b": "extends the rod"}.get(rod_at(values), "moves forward")


def chamber_names(values: Values) -> dict[str, str]:
    """Chamber -> its name: lower and upper where the chamber of port A lifts, else by the ports."""
    if is_motor(values) or positive_words(values) != "lifts":
        return {"lower": "chamber A", "upper": "chamber B"}
    return {"lower": "lower chamber", "upper": "upper chamber"}


def of_drive(label: str, values: Values) -> str:
    """A label of the thesis's rig in the words of a drive: "p2 lower chamber" may be "p2 chamber A"."""
    for words, own in _own_words(values).items():
        label = label.replace(words, own)
    return label


def _own_words(values: Values) -> dict[str, str]:
    names = chamber_names(values)
    own = {"lower chamber": names["lower"], "upper chamber": names["upper"]}
    if not names["lower"].startswith("lower"):
        own = {"the lower chamber": names["lower"], "the upper chamber": names["upper"]} | own
    own |= {"piston": "shaft", "Piston": "Shaft"} if is_motor(values) else {}
    own |= {"pump": "supply"} if kind_of(values, "supply") == "pressure" else {}
    return own | ({"p1 relief valve": "p1 tee"} if kind_of(values, "relief valve") == "none" else {})


def chamber_words(values: Values) -> dict[str, str]:
    """Chamber -> its side: "rod side: it lifts" of the lower one."""
    if is_motor(values):
        return {"lower": "it turns forward", "upper": "it turns back"}
    sides = {"a": ("rod side", "cap side"), "b": ("cap side", "rod side")}.get(rod_at(values), ("rod side", "rod side"))
    return {"lower": f"{sides[0]}: it {positive_words(values)}", "upper": sides[1]}
