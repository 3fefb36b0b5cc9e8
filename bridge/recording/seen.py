"""What is known of the state of a drive: the true one of a run, or what was measured of a rig."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.imported import is_measured
from bridge.recording.reader import Recording
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, field_names
from twin.topology import CHANNELS

STATE = "state"
JUDGED = ("position", "p1", "p_lower", "p_upper", "spool")
FIELDS = field_names(TOPICS[STATE].type)


def seen(recording: Recording) -> dict[str, NDArray[Any]]:
    """The columns of `state`. Of a measured recording those that sensors have read; the others are NaN."""
    if recording.counts.get(STATE) or not is_measured(recording):
        return recording.columns(STATE)
    read = recording.columns("measurement")
    stamps = read["stamp"]
    found: dict[str, NDArray[Any]] = {name: np.full(len(stamps), np.nan) for name in FIELDS}
    found |= {name: read[name] for name in ("run_id", "sequence", "tick", "stamp")}
    found |= {channel.reads: read[name] for name, channel in CHANNELS.items()}
    if recording.counts.get(CHANNELS_TOPIC):
        further = recording.columns(CHANNELS_TOPIC)
        found |= {name: further[name] for name in FIELDS if name in further}
    return found | {"reference": commanded(recording, stamps)}


def judged(recording: Recording) -> dict[str, NDArray[Any]]:
    """The same for metrics and bands: of a measured recording the rows that lack nothing that others have."""
    state = seen(recording)
    if not is_measured(recording):
        return state
    ever = [np.isfinite(state[name]) for name in JUDGED if np.isfinite(state[name]).any()]
    rows = np.all(ever, axis=0) if ever else np.ones(len(state["stamp"]), bool)
    return {name: column[rows] for name, column in state.items()} if rows.any() else state


def commanded(recording: Recording, stamps: NDArray[np.int64]) -> NDArray[np.float64]:
    """The spool reference that was sent at each of some instants [ns]; NaN where none was."""
    sent = recording.columns("command")
    known = dict(zip(sent["sample_stamp"].tolist(), sent["spool"].tolist(), strict=True))
    return np.array([known.get(stamp, np.nan) for stamp in stamps.tolist()], np.float64)


def instants(recording: Recording) -> int:
    """How many rows `seen` has."""
    return recording.counts.get("measurement" if is_measured(recording) else STATE, 0)
