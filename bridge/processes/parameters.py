"""Queries for the numbers that may change while a rig runs: what comes in, the way to the loop, what goes out."""

import json
import math
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, Future
from typing import Any, NamedTuple

from bridge.errors import ScenarioError, UsageError
from bridge.loop.plant import PlantSide
from bridge.scenario import Scenario
from bridge.scenario.tunable import Tunable, in_si, tunable
from bridge.scenario.units import quantity
from controller.grid import NS, to_ns

LONGEST = 64_000  # bytes of a query
LONGEST_TARGET = 64  # bytes
SETTING = 2.0  # seconds for the loop to take what somebody sets
LONGEST_RAMP = 1_000_000 * NS


class Asked(NamedTuple):
    """What somebody wants to set."""

    numbers: dict[str, float]  # SI
    over: int  # [ns]


class Settings(NamedTuple):
    """What somebody wants to set, on its way to the loop, and where the answer goes."""

    asked: Asked
    answer: Future[dict[str, Any]]

    def take(self, side: PlantSide) -> None:
        """In the loop, between two ticks: change the numbers, or say why not."""
        if not self.answer.set_running_or_notify_cancel():
            return  # whoever asked has been told that the plant does not answer
        try:
            begins = side.set(self.asked.numbers, self.asked.over)
        except ScenarioError as error:
            self.answer.set_result({"refused": str(error)})
        else:
            units = {name: entry.unit for name, (entry, _) in side.values().items() if name in begins}
            self.answer.set_result({"set": self.asked.numbers, "units": units, "apply_at": begins})


def answer_to(payload: bytes, scenario: Scenario, hand_in: Callable[[Settings], None]) -> bytes:
    """Outside the loop: check what somebody sets, hand it in and wait; the answer, as JSON."""
    try:
        settings = Settings(asked_for(payload, scenario), Future())
    except UsageError as error:
        return json.dumps({"refused": str(error)}).encode()
    hand_in(settings)
    try:
        return json.dumps(settings.answer.result(SETTING)).encode()
    except (TimeoutError, CancelledError):
        settings.answer.cancel()
        return json.dumps({"refused": "the plant does not take it now: it waits, or has ended"}).encode()


def listed(side: PlantSide, payload: bytes) -> bytes:
    """The numbers that may change, as JSON; the payload is a list of names, or empty."""
    try:
        found = described(side.values(), payload)
    except UsageError as error:
        found = {"refused": str(error)}
    return json.dumps(found | {"stamp": side.now}).encode()


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
