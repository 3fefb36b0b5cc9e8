"""A scenario's circuit in words and numbers: parts, values with sources, frequencies, travel times, limits of the step."""

import math
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.units import UNITS
from twin.build import build
from twin.circuit import Circuit
from twin.equilibrium import supply_at_rest
from twin.limits import limits, natural_frequency, too_coarse
from twin.poppet import cracking_pressure
from twin.rig import RIG, Choice

PICTURE = """\
                      p1
                       |                   +-------+
  tank > pump --1--> tee --filter--2--> P -|       |- A --3-->  lower chamber (rod side: it lifts) -- p2
                       |                   | valve |            piston; rod down, load on the rod
                 relief > tank             |       |- B --4-->  upper chamber (cap side)           -- p3
                                           +-------+
  tank <--6-- return tee <--5------------- T --'
"""
SHOWN = {
    "Pa": "bar",
    "m": "mm",
    "m^3/s": "l/min",
    "m^3": "cm^3",
    "s": "ms",
    "Pa s/m^3": "bar/(l/min)",
    "rad": "deg",
}
WIDE = {"length": "m", "young": "GPa", "speed": "rpm", "efficiency_speed": "rpm"}  # and where another unit reads better


class Value(NamedTuple):
    """One value of the rig as it stands in the scenario."""

    name: str  # part.name
    value: str
    source: str
    changed: bool  # not the rig's own


class Fact(NamedTuple):
    """Something that follows from the values."""

    what: str
    value: str


def values_of(scenario: Scenario) -> list[Value]:
    """Every value, in the order of the rig; whatever the scenario changed has that as its source."""
    found = []
    for part, entries in scenario.rig_values().items():
        for name, value in entries.items():
            entry = RIG[part][name]
            changed = value != entry.value
            text = value if isinstance(entry, Choice) else _with_unit(value, entry.unit, name)
            source = f"this scenario; otherwise {entry.value:g}" if changed and not isinstance(value, str) else entry.source
            found.append(Value(f"{part}.{name}", text, "this scenario" if changed and isinstance(value, str) else source, changed))
    return found


def _with_unit(value: float, unit: str, name: str) -> str:
    shown = WIDE.get(name) or SHOWN.get(unit, unit)
    if shown not in UNITS[unit] or not math.isfinite(value):
        shown = unit
    return f"{(value - UNITS[unit][shown].offset) / UNITS[unit][shown].factor:.6g} {shown}".rstrip()


def facts(scenario: Scenario) -> list[Fact]:
    """What the circuit's own equations say of it: each from the place where the step takes it."""
    circuit = build(scenario.rig_values(), scenario.loop.step)
    parts, lines = circuit.parts, circuit.lines
    supply = supply_at_rest(circuit)
    found = [
        Fact("oil: kinematic viscosity, bulk modulus", f"{parts.oil.viscosity * 1e6:.4g} mm^2/s, {parts.oil.bulk_modulus:.4g} Pa"),
        Fact("pump: mean flow at no pressure", f"{parts.pump.delivery * 6e4:.4g} l/min"),
        Fact("supply with the valve at rest", f"p1 = {supply.tee / 1e5:.4g} bar, {supply.relieved * 6e4:.4g} l/min over the relief valve"),
    ]
    if parts.pump.ripple > 0.0:
        found.append(Fact("pump: frequency of the teeth", f"{parts.pump.tooth_frequency:.4g} Hz"))
    if parts.fitted.relief:
        found += _relief_facts(circuit)
    stroke = parts.cylinder.stroke
    for place in (0.0, 0.5, 1.0):
        hertz = natural_frequency(circuit, place * stroke) / (2.0 * math.pi)
        found.append(Fact(f"load on its oil at {place * stroke * 1e3:.0f} mm, valve shut", f"{hertz:.4g} Hz"))
    for line in range(len(lines.travel_time)):
        travel, impedance = float(lines.travel_time[line]), float(lines.z0[line])
        speed = scenario.rig_values()[f"pipe_{line + 1}"]["length"] / travel
        found.append(
            Fact(
                f"pipe_{line + 1}: wave speed, travel time, impedance",
                f"{speed:.0f} m/s, {travel * 1e3:.3g} ms, {impedance / 1e5 / 6e4:.3g} bar/(l/min)",
            )
        )
    return found


def _relief_facts(circuit: Circuit) -> list[Fact]:
    pilot, main = circuit.parts.relief.pilot, circuit.parts.relief.main
    return [
        Fact("relief valve: cracking pressure", f"{cracking_pressure(pilot) / 1e5:.4g} bar"),
        Fact("relief valve: pilot, spool without oil", f"{_hertz(pilot):.4g} Hz, {_hertz(main):.4g} Hz"),
    ]


def _hertz(stage: Any) -> float:
    return math.sqrt(stage.stiffness / stage.mass) / (2.0 * math.pi)


def step_rows(scenario: Scenario) -> list[tuple[str, str, str, str]]:
    """Part, what, its time, the longest step that follows it; marked where the scenario's step is longer."""
    circuit = build(scenario.rig_values(), scenario.loop.step)
    coarse = too_coarse(circuit)
    return [
        (limit.part, limit.what, f"{limit.time * 1e3:.3g} ms", f"{limit.step * 1e6:.4g} us" + (" TOO COARSE" if limit in coarse else ""))
        for limit in limits(circuit)
    ]


def warnings(scenario: Scenario) -> list[str]:
    """A sentence for each part that the scenario's step is too coarse for."""
    circuit = build(scenario.rig_values(), scenario.loop.step)
    step = scenario.loop.step
    return [
        f"loop.step {step * 1e6:g} us is too coarse for {limit.part} ({limit.what}, {limit.time * 1e3:.3g} ms): "
        f"at most {limit.step * 1e6:.3g} us; results are less accurate, see `hydrotwin convergence`"
        for limit in too_coarse(circuit)
    ]
