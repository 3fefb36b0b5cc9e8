"""Mistakes in a scenario, as pydantic finds them, in one line each: the place, what stands there, the way out."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from bridge.errors import MisplacedError, nearest
from bridge.scenario.files import UNION_SECTIONS
from bridge.scenario.misplaced import instead_of

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

LIMITS = {
    "greater_than": ("greater than", "gt"),
    "greater_than_equal": ("at least", "ge"),
    "less_than": ("less than", "lt"),
    "less_than_equal": ("at most", "le"),
}
WORDS = {"literal_error": "", "enum": "", "union_tag_invalid": ".kind"}  # what stands behind the place
KINDS_OF_VALUE = {  # beginnings of pydantic's names: what such a value is, and how it is written
    "float": ("a number", "a plain number, such as 12"),
    "finite": ("a finite number", "a plain number, such as 12"),
    "int": ("a whole number", "one such as 1"),
    "bool": ("true or false", "one of these, without quotes"),
    "string": ("text", "it in quotes"),
    "list": ("a list", "it in brackets, such as [1, 2]"),
    "tuple": ("a list", "it in brackets, such as [1, 2]"),
    "dict": ("a section", "[{where}], and its values below that"),
    "model": ("a section", "[{where}], and its values below that"),
}
MOST = 20  # mistakes that are told one by one
LONGEST_LINE = 2000  # characters
LONGEST = 80  # characters of a value that are shown


def lines(error: "ValidationError") -> Iterator[str]:
    """What is wrong, the place first."""
    for entry in error.errors()[:MOST]:
        place = [str(part)[:LONGEST] for part in entry["loc"]]
        where, said = _line(entry, place)
        yield (f"{where}: {said}" if where else said)[:LONGEST_LINE]
    if (further := error.error_count() - MOST) > 0:
        yield f"and {further} mistakes more"


def untagged(place: list[str]) -> list[str]:
    """The place of a value as it is written: without the kind that pydantic puts behind `controller` and the like."""
    return [*place[:1], *place[2:]] if place and place[0] in UNION_SECTIONS else place


def _line(entry: "ErrorDetails", place: list[str]) -> tuple[str, str]:
    kind, context, own = entry["type"], entry.get("ctx", {}), untagged(place)
    where = ".".join(own)
    if kind == "extra_forbidden":
        return where, _unknown_key(place)
    if kind == "value_error":
        said = context["error"]
        return ".".join([*own, said.key]) if isinstance(said, MisplacedError) else where, str(said)
    if kind in LIMITS:
        words, limit = LIMITS[kind]
        return where, f"{entry['input']!r} must be {words} {context[limit]}"
    if kind in WORDS:
        return where + WORDS[kind], _unknown_word(str(context.get("tag", entry["input"])), context)
    if kind == "union_tag_not_found":
        return where, _without_kind(entry["input"], where, place[0])
    if kind == "missing":
        return where, _missing(place)
    return where, _wrong_value(entry, where)


def _unknown_word(given: str, context: dict[str, Any]) -> str:
    valid = str(context.get("expected") or context.get("expected_tags"))
    words = [word.strip(" '") for word in valid.replace(" or ", ",").split(",")]
    return f"{given!r} is unknown{nearest(given, words)}"


def _without_kind(given: object, where: str, section: str) -> str:
    from bridge.scenario.kinds import UNIONS

    if not isinstance(given, dict):
        return f"{_shown(given)} is not a section; write [{where}], and its values below that"
    return f"kind is missing; write one of {', '.join(UNIONS[section])}"


def _missing(place: list[str]) -> str:
    """What a key that must be there would hold."""
    if len(place) == 1:
        example = ' with kind = "constant" and value = "100 mm"' if place[0] == "reference" else ""
        return f"the section is missing; write [{place[0]}]{example}, or extend a scenario that has one"
    if place[0] in UNION_SECTIONS and len(place) == 3:
        kind, key = place[1], place[2]
        return f"missing; kind {kind!r} needs it{_example(place[0], kind, key)}"
    return "missing; write it"


def _example(section: str, kind: str, key: str) -> str:
    from bridge.scenario.fields import Worded
    from bridge.scenario.kinds import UNIONS

    field = UNIONS[section][kind].model_fields.get(key)
    reader = next((m for m in field.metadata if isinstance(m, Worded)), None) if field else None
    return f": {reader.description}" if reader else ""


def _wrong_value(entry: "ErrorDetails", where: str) -> str:
    """A value of another type, text that cannot be read, or text in the wrong shape."""
    kind, given = entry["type"], entry["input"]
    if kind == "string_pattern_mismatch":
        return f"{_shown(given)} has other characters than letters, digits, - and _"
    if kind in ("too_short", "too_long"):
        limits = entry.get("ctx", {})
        wanted = limits.get("min_length") or limits.get("max_length")
        return f"{_shown(given)} has {limits.get('actual_length')} entries; write {wanted}"
    if kind == "int_from_float":
        return f"{given!r} is not a whole number; write one such as {round(given)}"
    what = KINDS_OF_VALUE.get(kind.partition("_")[0])
    if what is None:
        return f"{entry['msg'].lower()} (got {_shown(given)})"
    return f"{_shown(given)} is not {what[0]}; write {_suggested(kind, given) or what[1].format(where=where)}"


def _suggested(kind: str, given: object) -> str:
    """The value as it was likely meant; empty where nothing suggests itself."""
    from bridge.scenario.units import split

    if kind.startswith("list") and isinstance(given, str | int | float) and not isinstance(given, bool):
        return f'["{given}"]' if isinstance(given, str) else f"[{given}]"
    if kind.startswith("string") and isinstance(given, int | float):
        return f'"{given}"'
    if kind.startswith(("float", "int")) and isinstance(given, str):
        try:
            return f"{split(given)[0]:g}"
        except ValueError:
            return ""
    return ""


def _shown(given: object) -> str:
    text = repr(given)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def _unknown_key(place: list[str]) -> str:
    from bridge.scenario.controllers import INSTEAD
    from bridge.scenario.kinds import UNIONS

    key = place[-1]
    if place[0] not in UNIONS or len(place) < 3:
        elsewhere = instead_of(place)
        return elsewhere or f"unknown key{_near(key, _model_at(place[:-1]))}{_slots(place)}"
    tag = place[1]
    if instead := INSTEAD.get((tag, key)):
        return instead
    kinds = UNIONS[place[0]]
    others = [name for name, model in kinds.items() if key in model.model_fields]
    said = f"kind {tag!r} does not have it, but {', '.join(map(repr, others))}" if others else "unknown key"
    return said + _near(key, kinds[tag])


def _slots(place: list[str]) -> str:
    in_rig = place[0] == "rig" and len(place) == 2
    return "; the circuit is a fixed skeleton of slots, docs/drives.md" if in_rig else ""


def _model_at(place: list[str]) -> Any:
    from bridge.scenario.model import Scenario

    model: Any = Scenario
    for name in place:
        field = model.model_fields.get(name) if model else None
        model = field.annotation if field is not None and hasattr(field.annotation, "model_fields") else None
    return model


def _near(key: str, model: Any) -> str:
    return nearest(key, list(model.model_fields)) if model else ""
