"""The recorder as a process: everything on a rig's keys into an MCAP file, losses counted."""

import json
import os
import queue
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from bridge.bus import Bus, stamp_of
from bridge.clock import Stop
from bridge.failure import RunError
from bridge.link import Link
from bridge.messages import TOPICS, decode
from bridge.recording.order import Order
from bridge.recording.reader import read
from bridge.recording.tally import Tally
from bridge.recording.writer import RecordingWriter
from bridge.scenario import Scenario, check
from bridge.summary import NEEDED, summarise
from controller.sampling import NS

AHEAD = NS  # a command may overtake the measurement that it answers, not by more than this [ns]
DRAIN_PERIOD = 0.02  # seconds; waking for every message would take the loop's processors
SOURCED = ("command", "reference")  # topics on which several sources may speak
YIELDING = 5  # niceness: the loop's own processes come first
PATIENCE = 3.0  # seconds for what was announced to arrive, after the plant's end


class Arrival(NamedTuple):
    """A message as it came off the bus."""

    topic: str
    payload: bytes
    stamp: tuple[int, int] | None  # log time, sequence


class RecorderProcess:
    """Records one run after the other; a new run id starts a new file."""

    def __init__(self, bus: Bus, path: Path, patience: float, stop: Stop) -> None:
        self.bus = bus
        self.patience = patience
        self.path = path
        self.stop = stop
        self._inbox: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
        for topic in TOPICS:
            bus.subscribe(topic, lambda sample, topic=topic: self._inbox.put((topic, sample)))
        bus.watch()

    def run(self) -> Path:
        """Record until the plant has ended or is gone. Raises RunError when no plant answers."""
        file = OpenFile(self.path, self._manifest())
        self.bus.announce()
        while not self.stop() and not self._over(file):
            time.sleep(DRAIN_PERIOD)
            for arrival in self._arrived():
                if file.is_of_another_run(arrival):
                    file = self._next_file(file)
                file.take(arrival)
            file.flush_by_time()
        file.close()
        lost = float(sum(file.tally.losses().values()))
        self.bus.publish_status(file.run_id, file.stamp, "ended", {"lost": lost}, final=True)
        return file.path

    def _manifest(self) -> dict[str, Any]:
        answer = self.bus.ask("scenario", self.patience, self.stop)
        if answer is None:
            raise RunError(
                f"no plant of rig {self.bus.rig_name!r} answers: start one first, or name the rig with --rig"
            )
        return json.loads(answer)

    def _next_file(self, file: "OpenFile") -> "OpenFile":
        """A new file if the plant says that it has begun a new run; else it was somebody's noise."""
        manifest = self._manifest()
        if int(manifest["run_id"]) == file.run_id:
            return file
        file.close()
        path = self.path.with_stem(f"{self.path.stem}-{file.number + 1}")
        return OpenFile(path, manifest, file.number + 1)

    def _arrived(self) -> Iterator[Arrival]:
        while not self._inbox.empty():
            topic, sample = self._inbox.get()
            yield Arrival(topic, sample.payload.to_bytes(), stamp_of(sample))

    def _over(self, file: "OpenFile") -> bool:
        if file.ended_at is None:
            return not self.bus.present.get("plant", {"?"}) and self._inbox.empty()
        expected = {"plant"} | ({"controller"} & set(self.bus.present))
        settled = expected <= file.announced and not file.tally.losses()
        return settled or time.monotonic() - file.ended_at > PATIENCE


class OpenFile:
    """One run being written."""

    def __init__(self, path: Path, manifest: dict[str, Any], number: int = 0) -> None:
        self.path = path
        self.number = number
        self.scenario: Scenario = check(manifest["scenario"], "the plant's scenario")
        self.run_id = int(manifest["run_id"])
        self.stamp = 0
        self.ended_at: float | None = None
        self.announced: set[str] = set()  # roles that have said how many messages they sent
        self.tally = Tally(from_start=manifest["tick"] == 0)
        self.rejected = 0
        self._live = manifest["mode"] == "realtime"
        self._writer = RecordingWriter(path, self.scenario.rig_name)
        self._writer.metadata("run", manifest | {"recorded": time.strftime("%Y-%m-%dT%H:%M:%S%z")})
        self._writer.flush()
        self._order = Order(self.scenario.loop.grid())

    def is_of_another_run(self, arrival: Arrival) -> bool:
        """A measurement of another run than this file's?"""
        if arrival.topic != "measurement":
            return False
        try:
            return decode(arrival.payload, "measurement").run_id != self.run_id
        except ValueError:
            return False

    def take(self, arrival: Arrival) -> None:
        """Write a message, or keep it until its place has come; what is no message of this run is counted."""
        try:
            message = decode(arrival.payload, arrival.topic)
            log_time, sequence = self._place(arrival, message)
        except ValueError:
            self.rejected += 1
            return
        if arrival.topic != "status":
            self.tally.add(arrival.topic, getattr(message, "source", 0) * (arrival.topic in SOURCED), sequence)
        if arrival.topic == "measurement":
            self.stamp = max(self.stamp, message.stamp)
        if arrival.topic == "status":
            self._note_status(message)
        if self._live:
            self._writer.write(arrival.topic, log_time, sequence, arrival.payload)
            return
        for ready_topic, ready_time, ready_sequence, payload in self._ordered(arrival, log_time, sequence):
            self._writer.write(ready_topic, ready_time, ready_sequence, payload)
            self._writer.flush_by(ready_time)

    def flush_by_time(self) -> None:
        """In real time chunks close by the wall clock."""
        if self._live:
            self._writer.flush_by(time.monotonic_ns())

    def close(self) -> None:
        """Write what waits, the summary and the index."""
        for topic, log_time, sequence, payload in self._order.rest():
            self._writer.write(topic, log_time, sequence, payload)
        self._writer.flush()
        summary = summarise(read(self.path, NEEDED), self.scenario, self.tally.losses())
        self._writer.metadata("summary", summary | {"rejected": self.rejected})
        self._writer.close()

    def _ordered(self, arrival: Arrival, log_time: int, sequence: int):
        return self._order.add(arrival.topic, log_time, sequence, arrival.payload)

    def _place(self, arrival: Arrival, message: Any) -> tuple[int, int]:
        """Log time and sequence; a command's come from itself, so that any controller's can be recorded."""
        if arrival.topic == "command":
            if message.run_id != self.run_id or not 0 <= message.sample_stamp <= self.stamp + AHEAD:
                raise ValueError("not a command of this run")
            return message.sample_stamp, message.sequence
        if arrival.topic != "status" and getattr(message, "run_id", self.run_id) != self.run_id:
            raise ValueError("not of this run")
        if arrival.stamp is None or arrival.stamp[0] < 0:
            raise ValueError("no stamp")
        return arrival.stamp

    def _note_status(self, status: Any) -> None:
        counts = {
            name.removeprefix("published/"): round(value)
            for name, value in zip(status.names, status.values, strict=True)
            if name.startswith("published/")
        }
        if counts:
            self.announced.add(status.role)
            self.tally.announce(counts)
        if status.role == "plant" and status.phase not in ("running", "safe"):
            self.ended_at = time.monotonic()


def run_recorder(path: Path, rig_name: str, link: Link, blocking: bool) -> Path:
    """Record a rig until its plant ends; returns the last file. Raises RunError or LinkError with one line."""
    stop = Stop()
    os.nice(YIELDING)
    with Bus(link, rig_name, "recorder", blocking=blocking) as bus:
        return RecorderProcess(bus, path, link.patience, stop).run()
