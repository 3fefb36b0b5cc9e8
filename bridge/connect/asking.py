"""What other tools ask of a rig on behalf of their users: its run, its parameters, orders, a replay's controls."""

import json
from collections.abc import Callable
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.recording.manifest import told_by
from bridge.wire.bus import Bus

PATIENCE = 3.0  # seconds for an answer; the plant itself gives its loop 2
EMPTY = b"\x00\x01\x00\x00\x00"  # std_msgs/msg/Empty in CDR


class Asking:
    """Questions to one rig."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus

    def run(self, patience: float = PATIENCE, stopped: Callable[[], bool] = lambda: False) -> dict[str, Any] | None:
        """What the plant says of its run; None where none answers in so many seconds, or somebody stops us."""
        answer = self._bus.ask("scenario", patience, stopped)
        return None if answer is None else told_by(answer, self._bus.rig_name)

    def parameters(self) -> list[dict[str, Any]]:
        """All numbers that can change, with values, units and limits; none of a rig that has no such."""
        answer = self._bus.request("parameters", b"", PATIENCE)
        return [] if answer is None else json.loads(answer).get("parameters", [])

    def order(self, name: str, wanted: dict[str, Any]) -> dict[str, Any]:
        """What the plant answers to an order. Raises UsageError for what it refuses, RunError where it is silent."""
        answer = self._bus.request(name, json.dumps(wanted).encode(), PATIENCE)
        if answer is None:
            raise RunError(f"no plant of rig {self._bus.rig_name!r} answers; access control may keep the order from it")
        found = json.loads(answer)
        if "refused" in found:
            raise UsageError(found["refused"])
        return found

    def reset(self) -> None:
        """Tell the plant to leave its safe state."""
        self._bus.session.put(f"{self._bus.rig_name}/reset", EMPTY)

    def save(self) -> str:
        """Trigger a recorder that keeps a ring; what it says."""
        answer = self._bus.request("recorder/save", b"", PATIENCE)
        return "no recorder answers" if answer is None else answer.decode(errors="replace")

    def replay(self, verb: str, value: str = "") -> dict[str, Any] | None:
        """Where a replay stands after it has done something; None where none answers, or it cannot do that."""
        answer = self._bus.request(f"replay/{verb}", value.encode(), PATIENCE)
        found = None if answer is None else json.loads(answer)
        return None if found is None or "error" in found else found
