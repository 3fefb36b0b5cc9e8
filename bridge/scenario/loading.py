"""Scenarios checked on the way in, with one line per mistake."""

import copy
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bridge.errors import MisplacedError, ScenarioError, nearest
from bridge.scenario.files import UNION_SECTIONS, apply, ordered, plain, with_tables

if TYPE_CHECKING:
    from pydantic import ValidationError

    from bridge.scenario.model import Scenario


def load(which: str, changes: list[str] | None = None) -> "Scenario":
    """A built-in scenario by name, or a TOML (or JSON) file by path, with changes such as "controller.gain=0.4".

    Raises ScenarioError with one line per mistake.
    """
    data = plain(which)
    for change in ordered(changes or []):
        apply(data, change)
    return check(with_tables(data, Path()), which)


def changed(data: dict[str, Any], changes: Collection[str], which: str) -> "Scenario":
    """The scenario that plain data describe, with changes. Raises ScenarioError with one line per mistake."""
    own = copy.deepcopy(data)
    for change in ordered(changes):
        apply(own, change)
    return check(with_tables(own, Path()), which)


def check(data: dict[str, Any], which: str) -> "Scenario":
    """The scenario that plain data describe. Raises ScenarioError with one line per mistake."""
    from pydantic import ValidationError

    from bridge.scenario.model import Scenario

    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        raise ScenarioError("\n".join(f"{which}: {line}" for line in _lines(error))) from None


def _lines(error: "ValidationError") -> Iterator[str]:
    for entry in error.errors():
        place = [str(part) for part in entry["loc"]]
        kind, context = entry["type"], entry.get("ctx", {})
        own = untagged(place)
        where = ".".join(own)
        if kind == "extra_forbidden":
            yield f"{where}: {_unknown_key(place)}"
        elif kind == "value_error":
            said = context["error"]
            where = ".".join([*own, said.key]) if isinstance(said, MisplacedError) else where
            yield f"{where}: {said}" if where else str(said)
        elif kind in LIMITS:
            limit = context[LIMITS[kind][1]]
            yield f"{where}: {entry['input']!r} must be {LIMITS[kind][0]} {limit}"
        elif kind in ("literal_error", "enum", "union_tag_invalid"):
            valid = str(context.get("expected") or context.get("expected_tags"))
            words = [word.strip(" '") for word in valid.replace(" or ", ",").split(",")]
            given = str(context.get("tag", entry["input"]))
            where += ".kind" if kind == "union_tag_invalid" else ""
            yield f"{where}: {given!r} is unknown{nearest(given, words)}"
        else:
            yield f"{where}: {entry['msg'].lower()} (got {entry['input']!r})"


def untagged(place: list[str]) -> list[str]:
    """The place of a value as it is written: without the kind that pydantic puts behind `controller` and the like."""
    return [*place[:1], *place[2:]] if place and place[0] in UNION_SECTIONS else place


LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}


def _unknown_key(place: list[str]) -> str:
    from bridge.scenario.controllers import INSTEAD
    from bridge.scenario.kinds import UNIONS

    key = place[-1]
    if place[0] not in UNIONS or len(place) < 3:
        slots = (
            "; the circuit is a fixed skeleton of slots, docs/drives.md"
            if place[0] == "rig" and len(place) == 2
            else ""
        )
        return f"unknown key{_near(key, _model_at(place[:-1]))}{slots}"
    tag = place[1]
    if instead := INSTEAD.get((tag, key)):
        return instead
    kinds = UNIONS[place[0]]
    others = [name for name, model in kinds.items() if key in model.model_fields]
    said = f"kind {tag!r} does not have it, but {', '.join(map(repr, others))}" if others else "unknown key"
    return said + _near(key, kinds[tag])


def _model_at(place: list[str]) -> Any:
    from bridge.scenario.model import Scenario

    model: Any = Scenario
    for name in place:
        field = model.model_fields.get(name) if model else None
        model = field.annotation if field is not None and hasattr(field.annotation, "model_fields") else None
    return model


def _near(key: str, model: Any) -> str:
    return nearest(key, list(model.model_fields)) if model else ""


FASTEST_DAQ = 0.2e-3  # [s] of wall time


def refuse_fast_daq(scenario: "Scenario", speed: float) -> None:
    """Real time goes to 5 kHz; faster acquisition is for lockstep and in process."""
    least = FASTEST_DAQ * speed
    if scenario.loop.daq_period < least * 0.999:
        raise ScenarioError(
            f"loop.daq_period {scenario.loop.daq_period:g} s at speed {speed:g}: real time goes to 5 kHz; "
            f"nearest valid: {least:g} s; faster with --mode lockstep or inprocess"
        )
