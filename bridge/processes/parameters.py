"""Queries for the numbers that may change while a rig runs: what comes in, the way to the loop, what goes out."""

import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.loop.plant import PlantSide
from bridge.processes.orders import Act, parsed
from bridge.scenario import Scenario
from bridge.scenario.tunable import Tunable, in_si, tunable
from bridge.scenario.units import quantity
from controller.grid import NS, to_ns

LONGEST_TARGET = 64  # bytes
LONGEST_RAMP = 1_000_000 * NS


class Asked(NamedTuple):
    """What somebody wants to set."""

    numbers: dict[str, float]  # SI
    over: int  # [ns]


def set_by(payload: bytes, scenario: Scenario) -> Act:
    """What a query sets, once it has been checked. Raises UsageError."""
    asked = asked_for(payload, scenario)

    def act(side: PlantSide) -> dict[str, Any]:
        begins = side.set(asked.numbers, asked.over)
        units = {name: entry.unit for name, (entry, _) in side.values().items() if name in begins}
        return {"set": asked.numbers, "units": units, "apply_at": begins}

    return act


def listed(side: PlantSide, payload: bytes) -> bytes:
    """The numbers that may change, as JSON; the payload is a list of names, or empty."""
    try:
        found = described(side.values(), payload)
    except UsageError as error:
        found = {"refused": str(error)}
    return json.dumps(found | {"stamp": side.now}).encode()


def asked_for(payload: bytes, scenario: Scenario) -> Asked:
    """What {"set": {"name": value, ...}, "over": "1 s"} asks for, numbers or texts with units. Raises UsageError."""
    asked = parsed(payload)
    if not isinstance(asked, dict) or not isinstance(asked.get("set"), dict) or not asked["set"]:
        raise UsageError('send {"set": {"controller.gain": "1.5 V/%"}}, and "over": "1 s" for a ramp')
    try:
        seconds = quantity(asked.get("over", 0.0), "s")
    except (ValueError, OverflowError) as error:
        raise UsageError(f"over: {error}") from None
    if not 0.0 <= seconds <= LONGEST_RAMP / NS:
        raise UsageError(f"over = {asked['over']!r}: from 0 to {LONGEST_RAMP / NS:g} s")
    return Asked(
        {name: in_si(value, tunable(name, scenario), scenario) for name, value in asked["set"].items()}, to_ns(seconds)
    )


def target_of(payload: bytes) -> float:
    """A target [m] off the wire: a text such as "120 mm". Raises ValueError."""
    if len(payload) > LONGEST_TARGET:
        raise ValueError(f"{len(payload)} bytes; write a length such as '120 mm'")
    position = quantity(payload.decode(), "m")
    if not math.isfinite(position):
        raise ValueError(f"{position} is not a finite number")
    return position


def described(values: Mapping[str, tuple[Tunable, float]], payload: bytes) -> dict[str, Any]:
    """Those of the names in a list, or all, with values, units and limits. Raises UsageError for an unknown name."""
    names = parsed(payload) if payload else list(values)
    if not isinstance(names, list):
        raise UsageError('send a list of names, such as ["controller.gain"], or nothing for all')
    for name in names:
        if not isinstance(name, str) or name not in values:
            raise UsageError(f"{name!r:.100} is not a number that can change during a run")
    return {"parameters": [values[name][0]._asdict() | {"value": values[name][1]} for name in names]}
