"""Scenarios checked on the way in, with one line per mistake."""

import copy
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from bridge.errors import ScenarioError, nearest
from bridge.scenario.files import apply, plain

if TYPE_CHECKING:
    from pydantic import ValidationError

    from bridge.scenario.model import Scenario


def load(which: str, changes: list[str] | None = None) -> "Scenario":
    """A built-in scenario by name, or a TOML (or JSON) file by path, with changes such as "controller.gain=0.4".

    Raises ScenarioError with one line per mistake.
    """
    data = plain(which)
    for change in changes or []:
        apply(data, change)
    return check(data, which)


def changed(data: dict[str, Any], changes: Iterable[str], which: str) -> "Scenario":
    """The scenario that plain data describe, with changes. Raises ScenarioError with one line per mistake."""
    own = copy.deepcopy(data)
    for change in changes:
        apply(own, change)
    return check(own, which)


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
        where = ".".join(part for part in place if part not in REFERENCES)
        if kind == "extra_forbidden":
            yield f"{where}: unknown key{_near_key(place)}"
        elif kind == "value_error":
            yield f"{where}: {context['error']}" if where else str(context["error"])
        elif kind in LIMITS:
            limit = context[LIMITS[kind][1]]
            yield f"{where}: {entry['input']!r} must be {LIMITS[kind][0]} {limit}"
        elif kind in ("literal_error", "union_tag_invalid"):
            valid = str(context.get("expected") or context.get("expected_tags"))
            words = [word.strip(" '") for word in valid.replace(" or ", ",").split(",")]
            given = str(context.get("tag", entry["input"]))
            yield f"{where}: {given!r} is unknown{nearest(given, words)}"
        else:
            yield f"{where}: {entry['msg'].lower()} (got {entry['input']!r})"


LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
REFERENCES = {"constant", "step", "square", "ramp", "sine", "chirp", "table"}


def _near_key(place: list[str]) -> str:
    from bridge.scenario import references
    from bridge.scenario.model import Scenario

    model: Any = Scenario
    for name in place[:-1]:
        if name in REFERENCES and model is None:
            model = getattr(references, name.capitalize())
        else:
            field = model.model_fields.get(name) if model else None
            model = field.annotation if field is not None and hasattr(field.annotation, "model_fields") else None
    valid = list(model.model_fields) if model else []
    return nearest(place[-1], valid) if valid else ""


FASTEST_DAQ = 0.2e-3  # [s] of wall time


def refuse_fast_daq(scenario: "Scenario", speed: float) -> None:
    """Real time goes to 5 kHz; faster acquisition is for lockstep and in process."""
    least = FASTEST_DAQ * speed
    if scenario.loop.daq_period < least * 0.999:
        raise ScenarioError(
            f"loop.daq_period {scenario.loop.daq_period:g} s at speed {speed:g}: real time goes to 5 kHz; "
            f"nearest valid: {least:g} s; faster with --mode lockstep or inprocess"
        )
