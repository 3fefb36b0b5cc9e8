"""Facts that a recording carries about its run: MCAP has no checksum for them, so their shape is looked at."""

import json
from collections.abc import Mapping
from typing import Any

from mcap.records import Metadata

from bridge.recording.earlier import in_todays_words

Shape = Mapping[str, Any]  # name -> type, shape of what is within, or (type of every value,)
NUMBER = (int, float, type(None))
SCENARIO: Shape = {"name": str, "rig_name": str, "controller": {"kind": str}, "loop": ((int, float, str),)}
SHAPES: Mapping[str, Shape] = {
    "run": {"run_id": (int, str), "scenario": SCENARIO},
    "summary": {"ending": str, "metrics": (NUMBER,), "timing": (dict,), "lost": (int,)},
    "recovered": {"damaged_chunks": int},
    "refused": {"reason": str, "time": str},
    "imported": {"source": str, "sha256": str, "rows": (int,), "time": dict, "signals": (dict,), "notes": list},
}


def facts_of(record: Metadata) -> dict[str, Any] | None:
    """Facts by name; None where they cannot be what this program writes under the record's name."""
    facts = {key: _value(text) for key, text in record.metadata.items()}
    if record.name == "run":
        facts = in_todays_words(facts)
    return facts if _has(facts, SHAPES.get(record.name, {})) else None


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _has(value: Any, shape: Any) -> bool:
    if isinstance(shape, Mapping):
        return isinstance(value, Mapping) and all(_has(value.get(key), inner) for key, inner in shape.items())
    if isinstance(shape, tuple) and len(shape) == 1:
        return isinstance(value, dict) and all(isinstance(entry, shape[0]) for entry in value.values())
    return isinstance(value, shape)
