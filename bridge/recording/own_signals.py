"""The signals that laws have logged, as columns: of `signals` messages, which carry their names with them."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridge.wire.messages import TOPICS, fields_of

if TYPE_CHECKING:
    from bridge.recording.reader import Recording

TOPIC = "signals"
TYPES = {"uint64": np.uint64, "int64": np.int64}
HEAD = {field.name: TYPES[field.type] for field in fields_of(TOPICS[TOPIC].type) if field.type in TYPES}


def own_columns(messages: list[Any]) -> dict[str, NDArray[Any]]:
    """One array per field and per signal; NaN where a message does not have a signal."""
    columns: dict[str, NDArray[Any]] = {
        name: np.array([getattr(message, name) for message in messages], kind) for name, kind in HEAD.items()
    }
    names = dict.fromkeys(name for message in messages for name in message.names if name not in HEAD)
    columns |= {name: np.full(len(messages), np.nan) for name in names}
    for row, message in enumerate(messages):
        for name, value in zip(message.names, message.values, strict=False):
            if name in names:
                columns[name][row] = value
    return columns


def own_units(recording: "Recording") -> dict[str, str]:
    """The unit of each signal of a recording, as it was first given."""
    found: dict[str, str] = {}
    for message in recording.messages(TOPIC):
        for name, unit in zip(message.names, message.units, strict=False):
            found.setdefault(name, unit)
    return found
