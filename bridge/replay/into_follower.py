"""A recording through a twin beside it: what it would have estimated, had it listened."""

from collections.abc import Iterator

from bridge.loop.follower import FollowerSide
from bridge.recording.entries import Entry
from bridge.recording.reader import Recording
from bridge.wire.codec import decode
from bridge.wire.messages import Outgoing

ORDER = {"command": 0, "event": 1, "measurement": 2}  # of what belongs to one instant


def through_follower(recording: Recording, side: FollowerSide) -> Iterator[list[Outgoing]]:
    """What the twin says to each scan; of what it is given the order within an instant does not matter."""
    entries = [entry for entry in recording.entries if entry.topic in ORDER]
    for entry in sorted(entries, key=lambda entry: (entry.log_time, ORDER[entry.topic])):
        yield _given(entry, side)
    yield side.finish()


def _given(entry: Entry, side: FollowerSide) -> list[Outgoing]:
    message = decode(entry.data, entry.topic)
    if entry.topic == "command":
        return side.take(message)
    if entry.topic == "event":
        side.heed(message)
        return []
    return side.hear(message)
