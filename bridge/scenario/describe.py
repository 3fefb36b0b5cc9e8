"""A scenario's circuit in words: what is fitted, values with sources, frequencies, travel times, limits of the step."""

import math
from typing import Any, NamedTuple

from bridge.scenario.at_rest import holding_warnings, rest_facts
from bridge.scenario.circuit import circuit_of, rest_of, supply_of
from bridge.scenario.faults import Fault
from bridge.scenario.faults import planned as faults_of
from bridge.scenario.fitted import SLOTS, fitted
from bridge.scenario.in_force import in_force
from bridge.scenario.lowering_swing import in_words, lowering_swings
from bridge.scenario.model import Scenario
from bridge.scenario.of_run import OWN
from bridge.scenario.origins import Origins
from bridge.scenario.plausible import missing_units
from bridge.scenario.reach import reference_warnings
from bridge.scenario.safety import planned
from bridge.scenario.supply_facts import Fact, relief_facts, supply_facts
from bridge.scenario.timeline import Happening, plan
from bridge.scenario.units import SHOWN, UNITS
from twin.air import NoAir, effective_bulk_modulus
from twin.circuit.build import fitted_pipes
from twin.circuit.limits import limits, natural_frequency, too_coarse
from twin.circuit.oil import pipe_volume
from twin.circuit.parasitic import parasitic
from twin.circuit.step import Circuit
from twin.quantity import Choice, Entry, Table
from twin.rig import RIG, Values
from twin.rig_servo import LANDS
from twin.servo_valve import ServoValve

WIDE = {"length": "m", "young": "GPa", "speed": "rpm", "efficiency_speed": "rpm"}  # and where another unit reads better


class Value(NamedTuple):
    """One value of the rig as it stands in the scenario."""

    name: str  # part.name
    value: str
    source: str
    changed: bool  # not the rig's own
    fitted: bool  # of a part that the drive has
    origin: str = ""  # the extended scenario that a changed one is from; "" where the scenario itself says it


class Happens(NamedTuple):
    """An entry of the timeline, a fault or an alarm."""

    when: str
    what: str


def values_of(scenario: Scenario, inherited: Origins | None = None) -> list[Value]:
    """Every value, in the order of the rig; whatever the scenario changed, or one that it extends, has that as source.

    inherited: names of values, and the extended scenario that each is from (`origins`).
    """
    values, origin = scenario.rig_values(), inherited or {}
    read = in_force(values)
    return [
        _value(f"{part}.{name}", value, RIG[part][name], f"{part}.{name}" in read, origin.get(f"rig.{part}.{name}", ""))
        for part, entries in values.items()
        for name, value in entries.items()
    ]


def shown_values(scenario: Scenario, inherited: Origins | None = None) -> list[Value]:
    """The values of what is fitted, and whatever the scenario itself changed."""
    return [v for v in values_of(scenario, inherited) if v.fitted or (v.changed and not v.origin)]


def _value(name: str, value: Any, entry: Entry, read: bool, origin: str) -> Value:
    rigs_own = value == entry.value
    source = entry.source if rigs_own else f"{origin or OWN}; otherwise {_text(name, entry.value, entry)}"
    return Value(name, _text(name, value, entry), source, not rigs_own, read, "" if rigs_own else origin)


def slots_of(scenario: Scenario) -> list[tuple[str, str, str]]:
    """Slot, what is fitted in it, and by which value of the scenario it is chosen."""
    return [(row.slot, row.words, f"rig.{row.place}" if row.place else "") for row in fitted(scenario.rig_values())]


def empty_slots(scenario: Scenario) -> list[str]:
    """The values that choose what the drive does not have."""
    there = {row.place for row in fitted(scenario.rig_values())}
    return [f"rig.{slot.place}" for slot in SLOTS.values() if slot.place not in there and slot.section in RIG]


def _text(name: str, value: Any, entry: Entry) -> str:
    if isinstance(entry, Choice):
        return value
    if isinstance(entry, Table):
        points = (
            [_with_unit(part, unit, "") for part, unit in zip(point, entry.units, strict=True)] for point in value
        )
        return ", ".join(" ".join(point) for point in points)
    return _with_unit(value, entry.unit, name.partition(".")[2])


def _with_unit(value: float, unit: str, name: str) -> str:
    shown = WIDE.get(name) or (unit if unit == "m/s" else SHOWN.get(unit, unit))
    if shown not in UNITS[unit] or not math.isfinite(value):
        shown = unit
    return f"{(value - UNITS[unit][shown].offset) / UNITS[unit][shown].factor:.6g} {shown}".rstrip()


def timeline(scenario: Scenario) -> list[Happens]:
    """What happens while it runs."""
    return [Happens(_when(entry), item.words) for entry, item in zip(scenario.timeline, plan(scenario), strict=True)]


def faults(scenario: Scenario) -> list[Happens]:
    """What goes wrong while it runs."""
    return [Happens(_spells(entry), one.words) for entry, one in zip(scenario.fault, faults_of(scenario), strict=True)]


def _spells(fault: Fault) -> str:
    lasts = f", for {fault.lasts:g} s" if fault.lasts is not None else ""
    chance = f", with probability {fault.probability:g}" if fault.probability < 1.0 else ""
    return f"{_when(fault)}{lasts}{chance}"


def _when(entry: Happening | Fault) -> str:
    after = f" + {entry.after:g} s" if entry.after else ""
    when = f"{entry.at:g} s{after}" if entry.at is not None else f"{entry.when}{after}"
    every = f", every {entry.every:g} s" if entry.every is not None else ""
    return f"{when}{every}, {entry.times} times" if entry.times > 1 else when


def alarms(scenario: Scenario) -> list[Happens]:
    """The limits that stop or degrade the plant, and where they lead."""
    return [Happens(f"{alarm.id}: {alarm.words}", alarm.then) for alarm in planned(scenario)]


def facts(scenario: Scenario) -> list[Fact]:
    """What the circuit's own equations say of it: each from the place where the step takes it.

    Raises ScenarioError where its numbers make no circuit, or none that can be at rest.
    """
    circuit = circuit_of(scenario)
    rest_of(scenario)
    found = _oil_facts(circuit)
    found += [*rest_facts(scenario), *supply_facts(circuit, supply_of(scenario)), *relief_facts(circuit, scenario)]
    if isinstance(circuit.parts.valve, ServoValve):
        found += _servo_facts(circuit.parts.valve, supply_of(scenario).idle)
    swings = lowering_swings(scenario).items()
    found += [Fact(f"{port}: lowering through it (linear theory)", in_words(swing)) for port, swing in swings]
    return [*found, *_load_facts(circuit), *_line_facts(circuit, scenario), *_channel_facts(scenario)]


def _servo_facts(valve: ServoValve, idle: float) -> list[Fact]:
    areas = ", ".join(f"{name.replace('_', '-').upper()} {getattr(valve, name).area * 1e6:.4g}" for name in LANDS)
    return [
        Fact("servo valve: lands fully open", f"{areas} mm^2"),
        Fact("servo valve: through it from P to T, spool in the middle", f"{idle * 6e4:.4g} l/min"),
    ]


def _load_facts(circuit: Circuit) -> list[Fact]:
    stroke = circuit.parts.cylinder.stroke
    hertz = [natural_frequency(circuit, place * stroke) / (2.0 * math.pi) for place in (0.0, 0.5, 1.0)]
    oil = "oil" if isinstance(circuit.parts.cylinder.air, NoAir) else "oil without air"
    places = f"load on its {oil}, valve shut, at 0, {stroke * 500:.0f}, {stroke * 1e3:.0f} mm"
    return [Fact(places, ", ".join(f"{f:.4g}" for f in hertz) + " Hz")]


def _line_facts(circuit: Circuit, scenario: Scenario) -> list[Fact]:
    found, rig, lines = [], scenario.rig_values(), circuit.lines
    for number, pipe in enumerate(fitted_pipes(rig)):
        travel, per_bar = float(lines.travel_time[number]), 1e11 * float(lines.capacity[number])
        if travel == 0.0:
            volume = 1e6 * pipe_volume(rig[pipe])
            found.append(Fact(f"{pipe}: one volume, and what it takes", f"{volume:.3g} cm^3, {per_bar:.3g} cm^3/bar"))
            continue
        text = (
            f"{rig[pipe]['length'] / travel:.0f} m/s, {travel * 1e3:.3g} ms, {lines.z0[number] / 6e9:.3g} bar/(l/min)"
        )
        found.append(Fact(f"{pipe}: wave speed, travel time, characteristic impedance", text))
    return [*found, *_creep_facts(circuit, rig)]


def _creep_facts(circuit: Circuit, rig: Values) -> list[Fact]:
    late = circuit.lines.settled_capacity / circuit.lines.capacity - 1.0
    return [
        Fact(f"{pipe}: oil that its wall takes late, over that at once", f"{100.0 * share:.3g} %")
        for pipe, share in zip(fitted_pipes(rig), late, strict=True)
        if share > 0.0
    ]


def _oil_facts(circuit: Circuit) -> list[Fact]:
    oil, air = circuit.parts.oil, circuit.parts.cylinder.air
    found = [Fact("oil: viscosity, bulk modulus", f"{oil.viscosity * 1e6:.4g} mm^2/s, {oil.bulk_modulus:.4g} Pa")]
    if isinstance(air, NoAir):
        return found
    stiff = [f"{effective_bulk_modulus(air, oil.bulk_modulus, 1e5 * bar):.3g}" for bar in (0.0, 10.0, 50.0, 100.0)]
    return [*found, Fact("oil: bulk modulus with its air at 0, 10, 50, 100 bar", ", ".join(stiff) + " Pa")]


def _channel_facts(scenario: Scenario) -> list[Fact]:
    names = ", ".join(scenario.daq.channels)
    return [Fact("card: further channels", names)] if names else []


def step_rows(scenario: Scenario) -> list[tuple[str, str, str, str]]:
    """Part, what, its time, the longest step that follows it; marked where the scenario's step is longer."""
    circuit = circuit_of(scenario)
    coarse = too_coarse(circuit)
    marks = [(limit, " TOO COARSE" if limit in coarse else "") for limit in limits(circuit)]
    return [(e.part, e.what, f"{e.time * 1e3:.3g} ms", f"{e.step * 1e6:.4g} us{mark}") for e, mark in marks]


def warnings(scenario: Scenario) -> list[str]:
    """What is likely a mistake: parts that the step is too coarse for, and how far the reference goes.

    Raises ScenarioError as `facts`.
    """
    circuit = circuit_of(scenario)
    rest_of(scenario)
    step = scenario.loop.step
    coarse = [
        f"loop.step {step * 1e6:g} us is too coarse for {limit.part} ({limit.what}, {limit.time * 1e3:.3g} ms): "
        f"at most {limit.step * 1e6:.3g} us; results are less accurate, see `hydrotwin convergence`"
        for limit in too_coarse(circuit)
    ]
    further = (missing_units, holding_warnings, _parasitic_warnings, reference_warnings)
    return [*coarse, *(line for warn in further for line in warn(scenario))]


def _parasitic_warnings(scenario: Scenario) -> list[str]:
    """Lines without inertia that are so small beside their neighbours that what the scheme adds to them matters."""
    return [
        f"{at.line} stores {at.capacity * 1e11:.3g} cm^3/bar without inertia beside {at.beside * 1e11:.3g} cm^3/bar: "
        f"at loop.step {scenario.loop.step * 1e6:g} us the scheme swings between them at {at.frequency:.3g} Hz, the "
        f"load on its oil at {at.load:.3g} Hz; take loop.step {at.step * 1e6:.2g} us, a greater volume, or model lumped"
        for at in parasitic(circuit_of(scenario))
    ]
