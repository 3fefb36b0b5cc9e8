"""Numbers of a scenario that are so far from usual ones that likely a unit is missing: "180 Pa" where 180 bar is meant.

The ranges are assumed: wider than any drive that this testbed is for, and narrower than a wrong unit. Zero and
infinity say "none" and are never unlikely.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.scenario.fields import Measured
from bridge.scenario.fitted import is_motor
from bridge.scenario.in_force import in_force
from bridge.scenario.model import Scenario
from bridge.scenario.units import SHOWN, UNITS
from twin.quantity import Number, Table
from twin.rig import RIG


class Range(NamedTuple):
    """What is usual, SI."""

    low: float
    high: float


DIFFERENCE = Range(1e2, 5e7)  # of pressures: 1 mbar to 500 bar
BORE = Range(1e-4, 1.0)
DELAY = Range(1e-6, 1.0)
OF_UNIT = {  # where nothing else is said of a name
    "Pa": Range(1e4, 1.5e8),  # 0.1 to 1500 bar
    "m": Range(1e-7, 200.0),
    "m^2": Range(1e-9, 1.0),
    "m^3": Range(1e-9, 1.0),
    "m^3/s": Range(1e-7, 0.1),  # 0.006 to 6000 l/min
    "m^2/s": Range(5e-7, 5e-3),  # 0.5 to 5000 mm^2/s
    "s": Range(1e-6, 20.0),
    "Hz": Range(0.05, 1e5),
    "1/s": Range(0.05, 1e6),
    "kg": Range(1e-4, 1e6),
    "kg/m^3": Range(600.0, 1500.0),
    "kg m^2": Range(1e-8, 1e6),
    "Pa s/m^3": Range(1e6, 1e18),
    "m^3/(s Pa)": Range(1e-18, 1e-8),
    "N": Range(1e-3, 1e8),
    "N/m": Range(1.0, 1e14),
    "m/s": Range(1e-6, 1e3),
    "V": Range(0.1, 1e3),
}
OF_NAME = {  # by the last word of a name, or by all of it
    **dict.fromkeys(("drop", "check_drop", "override", "droop", "hysteresis", "cracking"), DIFFERENCE),
    **dict.fromkeys(("check_valve.cracking_pressure", "return_end.cracking_pressure"), DIFFERENCE),
    **dict.fromkeys(("bulk_modulus", "modulus"), Range(5e7, 1e11)),
    "young": Range(1e6, 1e21),  # as good as rigid is written so
    **dict.fromkeys(("bore", "rod", "diameter"), BORE),
    **dict.fromkeys(("nozzle_diameter", "orifice_diameter", "seat_diameter", "spool_diameter", "inlet_diameter"), BORE),
    **dict.fromkeys(("wall", "travel", "clearance", "spool_gap"), Range(1e-7, 0.1)),
    **dict.fromkeys(("stroke", "position", "neutral", "added_at", "position_range"), Range(1e-5, 20.0)),
    "length": Range(5e-4, 200.0),
    "displacement": Range(1e-8, 5e-3),  # 0.01 cm^3 to 5 l
    **dict.fromkeys(("dead_lower", "dead_upper", "manifold"), Range(1e-8, 0.1)),
    "accumulator.volume": Range(1e-5, 1.0),
    **dict.fromkeys(("speed", "efficiency_speed"), Range(0.05, 250.0)),  # to 15 000 rpm
    **dict.fromkeys(("loop.step", "loop.daq_period"), Range(1e-7, 0.1)),
    "loop.sample_period": Range(1e-6, 1.0),
    "loop.delay": DELAY,
    **dict.fromkeys(("run_up", "retardation", "retardation_2", "command_timeout"), Range(1e-6, 1e3)),
}
OF_ARC = ("stroke", "position", "neutral", "added_at", "position_range", "velocity_range")  # of a motor: any turns
SECTIONS = ("start", "loop", "daq")


def missing_units(scenario: Scenario) -> list[str]:
    """A sentence for each number of the scenario's own that likely lacks its unit."""
    turns = is_motor(scenario.rig_values())
    found = []
    for name, value, unit in _numbers(scenario):
        key = name.rpartition(".")[2]
        if not unit or (turns and key in OF_ARC):
            continue
        usual = OF_NAME.get(name.removeprefix("rig.")) or OF_NAME.get(key) or OF_UNIT.get(unit)
        if usual and not _is_usual(value, usual):
            found.append(_words(name, value, unit, usual))
    return found


def _is_usual(value: float, usual: Range) -> bool:
    return value == 0.0 or math.isinf(value) or usual.low <= abs(value) <= usual.high


def _words(name: str, value: float, unit: str, usual: Range) -> str:
    shown = SHOWN.get(unit, unit)
    read = f" = {value / UNITS[unit][shown].factor:.4g} {shown}" if shown != unit else ""
    fits = [u for u in (shown, *UNITS[unit]) if _is_usual(value * UNITS[unit][u].factor, usual) and u != unit]
    way = f'if its unit is missing, write "{value:g} {fits[0]}"' if fits else f"usual is {_span(usual, unit, shown)}"
    return f"{name} is {value:g} {unit}{read}, which is unlikely: {way}"


def _span(usual: Range, unit: str, shown: str) -> str:
    factor = UNITS[unit][shown].factor
    return f"{usual.low / factor:.3g} to {usual.high / factor:.3g} {shown}"


def _numbers(scenario: Scenario) -> Iterator[tuple[str, float, str]]:
    """Names, values and units of the numbers in force that are not the rig's own or a section's default."""
    values = scenario.rig_values()
    read = in_force(values)
    for part, entries in RIG.items():
        for name, entry in entries.items():
            given = values[part][name]
            if f"{part}.{name}" in read and given != entry.value:
                yield from _of_entry(f"rig.{part}.{name}", given, entry)
    for section in SECTIONS:
        yield from _of_section(section, getattr(scenario, section))


def _of_entry(name: str, given: Any, entry: Any) -> Iterator[tuple[str, float, str]]:
    if isinstance(entry, Number):
        yield name, given, entry.unit
    if isinstance(entry, Table):
        for column, unit in enumerate(entry.units):
            yield name, max((point[column] for point in given), key=abs), unit


def _of_section(section: str, model: Any) -> Iterator[tuple[str, float, str]]:
    for key, field in type(model).model_fields.items():
        reader = next((m for m in field.metadata if isinstance(m, Measured)), None)
        if reader and getattr(model, key) != field.default:
            yield f"{section}.{key}", getattr(model, key), reader.unit
