"""Queries for the numbers that may change while a rig runs: what comes in, and what goes out, as JSON."""

import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.scenario import Scenario
from bridge.scenario.tunable import Tunable, in_si, tunable
from bridge.scenario.units import quantity
from controller.grid import NS, to_ns

LONGEST = 64_000  # bytes of a query
LONGEST_TARGET = 64  # bytes
LONGEST_RAMP = 1_000_000 * NS


class Asked(NamedTuple):
    """What somebody wants to set."""

    numbers: dict[str, float]  # SI
    over: int  # [ns]


def asked_for(payload: bytes, scenario: Scenario) -> Asked:
    """What {"set": {"name": value, ...}, "over": "1 s"} asks for, numbers or texts with units. Raises UsageError."""
    asked = _json(payload)
    if not isinstance(asked, dict) or not isinstance(asked.get("set"), dict) or not asked["set"]:
        raise UsageError('send {"set": {"controller.gain": "1.5 V/%"}}, and "over": "1 s" for a ramp')
    try:
        over = to_ns(quantity(asked.get("over", 0.0), "s"))
    except ValueError as error:
        raise UsageError(f"over: {error}") from None
    if not 0 <= over <= LONGEST_RAMP:
        raise UsageError(f"over = {asked['over']!r}: from 0 to {LONGEST_RAMP / NS:g} s")
    return Asked({name: in_si(value, tunable(name, scenario), scenario) for name, value in asked["set"].items()}, over)


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
    names = _json(payload) if payload else list(values)
    if not isinstance(names, list):
        raise UsageError('send a list of names, such as ["controller.gain"], or nothing for all')
    for name in names:
        if name not in values:
            raise UsageError(f"{name!r} is not a number that can change during a run")
    return {"parameters": [values[name][0]._asdict() | {"value": values[name][1]} for name in names]}


def _json(payload: bytes) -> Any:
    if len(payload) > LONGEST:
        raise UsageError(f"a query of {len(payload)} bytes; at most {LONGEST}")
    try:
        return json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"not JSON: {error}") from None
