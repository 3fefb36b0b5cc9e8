"""The controller as a process: measurements off the bus, through the law, commands on the bus."""

import queue
import time
from typing import Any

from bridge.bus import Bus
from bridge.clock import Stop, prepare
from bridge.controller_side import ControllerSide
from bridge.link import Link
from bridge.messages import decode
from bridge.plant_process import Failure
from bridge.scenario import Scenario

FAREWELL = 2.0  # seconds after the plant's end in which its last measurements may still come


class ControllerProcess:
    """One controller of one rig, for as long as its plant runs."""

    def __init__(self, bus: Bus, side: ControllerSide, stop: Stop) -> None:
        self.bus = bus
        self.side = side
        self.stop = stop
        self._inbox: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        self._run_id = 0
        self._stamp = 0
        self._tick = -1
        self._last_tick: int | None = None  # of the plant, once it has said so
        self._deadline = float("inf")
        for topic in ("measurement", "event", "status"):
            bus.subscribe(topic, lambda payload, kind, stamp, topic=topic: self._inbox.put((topic, payload)))
        bus.watch()
        bus.announce()

    def run(self) -> None:
        """Answer until the plant has ended or is gone. Raises Failure when the plant refuses this controller."""
        while not self.stop() and not self._finished():
            try:
                topic, payload = self._inbox.get(timeout=0.1)
            except queue.Empty:
                continue
            self._handle(topic, payload)
        counts = {f"published/{topic}": float(count) for topic, count in self.side.published.items()}
        self.bus.publish_status(self._run_id, self._stamp, "ended", counts | {"source": 0.0})

    def _handle(self, topic: str, payload: bytes) -> None:
        try:
            message = decode(payload, topic)
        except ValueError:
            return  # somebody else's noise on our keys; the plant counts what concerns it
        if topic == "measurement":
            self._answer(message)
        elif topic == "event":
            self._heed(message)
        elif message.role == "plant" and message.phase not in ("running", "safe", "waiting"):
            self._last_tick = round(dict(zip(message.names, message.values, strict=True))["tick"])
            self._deadline = time.monotonic() + FAREWELL

    def _answer(self, measurement: Any) -> None:
        self._run_id, self._stamp, self._tick = measurement.run_id, measurement.stamp, measurement.tick
        for message in self.side.answer(measurement):
            self.bus.publish(message)

    def _heed(self, event: Any) -> None:
        if event.kind == "refused" and event.source == self.side.source and event.text.startswith("second controller"):
            raise Failure(f"the plant refuses this controller: {event.text}")

    def _finished(self) -> bool:
        if self._last_tick is not None:
            return self._tick >= self._last_tick or time.monotonic() > self._deadline
        return self._tick >= 0 and not self.bus.present.get("plant", {"?"})


def run_controller(scenario: Scenario, link: Link, mode: str, source: int, fifo: bool) -> None:
    """Run a controller until its plant ends. Raises Failure, LinkError or ScenarioError with one line for people."""
    stop = Stop()
    side = ControllerSide(scenario, source)
    prepare(fifo)
    with Bus(link, scenario.rig_name, "controller", blocking=mode == "lockstep") as bus:
        ControllerProcess(bus, side, stop).run()
