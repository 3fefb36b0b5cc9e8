"""Write a run to MCAP: ROS 2 profile, CDR payloads, chunks closed and flushed by time.

`kill -9` loses at most what came since the last flush; nothing already on disk is ever rewritten.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mcap.writer import CompressionType, Writer

from bridge.messages import TOPICS, definition, type_hash
from controller.sampling import NS

CHUNK = 8 * 1024 * 1024  # bytes; flushing by time closes them long before
FLUSH_PERIOD = NS // 4
QOS = """\
- history: 3
  depth: 0
  reliability: 1
  durability: 2
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
"""


class RecordingWriter:
    """One file of one run."""

    def __init__(self, path: Path, rig_name: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.rig_name = rig_name
        self._file = path.open("wb")
        self._writer = Writer(self._file, chunk_size=CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="hydrotwin")
        self._channels = {topic.name: self._register(topic.name) for topic in TOPICS.values()}
        self._flushed = 0

    def write(self, topic: str, log_time: int, sequence: int, payload: bytes) -> None:
        """Append one message."""
        self._writer.add_message(
            channel_id=self._channels[topic],
            log_time=log_time,
            publish_time=log_time,
            sequence=sequence & 0xFFFFFFFF,
            data=payload,
        )

    def metadata(self, name: str, values: Mapping[str, Any]) -> None:
        """Add a named record of facts about the run; values that are no text are written as JSON."""
        texts = {key: value if isinstance(value, str) else json.dumps(value) for key, value in values.items()}
        self._writer.add_metadata(name, texts)

    def flush_by(self, now: int) -> None:
        """Close and flush the chunk if its time [ns] has come."""
        if now - self._flushed >= FLUSH_PERIOD:
            self._flushed = now
            self.flush()

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system."""
        self._writer.flush()
        self._file.flush()

    def close(self) -> None:
        """Write summary and index."""
        self._writer.finish()
        self._file.close()

    def _register(self, name: str) -> int:
        kind = TOPICS[name].type
        text = definition(kind).encode()
        schema = self._writer.register_schema(name=kind, encoding="ros2msg", data=text)
        return self._writer.register_channel(
            topic=f"{self.rig_name}/{name}",
            message_encoding="cdr",
            schema_id=schema,
            metadata={"offered_qos_profiles": QOS, "topic_type_hash": type_hash(kind)},
        )
