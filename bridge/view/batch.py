"""What arrives of a running plant, gathered until it is drawn; when it comes faster than that, the oldest is left out.

Zenoh's thread appends and nobody waits: the plant has no way to notice how slow a view is.
"""

import struct
from collections import deque
from typing import Any

from bridge.bus import stamp_of
from bridge.messages import TOPICS, decode, flat_size
from bridge.recording.reader import Entry

WATCHED = ("measurement", "state", "reference", "event", "timing", "lines")
MOST = 40_000  # messages kept, some 10 s at 1 kHz
RUN_ID = struct.Struct("<4xQ")  # every message of ours begins with it


class Inbox:
    """Messages of one rig, the newest MOST of them."""

    def __init__(self) -> None:
        self._waiting: deque[Entry] = deque(maxlen=MOST)
        self._came = 0
        self._taken = 0

    def put(self, topic: str, sample: Any) -> None:
        """Take a message; called by Zenoh's thread."""
        stamp = stamp_of(sample)
        if stamp is not None:
            self._waiting.append(Entry(topic, *stamp, sample.payload.to_bytes()))
            self._came += 1

    @property
    def left_out(self) -> int:
        """Messages that were never drawn."""
        return max(0, self._came - self._taken - len(self._waiting))

    def take(self) -> list[Entry]:
        """All that waits and is a message."""
        entries = []
        while self._waiting:
            entries.append(self._waiting.popleft())
        self._taken += len(entries)
        return [entry for entry in entries if _sound(entry)]


def _sound(entry: Entry) -> bool:
    """Is it what its topic says? Anybody may publish."""
    size = flat_size(TOPICS[entry.topic].type)
    if size is not None:
        return len(entry.data) == size
    try:
        decode(entry.data, entry.topic)
    except ValueError:
        return False
    return True


def run_of(entry: Entry) -> int:
    """The run that a message belongs to."""
    return RUN_ID.unpack_from(entry.data)[0]
