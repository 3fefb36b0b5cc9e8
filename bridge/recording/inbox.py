"""What arrives of a running plant, gathered until it is shown; when it comes faster than that, the oldest is left out.

Zenoh's own threads fill the rings and wait for nobody, not even for Python: a reader that is slow to take a message off
the wire would cost the plant time.
"""

import struct
from collections.abc import Iterable
from typing import Any

import zenoh

from bridge.recording.entries import Entry
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.codec import decode
from bridge.wire.messages import CHANNELS_TOPIC, ESTIMATE, HEALTH, TOPICS, flat_size

# what people look at: not the loop's own, which go out at once, at a price; further channels are chosen to be seen
WATCHED = ("lines", "state", "reference", "signals", "said", "event", "timing", CHANNELS_TOPIC, ESTIMATE, HEALTH)
MOST = 10_000  # messages of a topic that wait, some 10 s at 1 kHz
RUN_ID = struct.Struct("<4xQ")  # every message of ours begins with it


class Inbox:
    """Messages of one rig, the newest MOST of each topic."""

    def __init__(self, rings: dict[str, Any]) -> None:
        self._rings = rings  # topic -> what gives its next message, or None
        self._next: dict[tuple[str, int], int] = {}  # topic and run -> sequence expected
        self.left_out = 0  # messages that were never shown

    def take(self) -> list[Entry]:
        """All that waits and is a message; a profile never without the state of its tick, unless that came before."""
        entries = [entry for topic, ring in self._rings.items() for entry in self._drain(topic, ring)]
        if len(self._next) > MOST:
            self._next.clear()  # somebody invents runs
        for entry in entries:
            key = entry.topic, run_of(entry)
            self.left_out += max(0, entry.sequence - self._next.get(key, entry.sequence))
            self._next[key] = entry.sequence + 1
        return entries

    def _drain(self, topic: str, ring: Any) -> list[Entry]:
        entries = []
        while (sample := ring.try_recv()) is not None:
            stamp = stamp_of(sample)
            if stamp is not None:
                entries.append(Entry(topic, *stamp, sample.payload.to_bytes()))
        return [entry for entry in entries if _sound(entry)]


def inbox(bus: Bus, topics: Iterable[str]) -> Inbox:
    """The inbox of some topics of a rig on a bus."""
    ring = zenoh.handlers.RingChannel
    return Inbox({t: bus.session.declare_subscriber(f"{bus.rig_name}/{t}", ring(MOST)) for t in topics})


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
