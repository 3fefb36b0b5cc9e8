"""Places in a piece of a scenario, such as "timeline.1.to": the numbers of a fault. Entries of a list count from 1."""

import copy
from collections.abc import Iterator, Mapping
from typing import Any

from bridge.errors import UsageError, nearest
from bridge.scenario.units import UNITS, split


def numbers_in(piece: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """The places of a piece at which a number stands, with the number as it is written."""
    if isinstance(piece, dict | list):
        items = piece.items() if isinstance(piece, dict) else enumerate(piece, 1)
        for key, value in items:
            yield from numbers_in(value, f"{path}.{key}" if path else str(key))
    elif not isinstance(piece, bool) and is_number(piece):
        yield path, str(piece)


def is_number(value: object) -> bool:
    """A number, or a text with one and a unit."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return False
    try:
        split(str(value))
    except ValueError:
        return False
    return True


def number_at(piece: Any, place: str, name: str) -> str:
    """The number at a place of the fault `name`. Raises UsageError naming the nearest."""
    known = dict(numbers_in(piece))
    if place not in known:
        raise UsageError(f"fault {name!r} has no number {place!r}{nearest(place, known)}")
    return known[place]


def replaced(piece: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of a piece with other values at some of its places."""
    own = copy.deepcopy(piece)
    for place, value in values.items():
        *path, last = [int(key) - 1 if key.isdecimal() else key for key in place.split(".")]
        part: Any = own
        for key in path:
            part = part[key]
        part[last] = value
    return own


def on_grid(number: float, unit: str, step: float) -> float:
    """A number; a time, in a unit of it, as the nearest whole number of steps [s]."""
    if unit not in UNITS["s"]:
        return number
    in_steps = UNITS["s"][unit].factor / step
    return round(number * in_steps) / in_steps
