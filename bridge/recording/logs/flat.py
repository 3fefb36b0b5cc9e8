"""A message of any type as numbers by name: fields within fields, lists by place, joints by their names."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

MOST_ELEMENTS = 64  # of a list: a longer one is an image or a scan
DEEPEST = 8
NS = 1_000_000_000
TIME = ({"sec", "nanosec"}, {"sec", "nsec"}, {"secs", "nsecs"})  # fields of a time, of ROS 2, JSON of it, ROS 1


class Nanoseconds(int):
    """A time that a message holds."""


def flat(message: Any, name: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Names and values of all numbers and texts; a time becomes whole nanoseconds."""
    if isinstance(message, bool | int | float | np.number | str):
        yield name, message.item() if isinstance(message, np.number) else message
        return
    held = _fields(message)
    if held is None or depth > DEEPEST:
        yield from _elements(message, name, [], depth)
        return
    if set(held) in TIME:
        yield name, Nanoseconds(int(held["sec" if "sec" in held else "secs"]) * NS + int(held[_nano(held)]))
        return
    names = _names(held)
    for key, value in held.items():
        own = f"{name}.{key}" if name else key
        if isinstance(value, Sequence | np.ndarray) and not isinstance(value, str):
            yield from _elements(value, own, names if len(value) == len(names) else [], depth)
        else:
            yield from flat(value, own, depth + 1)


def _nano(held: Mapping[str, Any]) -> str:
    return next(key for key in ("nanosec", "nsec", "nsecs") if key in held)


def _fields(message: Any) -> Mapping[str, Any] | None:
    if is_dataclass(message):
        return {field.name: getattr(message, field.name) for field in fields(message) if field.name[:2] != "__"}
    return message if isinstance(message, Mapping) else None


def _names(held: Mapping[str, Any]) -> list[str]:
    """Of a JointState and its like: what its numbers belong to."""
    names = held.get("name", held.get("names"))
    return list(names) if isinstance(names, list) and all(isinstance(name, str) for name in names) else []


def _elements(values: Any, name: str, names: list[str], depth: int) -> Iterator[tuple[str, Any]]:
    if not isinstance(values, Sequence | np.ndarray) or len(values) > MOST_ELEMENTS or depth > DEEPEST:
        return
    for place, value in enumerate(values):
        if not isinstance(value, str):
            yield from flat(value, f"{name}[{names[place] if names else place}]", depth + 1)
