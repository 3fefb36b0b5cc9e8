"""The sections of a scenario beside its rig, value by value: start, time grid, controller, reference, card."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from bridge.scenario.fields import Worded
from bridge.scenario.model import Scenario
from bridge.scenario.units import SHOWN, UNITS

SECTIONS = ("start", "loop", "controller", "reference", "daq")
LONGEST = 60  # characters of a value
PLAIN = ("m/s",)  # units that read better than those of SHOWN
OWN = "this scenario"


class Setting(NamedTuple):
    """One value of a section."""

    name: str
    value: str
    source: str
    changed: bool  # not the default
    origin: str = ""  # the extended scenario that a changed one is from; "" where the scenario itself says it


def settings_of(scenario: Scenario, inherited: Mapping[str, str] | None = None) -> list[Setting]:
    """Every value of the sections; inherited: names of values, and the extended scenario that each is from."""
    return [
        _setting(section, key, getattr(scenario, section), inherited or {})
        for section in SECTIONS
        for key in type(getattr(scenario, section)).model_fields
    ]


def _setting(section: str, key: str, model: Any, inherited: Mapping[str, str]) -> Setting:
    field, value, name = type(model).model_fields[key], getattr(model, key), f"{section}.{key}"
    reader = next((m for m in field.metadata if isinstance(m, Worded)), None)
    unit = getattr(reader, "unit", "")
    default = None if field.is_required() else field.get_default(call_default_factory=True)
    changed = field.is_required() or value != default
    words = field.description or ""
    if not changed:
        return Setting(name, in_words(value, unit), words, False)
    otherwise = "" if field.is_required() else f"; otherwise {in_words(default, unit)}"
    origin = inherited.get(name, "")
    source = "; ".join(filter(None, [f"{origin or OWN}{otherwise}", words]))
    return Setting(name, in_words(value, unit), source, True, origin)


def in_words(value: Any, unit: str) -> str:
    """A value for people."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, int | float):
        shown = _time_unit(value) if unit == "s" else unit if unit in PLAIN else SHOWN.get(unit, unit)
        known = UNITS.get(unit, {}).get(shown)
        return f"{(value - known.offset) / known.factor if known else value:.6g} {shown}".rstrip()
    text = ", ".join(map(str, value)) or "none" if isinstance(value, list | tuple) else str(value)
    text = " ".join(text.split())
    return text if len(text) <= LONGEST else f"{text[:LONGEST]} ..."


def _time_unit(value: float) -> str:
    """What a time [s] reads best in."""
    return "s" if value >= 1.0 else "ms" if value >= 1e-3 or value == 0.0 else "us"
