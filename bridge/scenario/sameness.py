"""Whether two processes run the same scenario, and where not: a run put together by hand may mix two."""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

from bridge.scenario.model import Scenario

WORDS = ("name", "title", "expect", "allowed", "real_time")  # that change nothing of what plant and controller do
DIGEST = "scenario"  # the name under which a process publishes it in its status
BITS = 48  # a status carries numbers as float64, which hold 53
MOST = 6  # keys that a sentence names


def digest_of(scenario: Scenario) -> int:
    """A number that two processes share when they run the same."""
    text = json.dumps(_essence(scenario.model_dump(mode="json")), sort_keys=True)
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=BITS // 8).digest(), "big")


def difference(ours: Scenario, plants: Mapping[str, Any]) -> str:
    """What a controller's scenario has different from the plant's (as plain data), in words; empty for nothing."""
    keys = sorted(set(_differing(_essence(ours.model_dump(mode="json")), _essence(plants), "")))
    if not keys:
        return ""
    more = f" and {len(keys) - MOST} more" if len(keys) > MOST else ""
    return (
        f"scenario {ours.name!r}, the plant {str(plants.get('name'))!r}: they differ in {', '.join(keys[:MOST])}{more}"
    )


def _essence(data: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in data.items() if key not in WORDS}


def _differing(a: Any, b: Any, place: str) -> Iterator[str]:
    if not (isinstance(a, Mapping) and isinstance(b, Mapping)):
        if _written(a) != _written(b):
            yield place
        return
    for key in {*a, *b}:
        yield from _differing(a.get(key), b.get(key), f"{place}.{key}".lstrip("."))


def _written(value: Any) -> Any:
    """An infinite number as JSON has it, which knows it by a word alone."""
    infinite = isinstance(value, float) and math.isinf(value)
    return ("Infinity" if value > 0.0 else "-Infinity") if infinite else value
