"""Faults of the plant as changes of the rig's numbers: what each kind does to which number of what is fitted."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import ScenarioError
from bridge.scenario.fault_kinds import PLANT
from bridge.scenario.faults import PlannedFault, planned
from bridge.scenario.fitted import Values, is_motor, kind_of
from bridge.scenario.tunable import Tunable, tunable, within
from controller.course import Act, Altered
from controller.grid import NS, to_ns
from twin.quantity import TINY

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

SUPPLIES = {"gear": "pump", "fixed": "fixed_pump", "variable": "variable_pump", "pressure": "pressure_source"}
STILL = 1e9  # [s], switching time of a spool that is stuck
BROKEN = 0.01  # of the stiffness of a spring, assumed
HOLES = {"pipe_3": "hole_lower", "pipe_4": "hole_upper"}  # of the chamber that the pipe leads to
BY_SPOOL = ("stuck", "slow", "contaminated")  # faults of the valve that are the spool's, not its command's


class Change(NamedTuple):
    """Of a number of the rig: times a factor, plus something."""

    name: str  # rig.pump.speed
    factor: float
    add: float = 0.0


def is_of_rig(fault: PlannedFault) -> bool:
    """Does it change numbers of the rig?"""
    return fault.kind in BY_SPOOL if fault.group == "valve" else fault.group in PLANT


def changes_of(fault: PlannedFault, values: Values) -> list[Change]:
    """What a fault of the rig changes. Raises ScenarioError where it has nothing to act on."""
    return [Change(f"rig.{change.name}", *change[1:]) for change in MADE[fault.group, fault.kind](fault, values)]


def acts_of(fault: PlannedFault, begin: int, lasts: int, values: Values) -> Iterator[tuple[str, Act]]:
    """The same from an instant on [ns], for so long [ns]: the number, and how it is altered."""
    over = to_ns(fault.sizes.get("over", 0.0))
    for change in changes_of(fault, values):
        yield change.name, Act(begin, Altered(change.factor, change.add, over, lasts))


def refuse_powerless(scenario: "Scenario") -> None:
    """Raises ScenarioError for a fault of the rig that has nothing to act on, or whose numbers the rig cannot have."""
    values = scenario.rig_values()
    for fault in planned(scenario):
        if is_of_rig(fault):
            refuse_beyond(fault, values, scenario)


def refuse_beyond(fault: PlannedFault, values: Values, scenario: "Scenario") -> dict[str, float]:
    """The numbers that a fault leads to, of a rig on which nothing else acts. Raises ScenarioError."""
    try:
        return {change.name: _reached(change, scenario) for change in changes_of(fault, values)}
    except ScenarioError as error:
        raise ScenarioError(f"fault {fault.name!r}: {error}") from None


def _reached(change: Change, scenario: "Scenario") -> float:
    entry: Tunable = tunable(change.name, scenario)
    if not math.isfinite(entry.value):
        raise ScenarioError(f"{change.name} is infinite, so a multiple of it is the same; give it a number")
    return within(entry.value * change.factor + change.add, entry, scenario)


def fit_holes(values: dict[str, dict[str, Any]], targets: Iterable[str]) -> None:
    """Fit the holes that a burst may tear open, which cost nothing in a rig without such a fault."""
    if any(target in HOLES for target in targets):
        values["cylinder"]["holes"] = "fitted"


Maker = Callable[[PlannedFault, Values], list[Change]]


def _speed(fault: PlannedFault, values: Values) -> list[Change]:
    kind = kind_of(values, "supply")
    factor = fault.sizes.get("factor", 0.0)
    if kind == "pressure":  # whose pressure is above zero
        return [Change("pressure_source.pressure", factor, 1.0 if factor == 0.0 else 0.0)]
    return [Change(f"{SUPPLIES[kind]}.speed", factor)]


def _wear(fault: PlannedFault, values: Values) -> list[Change]:
    """A gear pump's leakage is what its efficiency lacks; a source's is its resistance."""
    kind, factor = kind_of(values, "supply"), fault.sizes["factor"]
    if kind == "gear":
        lost = min(1.0, factor * (1.0 - values["pump"]["efficiency"]))
        return [Change("pump.efficiency", 0.0, 1.0 - lost)]
    if kind == "pressure":
        return [Change("pressure_source.resistance", factor)]
    if values[SUPPLIES[kind]]["leakage"] == 0.0:
        raise ScenarioError(f"{SUPPLIES[kind]}.leakage is 0, and a multiple of it, too; give it a number")
    return [Change(f"{SUPPLIES[kind]}.leakage", factor)]


def _temperature(fault: PlannedFault, values: Values) -> list[Change]:
    if values["oil"]["kind"] == "numbers":
        raise ScenarioError("oil.kind 'numbers' has no temperature; take 'thesis' or 'iso-vg'")
    return [Change("oil.temperature", 0.0, fault.sizes["to"])]


def _air(fault: PlannedFault, values: Values) -> list[Change]:
    return [Change("cylinder.stiffness", fault.sizes["factor"])]


def _leak(fault: PlannedFault, values: Values) -> list[Change]:
    factor = fault.sizes["factor"]
    if factor == 0.0:
        raise ScenarioError("factor = 0: a leak that ends; write a small one, such as 0.01")
    return [Change(f"{'motor' if is_motor(values) else 'cylinder'}.leakage_resistance", 1.0 / factor)]


def _worn(fault: PlannedFault, values: Values) -> list[Change]:
    friction = fault.sizes["friction"]
    kind = kind_of(values, "friction")
    names = {"seal": ("seal.diameter",), "none": ()}.get(kind, tuple(f"friction.{n}" for n in FRICTION))
    return [*_leak(fault, values), *(Change(name, friction, TINY if friction == 0.0 else 0.0) for name in names)]


FRICTION = ("coulomb", "static", "viscous", "pressure_area")


def _burst(fault: PlannedFault, values: Values) -> list[Change]:
    if is_motor(values):
        raise ScenarioError("a motor's lines have no model of a hole yet; take a leak: motor.case_resistance")
    if values["cylinder"]["holes"] != "fitted":
        raise ScenarioError("nothing can tear open in a rig that was started tight; set rig.cylinder.holes='fitted'")
    return [Change(f"cylinder.{HOLES[fault.target]}", 0.0, fault.sizes["diameter"])]


def _blocked(fault: PlannedFault, values: Values) -> list[Change]:
    if values["filter"]["drop"] == 0.0:
        raise ScenarioError("filter.drop is 0, and a multiple of it, too; give it a number")
    return [Change("filter.drop", fault.sizes["factor"])]


def _stuck_open(fault: PlannedFault, values: Values) -> list[Change]:
    """Of two stages by a pilot without a spring, which opens the main stage at the pressure of its own spring."""
    opening = _opening(values)
    return [Change("relief.pilot_stiffness" if opening.startswith("relief.") else opening, BROKEN)]


def _stuck_shut(fault: PlannedFault, values: Values) -> list[Change]:
    return [Change(_opening(values), 10.0)]


def _setting(fault: PlannedFault, values: Values) -> list[Change]:
    return [Change(_opening(values), 0.0, fault.sizes["to"])]


def _opening(values: Values) -> str:
    kind = kind_of(values, "relief valve")
    if kind == "none":
        raise ScenarioError("the drive has no relief valve; take another target")
    return "direct_relief.cracking_pressure" if kind == "direct" else "relief.setting"


def _jump(fault: PlannedFault, values: Values) -> list[Change]:
    own = Change("load.mass", 1.0, fault.sizes["mass"]), Change("load.force", 1.0, fault.sizes["force"])
    return [change for change in own if change.add]


def _lost(fault: PlannedFault, values: Values) -> list[Change]:
    return [Change("load.mass", fault.sizes["factor"])]


def _impact(fault: PlannedFault, values: Values) -> list[Change]:
    return [Change("load.force", 1.0, fault.sizes["impulse"] / (fault.lasts / NS))]


def _stuck(fault: PlannedFault, values: Values) -> list[Change]:
    kind = kind_of(values, "directional valve")
    if kind == "switching":
        return [Change(f"switching_valve.{name}", 0.0, STILL) for name in ("switching_time", "return_time")]
    return [Change(f"{'servo_valve' if kind == 'servo' else 'valve'}.rate", 0.0, TINY)]


def _slow(fault: PlannedFault, values: Values) -> list[Change]:
    kind, factor = kind_of(values, "directional valve"), fault.sizes["factor"]
    if kind == "switching":
        return [Change(f"switching_valve.{name}", 1.0 / factor) for name in ("switching_time", "return_time")]
    if kind == "servo" and values["servo_valve"]["dynamics"] == "first-order":
        return [Change("servo_valve.time_constant", 1.0 / factor), Change("servo_valve.rate", factor)]
    section = "servo_valve" if kind == "servo" else "valve"
    return [Change(f"{section}.{name}", factor) for name in ("natural_frequency", "rate")]


MADE: dict[tuple[str, str], Maker] = {
    ("pump", "speed-drop"): _speed,
    ("pump", "stop"): _speed,
    ("pump", "wear"): _wear,
    ("oil", "temperature"): _temperature,
    ("oil", "air"): _air,
    ("cylinder", "leak"): _leak,
    ("cylinder", "seal-wear"): _worn,
    ("pipe_3", "burst"): _burst,
    ("pipe_4", "burst"): _burst,
    ("filter", "blocked"): _blocked,
    ("relief", "stuck-open"): _stuck_open,
    ("relief", "stuck-shut"): _stuck_shut,
    ("relief", "setting"): _setting,
    ("load", "jump"): _jump,
    ("load", "lost"): _lost,
    ("load", "impact"): _impact,
    ("valve", "stuck"): _stuck,
    ("valve", "contaminated"): _stuck,
    ("valve", "slow"): _slow,
}
