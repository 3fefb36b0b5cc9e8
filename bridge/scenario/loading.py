"""Scenario files: found, read, changed from the command line, and checked with one line per mistake."""

import copy
import json
import tomllib
from collections.abc import Iterable, Iterator
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bridge.errors import ScenarioError, nearest, reason
from bridge.scenario import references
from bridge.scenario.law_file import with_place
from bridge.scenario.model import Scenario


def names() -> list[str]:
    """The built-in scenarios."""
    return sorted(path.name.removesuffix(".toml") for path in _built_in().iterdir() if path.name.endswith(".toml"))


def _built_in():
    return resources.files("bridge.scenario") / "built_in"


def load(which: str, changes: list[str] | None = None) -> Scenario:
    """A built-in scenario by name, or a TOML (or JSON) file by path, with changes such as "controller.gain=0.4".

    Raises ScenarioError with one line per mistake.
    """
    data = _read(which, ())
    data["name"] = data.get("name", Path(which).stem)
    for change in changes or []:
        _apply(data, change)
    return check(data, which)


def _read(which: str, extended_by: tuple[str, ...]) -> dict[str, Any]:
    """The plain data of a scenario, on top of those of the one it extends."""
    if which in extended_by:
        raise ScenarioError(f"{which}: extends itself, by way of {', '.join(extended_by)}")
    text, folder = _source(which)
    try:
        data = json.loads(text) if which.endswith(".json") else tomllib.loads(text)
    except ValueError as error:
        raise ScenarioError(f"{which}: cannot be read: {error}") from None
    data = with_place(_with_tables(data, folder), folder)
    base = data.pop("extends", None)
    if base is None:
        return data
    beside = folder / str(base)
    found = _read(str(beside) if beside.is_file() else str(base), (*extended_by, which))
    found.pop("name", None)
    return _merged(found, data)


def _merged(base: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Sections are merged, all else is replaced."""
    both = {
        key: _merged(base[key], own[key])
        for key in own
        if isinstance(base.get(key), dict) and isinstance(own[key], dict)
    }
    return base | own | both


def changed(data: dict[str, Any], changes: Iterable[str], which: str) -> Scenario:
    """The scenario that plain data describe, with changes. Raises ScenarioError with one line per mistake."""
    own = copy.deepcopy(data)
    for change in changes:
        _apply(own, change)
    return check(own, which)


def check(data: dict[str, Any], which: str) -> Scenario:
    """The scenario that plain data describe. Raises ScenarioError with one line per mistake."""
    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        raise ScenarioError("\n".join(f"{which}: {line}" for line in _lines(error))) from None


def _source(which: str) -> tuple[str, Path]:
    if which in names():
        return (_built_in() / f"{which}.toml").read_text(encoding="utf-8"), Path()
    path = Path(which)
    if path.is_file():
        return _text(path), path.parent
    raise ScenarioError(f"{which}: no such scenario or file{nearest(which, names())}")


def _text(path: Path) -> str:
    """A file of the user's: UTF-8 whatever the locale, with or without a mark at its beginning."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 at byte {error.start}; save it as UTF-8") from None
    except OSError as error:
        raise ScenarioError(reason(error)) from None


def _with_tables(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A reference's CSV file is read here, so that the scenario carries all it needs."""
    reference = data.get("reference")
    if isinstance(reference, dict) and isinstance(name := reference.get("csv"), str) and "\n" not in name:
        path = folder / name
        if not path.is_file():
            raise ScenarioError(f"reference.csv: no file {str(path)!r}")
        return data | {"reference": reference | {"csv": _text(path)}}
    return data


def _apply(data: dict[str, Any], change: str) -> None:
    key, sign, text = change.partition("=")
    if not sign or not key.strip():
        raise ScenarioError(f"{change!r} is not a change; write section.name=value, such as controller.gain=0.4")
    *path, last = key.strip().split(".")
    for name in path:
        data = data.setdefault(name, {})
        if not isinstance(data, dict):
            raise ScenarioError(f"{change!r}: {name!r} is a value, not a section")
    try:
        data[last] = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        data[last] = text.strip()


def _lines(error: ValidationError) -> Iterator[str]:
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
