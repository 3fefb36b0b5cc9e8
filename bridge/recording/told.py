"""All events of a recording: those of the plant, and what the law has said."""

from typing import Any

from bridge.recording.reader import Recording
from bridge.wire.messages import TOLD


def events_of(recording: Recording) -> list[Any]:
    """In the order of their instants; at the same one the plant's come first."""
    found = [event for topic in TOLD for event in recording.messages(topic)]
    return sorted(found, key=lambda event: event.stamp) if recording.counts.get("said") else found
