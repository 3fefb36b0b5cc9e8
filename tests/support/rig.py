"""A plant in the test's own process: it publishes a run, and answers as a plant does."""

import json
import time
from collections import Counter
from typing import Any

from bridge.loop.exchange import exchange, sides
from bridge.processes.orders import answer_to
from bridge.processes.parameters import listed, set_by
from bridge.recording.manifest import manifest
from bridge.scenario import load
from bridge.wire.bus import Bus
from bridge.wire.codec import encode
from bridge.wire.link import Link

MS = 1_000_000  # [ns]
SCENARIO = load("step", ["duration=0.2", 'daq.channels=["force"]'])


class Rig:
    """A plant in this process: the messages of a run in process, and the answers of a plant's own code."""

    def __init__(self, address: str) -> None:
        self.plant, controller = sides(SCENARIO)
        self.bus = Bus(Link(address, None, None, 5.0), "rig", "plant", blocking=True)
        self.bus.speak_as("controller")
        self.resets: list[bytes] = []
        self.sent: Counter[str] = Counter()
        self.last: dict[str, Any] = {}
        told = json.dumps(manifest(SCENARIO, self.plant.run_id) | {"tick": 0})
        self.bus.answer("scenario", told.encode)
        self.bus.serve("parameters", lambda payload: listed(self.plant, payload))
        self.bus.serve("parameters/set", self._set)
        self.bus.session.declare_subscriber("rig/reset", lambda sample: self.resets.append(sample.payload.to_bytes()))
        self._ticks = exchange(self.plant, controller, SCENARIO.ticks)

    def advance(self, ticks: int) -> None:
        """Publish some ticks of the run, and what has happened meanwhile."""
        for _, tick in zip(range(ticks), self._ticks, strict=False):
            for message in tick:
                self.bus.publish(message, encode(message.message))
                self.sent[message.topic] += 1
                self.last[message.topic] = message.message
            time.sleep(0.0005)

    def _set(self, payload: bytes) -> bytes:
        return answer_to(payload, lambda asked: set_by(asked, SCENARIO), lambda order: order.take(self.plant))
