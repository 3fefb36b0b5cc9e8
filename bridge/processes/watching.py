"""The newest of a rig's signals, for people who watch it."""

from typing import Any

from bridge.wire.bus import Bus
from bridge.wire.codec import decode, ready
from bridge.wire.messages import GOING
from controller.grid import NS
from twin.topology import PRESSURES


class Watching:
    """What a rig on the bus does now, in units that people read."""

    def __init__(self, bus: Bus) -> None:
        self.ended = False
        self._latest: dict[str, Any] = {}
        for topic in ("measurement", "reference", "command", "status"):
            ready(topic)
            bus.subscribe(topic, lambda sample, topic=topic: self._take(topic, sample.payload.to_bytes()))

    def row(self) -> dict[str, float]:
        """Names with units, and values; empty before the first measurement."""
        if (m := self._latest.get("measurement")) is None:
            return {}
        reference, command = self._latest.get("reference"), self._latest.get("command")
        return {
            "t [s]": m.stamp / NS,
            "x [mm]": 1e3 * m.position,
            "x_ref [mm]": float("nan") if reference is None else 1e3 * reference.position,
            **{f"{name} [bar]": 1e-5 * getattr(m, name) for name in PRESSURES},
            "spool [%]": float("nan") if command is None else 100.0 * command.spool,
        }

    def _take(self, topic: str, payload: bytes) -> None:
        try:
            message = decode(payload, topic)
        except ValueError:
            return
        if topic == "status":
            self.ended = self.ended or (message.role == "plant" and message.phase not in GOING)
        else:
            self._latest[topic] = message
