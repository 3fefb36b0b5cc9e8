"""What a sweep has found so far, on disk: one line per point, so that an interrupted sweep continues where it was.

The first line says which sweep it is. A line that was cut off in writing is dropped and its point computed again.
"""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bridge.errors import UsageError, writing

Point = Mapping[str, Any]  # plain data
Result = Mapping[str, Any]


def key_of(point: Point) -> str:
    """A point's name: its data, written one way only."""
    return json.dumps(point, sort_keys=True)


class Journal:
    """Results of one sweep, appended as they come."""

    def __init__(self, path: Path, head: Mapping[str, Any]) -> None:
        self.path, self._head = path, json.dumps({"sweep": head}, sort_keys=True)
        self.found: dict[str, Result] = {}
        with writing(path):
            self._read()

    def _read(self) -> None:
        whole = self.path.read_bytes() if self.path.is_file() else b""
        kept = whole[: whole.rfind(b"\n") + 1]
        lines = kept.decode(errors="replace").splitlines()
        if lines and lines[0] != self._head:
            raise UsageError(
                f"{self.path} holds what another sweep has found so far, or one of other sources; "
                "remove it to start again, or choose another output"
            )
        self.found = {entry["point"]: entry["result"] for entry in map(json.loads, lines[1:])}
        if kept != whole or not lines:
            self.path.write_bytes(kept or f"{self._head}\n".encode())

    def add(self, point: Point, result: Result) -> None:
        """Keep a result; it is on disk when this returns."""
        line = json.dumps({"point": key_of(point), "result": result})
        with writing(self.path), self.path.open("a", encoding="utf-8") as file:
            file.write(f"{line}\n")
            file.flush()
            os.fsync(file.fileno())
        self.found[key_of(point)] = json.loads(line)["result"]

    def remove(self) -> None:
        """The sweep is whole: its result is somewhere else."""
        self.path.unlink(missing_ok=True)
