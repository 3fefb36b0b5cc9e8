"""One hash per data channel: equal when, and only when, two runs recorded the same data."""

import hashlib
import struct
from pathlib import Path

from bridge.recording.reader import read
from bridge.wire.messages import TOPICS


def digest(path: Path) -> dict[str, str]:
    """Hash over (log_time, sequence, data) in channel order, for each data channel; absent channels hash to nothing."""
    hashes = {topic.name: hashlib.sha256() for topic in TOPICS.values() if topic.data}
    for entry in read(path).entries:
        if entry.topic in hashes:
            hashes[entry.topic].update(struct.pack("<qQI", entry.log_time, entry.sequence, len(entry.data)))
            hashes[entry.topic].update(entry.data)
    return {name: value.hexdigest()[:32] for name, value in hashes.items()}
