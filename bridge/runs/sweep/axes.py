"""The axes of a sweep: "controller.gain=0.5:4:8", "loop.delay=0 ms, 10 ms", "controller.velocity=measured, backward".

FROM:TO:COUNT are even steps, FROM:TO:COUNT:log even ratios; values that a comma separates are taken as they are.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import UsageError
from bridge.scenario.places import in_unit, refuse_unitless, si_unit_at, usual_unit_at
from bridge.scenario.units import quantity, split

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

MOST_RUNS = 100_000
DIGITS = 12  # of a value between the ends
RANGE = "write FROM:TO:COUNT, such as 0.5:4:8, or FROM:TO:COUNT:log, or values with commas between them"


class Axis(NamedTuple):
    """One value of a scenario, and what it is to be in turn."""

    name: str  # section.name
    texts: tuple[str, ...]  # as a scenario takes them
    unit: str  # of the numbers
    si_unit: str  # of the quantity; "" for gains and plain numbers
    numbers: tuple[float, ...] | None  # in the unit; None for words
    even_ratios: bool = False

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def si(self) -> list[float] | None:
        """The numbers in SI, gains as they are written; None for words."""
        if self.numbers is None or not self.si_unit:
            return None if self.numbers is None else list(self.numbers)
        return [quantity(text, self.si_unit) for text in self.texts]

    def change(self, index: int) -> str:
        """The change of the scenario that makes one of the values."""
        return f"{self.name}={self.texts[index]}"


class _Spread(NamedTuple):
    """FROM:TO:COUNT, read."""

    ends: tuple[str, str]
    number: int
    even_ratios: bool


def axes_of(texts: Sequence[str], scenario: "Scenario") -> list[Axis]:
    """The axes that texts NAME=VALUES describe. Raises UsageError with one line."""
    pairs = [text.partition("=") for text in texts]
    for name, sign, values in pairs:
        if not sign or not name.strip() or not values.strip():
            raise UsageError(f"{name!r} is not an axis; write NAME=VALUES, such as controller.gain=0.5:4:8")
    return checked([axis(name.strip(), values, scenario) for name, _, values in pairs])


def axes_from(values: Mapping[str, str | Sequence[Any]], scenario: "Scenario") -> list[Axis]:
    """The same from Python: texts, or lists in which a number without a unit is SI. Raises UsageError."""
    return checked([_from_python(name, given, scenario) for name, given in values.items()])


def _from_python(name: str, given: str | Sequence[Any], scenario: "Scenario") -> Axis:
    if isinstance(given, str):
        return axis(name, given, scenario)
    return listed(name, [_written(value) for value in given], scenario)


def _written(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else f"{float(value):.{DIGITS}g}"


def checked(axes: list[Axis]) -> list[Axis]:
    """The axes, if a sweep can be made of them. Raises UsageError."""
    if not axes:
        raise UsageError("a sweep needs an axis, such as controller.gain=0.5:4:8")
    for one in axes:
        if len(one.texts) < 2:
            raise UsageError(f"{one.name}: one value is not an axis; give several, or use --set {one.change(0)}")
        values = one.texts if one.numbers is None else one.numbers
        for index, value in enumerate(values):
            if value in values[:index]:
                raise UsageError(f"{one.change(index)} stands twice on its axis")
    names = [one.name for one in axes]
    if twice := [name for name in names if names.count(name) > 1]:
        raise UsageError(f"{twice[0]} is named twice; give all its values to one axis")
    if (runs := math.prod(len(one.texts) for one in axes)) > MOST_RUNS:
        raise UsageError(f"{runs} runs are more than {MOST_RUNS}; take fewer values")
    return axes


def axis(name: str, values: str, scenario: "Scenario") -> Axis:
    """One axis. Raises UsageError."""
    spread = _spread(name, values)
    if spread is None:
        texts = [text.strip() for text in values.split(",")]
        if "" in texts:
            raise UsageError(f"{name}={values}: a value is missing between two commas")
        if _are_numbers(texts):
            texts = with_shared_unit(texts)
            refuse_unitless(scenario, name, texts)
        return listed(name, texts, scenario)
    return _between(name, spread, scenario)


def _spread(name: str, values: str) -> _Spread | None:
    """The ends and the count of a range; None for a list."""
    parts = [part.strip() for part in values.split(":")]
    if len(parts) == 1 or "," in values or not _are_numbers(parts[:1]):
        return None
    log = parts[3:] == ["log"]
    if len(parts) < 3 or (parts[3:] and not log) or not _are_numbers(parts[:2]) or not parts[2].isdecimal():
        raise UsageError(f"{name}={values}: {RANGE}")
    return _Spread((parts[0], parts[1]), int(parts[2]), log)


def _are_numbers(texts: Sequence[str]) -> bool:
    try:
        return all(math.isfinite(split(text)[0]) for text in texts)
    except ValueError:
        return False


def with_shared_unit(texts: list[str]) -> list[str]:
    """Numbers of which only some have a unit: if it is one unit, all have it."""
    units = {split(text)[1] for text in texts} - {""}
    if len(units) != 1:
        return texts
    unit = units.pop()
    return [text if split(text)[1] else f"{text} {unit}" for text in texts]


def listed(name: str, texts: list[str], scenario: "Scenario") -> Axis:
    """The axis of values that stand in a list. Raises UsageError."""
    if not _are_numbers(texts):
        return Axis(name, tuple(texts), "", "", None)
    unit, si_unit = _unit(texts, name, scenario), si_unit_at(scenario, name)
    return Axis(name, tuple(texts), unit, si_unit, tuple(_numbers(name, texts, si_unit, unit)))


def _unit(texts: Sequence[str], name: str, scenario: "Scenario") -> str:
    """The unit of a column: that of the last value that has one."""
    written = [unit for unit in (split(text)[1] for text in texts) if unit]
    return written[-1] if written else usual_unit_at(scenario, name)


def _numbers(name: str, texts: Sequence[str], si_unit: str, unit: str) -> list[float]:
    try:
        return [in_unit(text, si_unit, unit) for text in texts]
    except ValueError as error:
        raise UsageError(f"{name}: {error}") from None


def _between(name: str, spread: _Spread, scenario: "Scenario") -> Axis:
    import numpy as np

    if spread.number > MOST_RUNS:
        raise UsageError(f"{name}: {spread.number} values are more than {MOST_RUNS}; take fewer")
    ends = with_shared_unit([*spread.ends])
    refuse_unitless(scenario, name, ends)
    unit, si_unit = _unit(ends, name, scenario), si_unit_at(scenario, name)
    low, high = _numbers(name, ends, si_unit, unit)
    if spread.even_ratios and low * high <= 0.0:
        raise UsageError(f"{name}: even ratios from {ends[0]} to {ends[1]} do not exist; begin beyond 0")
    between = np.geomspace if spread.even_ratios else np.linspace
    shown = [f"{value:.{DIGITS}g}" for value in between(low, high, spread.number).tolist()]
    texts = tuple(f"{value} {unit}" if split(ends[1])[1] else value for value in shown)
    return Axis(name, texts, unit, si_unit, tuple(map(float, shown)), spread.even_ratios)


def combinations(axes: Sequence[Axis]) -> list[tuple[int, ...]]:
    """Every combination of values, by their places on the axes; the last axis turns fastest."""
    return list(product(*(range(len(one.texts)) for one in axes)))


def changes_of(axes: Sequence[Axis], places: Sequence[int]) -> list[str]:
    """The changes that make the scenario of a combination."""
    return [one.change(place) for one, place in zip(axes, places, strict=True)]
