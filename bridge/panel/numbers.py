"""The numbers of a rig that may change while it runs, as the page shows them: in the units that people read."""

from collections.abc import Iterable
from typing import Any, NamedTuple

from bridge.scenario import Scenario
from bridge.scenario.fields import Gain
from bridge.scenario.fitted import is_motor
from bridge.scenario.gains import scale_of
from bridge.scenario.in_force import in_force
from bridge.scenario.tunable import CONTROLLER, REFERENCE
from bridge.scenario.units import UNITS, shown

FORCE = "rig.load.force"
FIRST = (FORCE, "rig.load.mass", "rig.relief.setting", "rig.pump.speed", "rig.oil.temperature")
TURNED = {"m": "rad", "m/s": "rad/s"}  # a motor's, whose metre stands for a radian
WIDE = 3.0  # times its value that a number without a limit of its own gets on a slider; of the load's force the weight
FAR = 100.0  # times its value: a limit that far away would make a slider useless


class Scale(NamedTuple):
    """What people read: value = factor * SI, less an offset."""

    factor: float
    unit: str


def for_page(parameters: Iterable[dict[str, Any]], scenario: Scenario) -> list[dict[str, Any]]:
    """What `parameters` answers, for the page: those of what is fitted."""
    fitted = in_force(scenario.rig_values())
    return [
        _row(entry, scenario)
        for entry in parameters
        if not entry["name"].startswith("rig.") or entry["name"].removeprefix("rig.") in fitted
    ]


def _row(entry: dict[str, Any], scenario: Scenario) -> dict[str, Any]:
    scale, name = _scale(entry, scenario), entry["name"]
    value, low, high = (
        None if end is None else end * scale.factor for end in (entry["value"], entry["low"], entry["high"])
    )
    first = entry["owner"] == CONTROLLER or name in FIRST
    return {
        "name": name,
        "unit": scale.unit,
        "value": _finite(value),
        "low": _finite(low),
        "high": _finite(high),
        "slider": _slider(name, _finite(value), _finite(low), _finite(high), _weight(scenario)),
        "words": entry["description"],
        "group": "first" if first else name.rpartition(".")[0],
        "sent": _sent(entry, scale),
    }


def _weight(scenario: Scenario) -> float:
    load = scenario.rig_values()["load"]
    return load["mass"] * load["gravity"]


def _scale(entry: dict[str, Any], scenario: Scenario) -> Scale:
    """A gain in volts per % of the stroke, others as everywhere."""
    unit, key = entry["unit"], entry["name"].partition(".")[2]
    if entry["owner"] == CONTROLLER and entry["name"] != REFERENCE:
        field = type(scenario.controller).model_fields.get(key)
        if field and (gain := next((mark for mark in field.metadata if isinstance(mark, Gain)), None)):
            return Scale(1.0 / scale_of(scenario).per_metre(f"1 {gain.volts}"), gain.volts)
    if entry["name"] == REFERENCE and is_motor(scenario.rig_values()):
        return Scale(1.0, TURNED[unit])
    return Scale(*shown(unit))


def _sent(entry: dict[str, Any], scale: Scale) -> str:
    """The unit that the page writes behind a number that is to be set."""
    known = UNITS.get(entry["unit"], {})
    return scale.unit if scale.unit in known or scale.unit.startswith("V") else ""


def _slider(name: str, value: float | None, low: float | None, high: float | None, weight: float) -> list[float] | None:
    """The ends of a slider; None where nobody can say them."""
    if value is None:
        return None
    if name == FORCE:
        return [-WIDE * weight, WIDE * weight]
    if low is None or high is None or (value and high - low > FAR * abs(value)):
        low, high = max(low or 0.0, 0.0) if value > 0.0 else WIDE * value, WIDE * value if value > 0.0 else 0.0
    return [low, high] if low < high and low <= value <= high else None


def _finite(value: float | None) -> float | None:
    return None if value is None or value != value or abs(value) == float("inf") else float(f"{value:.6g}")
