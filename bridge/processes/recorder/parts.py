"""The files of one run: one, or several where it is split by size or time, each whole in itself."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bridge.recording.writer import RecordingWriter
from bridge.wire.channels import Layout


class Keeping(NamedTuple):
    """How a recording is kept."""

    topics: frozenset[str] | None = None  # None: all
    split_size: int | None = None  # bytes
    split_time: int | None = None  # [ns] of simulated time
    fsync: bool = False


class Parts:
    """Writes to `path`, then to `path` with -part2 and so on."""

    def __init__(
        self, path: Path, rig_name: str, head: Mapping[str, Mapping[str, Any]], keeping: Keeping, channels: Layout
    ) -> None:
        """head: facts for each file; channels: the further ones of the run."""
        self.paths: list[Path] = []
        self.writer: RecordingWriter | None = None
        self.longest = 0.0  # seconds that a flush took
        self._path = path
        self._rig_name = rig_name
        self._head = head
        self._keeping = keeping
        self._layout = channels

    def open(self) -> RecordingWriter:
        """The file now written to, opened if there is none."""
        if self.writer is None:
            number = len(self.paths) + 1
            path = self._path if number == 1 else self._path.with_stem(f"{self._path.stem}-part{number}")
            self.paths.append(path)
            topics, fsync = self._keeping.topics, self._keeping.fsync
            self.writer = RecordingWriter(path, self._rig_name, topics, fsync, self._layout)
            for name, values in self._head.items():
                self.writer.metadata(name, values)
            if number > 1:
                self.writer.metadata("part", {"number": number, "after": self.paths[-2].name})
            self.writer.flush()
        return self.writer

    def write(self, topic: str, log_time: int, sequence: int, payload: bytes) -> None:
        """Append one message, in the next file if this one is full."""
        if self.writer is not None and self._full(self.writer, log_time):
            self.cut()
        self.open().write(topic, log_time, sequence, payload)

    def flush_by(self, now: int) -> None:
        """Close and flush the chunk if its time [ns] has come."""
        if self.writer is not None:
            self.writer.flush_by(now)

    def flush(self) -> None:
        """Close the chunk and hand everything to the operating system."""
        if self.writer is not None:
            self.writer.flush()

    def cut(self) -> None:
        """End this file; the run continues in the next one."""
        if self.writer is not None:
            following = self._path.with_stem(f"{self._path.stem}-part{len(self.paths) + 1}").name
            self.writer.metadata("part_end", {"number": len(self.paths), "next": following})
            self.close()

    def close(self) -> None:
        """End the last file."""
        if self.writer is not None:
            self.writer.close()
            self.longest = max(self.longest, self.writer.sink.longest)
            self.writer = None

    def _full(self, writer: RecordingWriter, log_time: int) -> bool:
        keeping = self._keeping
        if keeping.split_time is not None and writer.span and log_time - writer.span[0] >= keeping.split_time:
            return True
        return keeping.split_size is not None and writer.sink.whole >= keeping.split_size
