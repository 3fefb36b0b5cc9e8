"""What stands at a place of a scenario such as "controller.gain", and its unit."""

from typing import TYPE_CHECKING, Any

from bridge.errors import UsageError
from bridge.scenario.units import UNITS, quantity, split

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario


def _field_at(scenario: "Scenario", name: str) -> tuple[Any, Any]:
    """The value of a place, and what reads it; None and None for a place that the scenario does not have."""
    from bridge.scenario.fields import Worded

    place: Any = scenario
    *path, last = name.split(".")
    for part in path:
        place = getattr(place, part, None)
    if isinstance(place, dict):
        return place.get(last), None
    field = getattr(type(place), "model_fields", {}).get(last)
    if field is None:
        return None, None
    return getattr(place, last), next((m for m in field.metadata if isinstance(m, Worded)), None)


def value_at(scenario: "Scenario", name: str) -> Any:
    """The value that a scenario has at a place, None without one: a number in SI, a gain as a text."""
    return _field_at(scenario, name)[0]


def si_unit_at(scenario: "Scenario", name: str) -> str:
    """The SI unit of a quantity at a place; "" for a gain, for a plain number, and where nothing stands."""
    return getattr(_field_at(scenario, name)[1], "unit", "")


def usual_unit_at(scenario: "Scenario", name: str) -> str:
    """The unit that a number without one has at a place."""
    reader = _field_at(scenario, name)[1]
    return getattr(reader, "volts", getattr(reader, "unit", ""))


def in_unit(text: str, si_unit: str, unit: str) -> float:
    """The number of a text such as "10 ms" in another unit of the same quantity. Raises ValueError."""
    number, written = split(text)
    if written == unit:
        return number
    if not written and (not si_unit or number == 0.0):
        return number
    if not si_unit:
        raise ValueError(f"{text!r} is not in {unit}: write all values in one unit")
    one, zero = quantity(f"1 {unit}", si_unit), quantity(f"0 {unit}", si_unit)
    return float(f"{(quantity(text, si_unit) - zero) / (one - zero):.12g}")


def refuse_unitless(scenario: "Scenario", name: str, texts: list[str]) -> None:
    """Raises UsageError for values without a unit where SI would be a surprise: times, lengths, pressures."""
    unit = si_unit_at(scenario, name)
    bare = [text for text in texts if not split(text)[1] and split(text)[0] != 0.0]
    if unit and bare:
        known = ", ".join(filter(None, UNITS[unit]))
        raise UsageError(
            f"{name}: {bare[0]} has no unit, and would be {bare[0]} {unit}: write one of {known} behind it"
        )
