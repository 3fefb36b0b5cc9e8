"""The plant of a scenario as an FMU: its compiled step, its state at rest, its card, the numbers that may change."""

import math
import re
import zlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from bridge.connect.fmu.made import Made
from bridge.connect.fmu.native import object_code
from bridge.connect.fmu.platforms import Platform
from bridge.connect.fmu.rig_numbers import Changes, changes_of
from bridge.connect.fmu.source import doubles, rows, table_of, wholes
from bridge.connect.fmu.trace import literal
from bridge.connect.fmu.variable import Role, Type, Variable, where
from bridge.connect.fmu.ziggurat import tables
from bridge.errors import UsageError
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.scenario.circuit import circuit_of, rest_of
from bridge.scenario.tunable import FURTHER, SENSOR
from controller.grid import to_ns
from twin.circuit.block import Compiled, buffers, compiled, run_steps
from twin.circuit.sensing import LOAD_AT, PLACES_SEEN, POSITION_AT, SPEED, place_kept, rod
from twin.compliant import STRETCH
from twin.kept import FOLLOWS, kept
from twin.sensors import card_of, inputs_of
from twin.topology import CHANNELS, OBSERVED

ALWAYS = ("rig.load.force", "rig.pump.speed", "rig.fixed_pump.speed", "rig.variable_pump.speed")  # inputs
LONGEST_DELAY = 0.1  # [s], of loop.delay, where the scenario's own is not longer
LARGEST_WHOLE = 2**31 - 1  # of an Integer of FMI 2
SOURCES = ("plant.c", "noise.c")
HEADERS = ("plant.h", "plant_data.h", "noise.h")
_NAME = re.compile(r"\{([^}]+)\}")


class Plant(NamedTuple):
    """What the sources are made of."""

    scenario: Scenario
    circuit: Compiled
    state: Any  # flat, at rest
    changes: Changes
    variables: list[Variable]


def plant_fmu(scenario: Scenario, platforms: list[Platform]) -> Made:
    """The sources and the object code of a scenario's plant. Raises UsageError."""
    if not 0 <= scenario.seed <= LARGEST_WHOLE:
        raise UsageError(f"seed = {scenario.seed}: an FMU has whole numbers up to {LARGEST_WHOLE}; choose another seed")
    changes = changes_of(scenario)
    plant = Plant(
        scenario, compiled(circuit_of(scenario)), rest_of(scenario), changes, [*_variables(scenario, changes)]
    )
    sources = {"plant_data.c": _data(plant), "ziggurat.h": tables()}
    objects = {platform.name: _objects(plant, platform) for platform in platforms}
    return Made(
        kind="plant",
        variables=plant.variables,
        own_state="plant.h",
        macros=_macros(plant),
        sources=sources,
        ours=SOURCES,
        headers=HEADERS,
        period=scenario.loop.grid().daq,
        objects=objects,
    )


def _variables(scenario: Scenario, changes: Changes) -> Iterator[Variable]:
    daq, loop = scenario.daq, scenario.loop
    yield Variable("time", Role.TIME, "s", 0.0, "simulated time")
    yield Variable("spool", Role.INPUT, "", 0.0, "spool reference of the directional valve", -1.0, 1.0)
    planned = {*ALWAYS, *(entry.set for entry in scenario.timeline)}
    for number, low, high in changes.ranges:
        role = Role.INPUT if number.name in planned else Role.TUNABLE
        yield Variable(number.name, role, number.unit, number.value, number.description, low, high)
    yield Variable("seed", Role.FIXED, "", scenario.seed, "of the sensor noise", 0, LARGEST_WHOLE, Type.WHOLE)
    for name, words in (("quantise", "the card has a resolution"), ("clip", "the card has ends of its ranges")):
        yield Variable(f"daq.{name}", Role.FIXED, "", getattr(daq, name), words, 0, 1, Type.TRUTH)
    words = "the output to the valve has a resolution"
    yield Variable("daq.quantise_output", Role.FIXED, "", daq.quantise_output, words, 0, 1, Type.TRUTH)
    words = "from the spool input to its action, whole internal steps"
    yield Variable("loop.delay", Role.FIXED, "s", loop.delay, words, 0.0, max(loop.delay, LONGEST_DELAY))
    yield Variable("loop.step", Role.CONSTANT, "s", loop.step, "internal step")
    yield Variable("loop.daq_period", Role.CONSTANT, "s", loop.daq_period, "from measurement to measurement")
    for name, channel in CHANNELS.items():
        yield from _transducer(f"{SENSOR}.{name}", channel.unit, float(getattr(daq, channel.span)), daq.noise)
    for name, sensor in chosen(scenario).items():
        yield from _transducer(f"{FURTHER}.{name}", sensor.unit, sensor.ends(daq)[1], daq.noise)
    for name, channel in CHANNELS.items():
        yield Variable(f"measurement.{name}", Role.OUTPUT, channel.unit, 0.0, f"the card's reading{channel.note}")
    for name, sensor in chosen(scenario).items():
        yield Variable(f"channels.{name}", Role.OUTPUT, sensor.unit, 0.0, f"the card's reading{sensor.note}")
    for name, unit in OBSERVED.items():
        yield Variable(f"state.{name}", Role.OUTPUT, unit, 0.0, "true value")


def _transducer(name: str, unit: str, span: float, noise: float) -> Iterator[Variable]:
    yield Variable(f"{name}.offset", Role.TUNABLE, unit, 0.0, "added to the true value", -span, span)
    yield Variable(f"{name}.noise", Role.TUNABLE, "", noise, "LSB rms", 0.0)


def _macros(plant: Plant) -> dict[str, str | int | float]:
    scenario, variables = plant.scenario, plant.variables
    grid, further = scenario.loop.grid(), len(scenario.daq.channels)
    first = next(iter(CHANNELS))
    own = scenario.daq.channels[0] if further else ""
    at = {name: where(variables, name) for name in ("spool", "seed")}
    longest = next(v.high for v in variables if v.name == "loop.delay")
    return {
        "GRID": f"INT64_C({grid.step})",
        "DAQ": f"INT64_C({grid.daq})",
        "STEP": float(scenario.loop.step),
        "SKEW": float(scenario.daq.skew),
        "OUTPUT_LSB": 2.0 / 2.0**scenario.daq.output_bits,
        "PARTS": plant.circuit.parts.nbytes // 8,
        "WHOLES": plant.circuit.whole.size,
        "NUMBERS": plant.circuit.numbers.size,
        "STATE": plant.state.size,
        "CHANNELS": len(CHANNELS),
        "SEEN": len(OBSERVED),
        "FURTHER": further,
        "PENDING": math.ceil(to_ns(longest) / grid.step) + 2,
        "AT_TIME": where(variables, "time"),
        "AT_SPOOL": at["spool"],
        "AT_SEED": at["seed"],
        "AT_QUANTISE": where(variables, "daq.quantise"),
        "AT_CLIP": where(variables, "daq.clip"),
        "AT_QUANTISE_OUTPUT": where(variables, "daq.quantise_output"),
        "AT_DELAY": where(variables, "loop.delay"),
        "AT_OFFSET": where(variables, f"{SENSOR}.{first}.offset"),
        "AT_NOISE": where(variables, f"{SENSOR}.{first}.noise"),
        "AT_FURTHER_OFFSET": where(variables, f"{FURTHER}.{own}.offset") if further else 0,
        "AT_FURTHER_NOISE": where(variables, f"{FURTHER}.{own}.noise") if further else 0,
        "AT_MEASUREMENT": where(variables, f"measurement.{first}"),
        "AT_FURTHER": where(variables, f"channels.{own}") if further else 0,
        **({"READS_FORCE": 1} if "force" in scenario.daq.channels else {}),
        "AT_STATE": where(variables, f"state.{next(iter(OBSERVED))}"),
    }


def _data(plant: Plant) -> str:
    """plant_data.c."""
    circuit = plant.circuit
    parts = np.ascontiguousarray(circuit.parts).view(np.float64)
    text = '#include "plant_data.h"\n\n#include <math.h>\n\n' + table_of(plant.variables)
    text += doubles("plant_parts", "PARTS", parts.tolist())
    text += wholes("plant_whole", "WHOLES", circuit.whole.tolist())
    text += doubles("plant_numbers", "NUMBERS", circuit.numbers.tolist())
    text += doubles("plant_state", "STATE", plant.state.tolist())
    text += rows("range", "plant_ranges", "CHANNELS", _ranges(plant.scenario))
    text += rows("range", "further_ranges", "FURTHER", _further_ranges(plant.scenario))
    text += rows("source", "further_sources", "FURTHER", _sources(plant.scenario))
    return text + _tune(plant)


def _ranges(scenario: Scenario) -> list[str]:
    card = card_of(scenario.daq)
    found = []
    for low, high, fitted in zip(card.low.tolist(), card.high.tolist(), card.fitted.tolist(), strict=True):
        lsb = (high - low) / 2.0**card.bits
        found.append(f"{literal(low)}, {literal(lsb)}, {literal(high - lsb)}, {int(fitted)}")
    return found


def _further_ranges(scenario: Scenario) -> list[str]:
    if not scenario.daq.channels:
        return []
    inputs = inputs_of(scenario.daq, chosen(scenario))
    each = zip(inputs.low.tolist(), inputs.lsb.tolist(), inputs.high.tolist(), strict=True)
    return [f"{literal(low)}, {literal(lsb)}, {literal(high)}, 1" for low, lsb, high in each]


def _sources(scenario: Scenario) -> list[str]:
    """What each further channel touches."""
    held = {
        name: place_kept(slot, entry.number)
        for name, (slot, entry) in kept(scenario.rig_values()).items()
        if entry.number != FOLLOWS
    }
    derived = {
        "force": "FROM_FORCE, 0, 0",
        "acceleration": f"FROM_SPEED, {SPEED}, 0",
        "load_position": f"FROM_SUM, {POSITION_AT}, {LOAD_AT + STRETCH}",
    }
    found = []
    for name in scenario.daq.channels:
        if name in derived:
            source = derived[name]
        elif name in held:
            source = f"FROM_STATE, {held[name]}, 0"
        else:
            source = f"FROM_SEEN, {PLACES_SEEN[name]}, 0"
        found.append(f"{source}, {zlib.crc32(name.encode())}u")
    return found


def _tune(plant: Plant) -> str:
    """plant_tune: the entries of the circuit that follow from numbers of the rig."""
    lines = []
    allowed = {found.number.name for found in plant.changes.ranges}
    values = {
        found: _start_of(plant, found) for text in plant.changes.entries.values() for found in _NAME.findall(text)
    }
    for place, text in plant.changes.entries.items():

        def in_c(match: re.Match[str]) -> str:
            name = match[1]
            return f"v[{where(plant.variables, name)}].real" if name in allowed else values[name]

        lines.append(f"  parts[{place}] = {_NAME.sub(in_c, text)};")
    return "\n".join(("void plant_tune(const number *v, double *parts) {", "  (void)v;", *lines, "}", ""))


def _start_of(plant: Plant, name: str) -> str:
    _, part, key = name.split(".")
    return literal(plant.scenario.rig_values()[part][key])


def _objects(plant: Plant, platform: Platform) -> dict[str, bytes]:
    """Object files by name."""
    machine = platform.triple, platform.processor
    taps, seen = buffers()
    block = (*plant.circuit, plant.state, 0.0, 1, taps, seen)
    found = {"plant_block": object_code("plant_block", run_steps, block, *machine)}
    if "force" in plant.scenario.daq.channels:
        force = plant.circuit.parts, plant.state, taps, np.zeros(1)
        found["plant_force"] = object_code("plant_force", rod, force, *machine)
    return found
