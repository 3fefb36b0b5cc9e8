"""Recorded measurements into a controller: which of them it got, and the controller as a process fed with those."""

import json
import queue
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from bridge.errors import RunError, UsageError
from bridge.loop.controller import ControllerSide
from bridge.machine.children import guarded
from bridge.processes.child import Child
from bridge.recording.entries import Entries, Entry
from bridge.recording.reader import Recording
from bridge.replay.stamps import stamp_in
from bridge.scenario import Scenario
from bridge.scenario.channels import layout_of
from bridge.wire.bus import Bus
from bridge.wire.codec import decode
from bridge.wire.messages import CHANNELS_TOPIC, SOURCED, Mode, Outgoing, Phase
from bridge.wire.status import PlantStatus
from controller.grid import is_sample

ORDER = {
    "state": 0,
    CHANNELS_TOPIC: 0,
    "measurement": 1,
    "event": 2,
}  # of what belongs to one instant, as a controller gets it
PATIENCE = 10.0  # seconds for an answer
STARTUP = 60.0  # seconds for the controller to appear


def owner(recording: Recording) -> int:
    """The source of most commands: that of the controller to be replayed."""
    sources = Counter(command.source for command in recording.messages("command"))
    if not sources:
        raise UsageError(f"{recording.path}: no command in it to compare with")
    return sources.most_common(1)[0][0]


def only(recording: Recording, source: int) -> Recording:
    """The recording without what other controllers said."""
    kept = [e for e in recording.entries if e.topic not in SOURCED or _source(e) == source]
    return recording._replace(entries=Entries(kept), counts=recording.counts | dict(Counter(e.topic for e in kept)))


def _source(entry: Entry) -> int:
    return decode(entry.data, entry.topic).source


def heard(recording: Recording, scenario: Scenario) -> list[Entry]:
    """The measurements that the controller answered, or may have, and the events of the plant, in their order.

    Before each measurement what else the scenario's law needs of its instant. Raises UsageError where that is missing.

    It counts its answers, so no measurement can hide.

    A sample without a command was heard if a number is missing there: then its answer got lost on the way to the file.
    """
    grid, further = scenario.loop.grid(), needed(recording, scenario)
    sequences = {command.sample_stamp: command.sequence for command in recording.messages("command")}
    entries = sorted(recording.of("measurement"), key=lambda entry: (entry.log_time, entry.sequence))
    fed, open_samples, last, newest = [], [], -1, -1
    for entry, stamp in ((entry, stamp_in(entry)) for entry in entries):
        if not is_sample(stamp, grid) or stamp <= newest:
            continue
        newest = stamp
        if stamp not in sequences:
            open_samples.append(entry)
            continue
        missing = sequences[stamp] - last - 1
        fed += open_samples[len(open_samples) - missing :] if 0 < missing <= len(open_samples) else []
        fed.append(entry)
        open_samples, last = [], sequences[stamp]
    instants = {entry.log_time for entry in fed}
    seen = [entry for topic in further for entry in recording.of(topic) if entry.log_time in instants]
    return sorted([*seen, *fed, *recording.of("event")], key=lambda entry: (entry.log_time, ORDER[entry.topic]))


def needed(recording: Recording, scenario: Scenario) -> list[str]:
    """The topics that the law needs with each measurement. Raises UsageError where the recording lacks its channels."""
    topics = ["state"] if scenario.controller.sees_truth else []
    wanted = layout_of(scenario) if scenario.controller.reads_channels else ()
    if not wanted:
        return topics
    names, there = ([field.name for field in layout] for layout in (wanted, recording.layout()))
    if names != there:
        raise UsageError(
            f"{recording.path}: its further channels are {', '.join(there) or 'none'}, the scenario's "
            f"{', '.join(names)}: give --set daq.channels='{json.dumps(there)}', or record with those of the scenario"
        )
    return [*topics, CHANNELS_TOPIC]


def through_side(entries: list[Entry], side: ControllerSide) -> Iterator[list[Outgoing]]:
    """The answers of the control law to measurements, without processes; it heeds the plant's events between them."""
    for entry in entries:
        if entry.topic == "state":
            side.see(decode(entry.data, "state"))
        elif entry.topic == CHANNELS_TOPIC:
            side.hear(decode(entry.data, CHANNELS_TOPIC))
        elif entry.topic == "event":
            yield side.heed(decode(entry.data, "event"))
        else:
            yield side.answer(decode(entry.data, "measurement"))


def _outgoing(topic: str, payload: bytes) -> Outgoing:
    message = decode(payload, topic)
    return Outgoing(topic, message.sample_stamp if topic == "command" else message.stamp, message.sequence, message)


class FedController:
    """A controller process of ours, alone with a stand-in for its plant. Use as a context manager."""

    def __init__(self, bus: Bus, endpoint: str, scenario: Scenario, source: int) -> None:
        self._bus = bus
        self._ending = ExitStack()
        self._answers: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        folder = Path(self._ending.enter_context(tempfile.TemporaryDirectory(prefix="hydrotwin-")))
        file = folder / "scenario.json"
        file.write_text(scenario.model_dump_json(), encoding="utf-8")
        for topic in SOURCED:
            bus.subscribe(topic, lambda sample, topic=topic: self._answers.put((topic, sample.payload.to_bytes())))
        bus.watch()
        bus.announce()
        arguments = [str(file), "--mode", Mode.LOCKSTEP, "--connect", endpoint, "--source", str(source)]
        self._child = Child("controller", arguments, folder, self._ending.enter_context(guarded()))
        self._ending.callback(self._child.end)

    def __enter__(self) -> "FedController":
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.close()

    def answers(self, entries: list[Entry]) -> Iterator[list[Outgoing]]:
        """Publish one measurement after the other, each when the last one is answered. Raises RunError."""
        self._bus.await_roles(("controller",), STARTUP, self._child.ended)
        last: Any = None
        for entry in entries:
            if entry.topic != "measurement":
                message = decode(entry.data, entry.topic)
                self._bus.publish(Outgoing(entry.topic, entry.log_time, entry.sequence, message), entry.data)
                continue
            last = decode(entry.data, "measurement")
            self._bus.publish(Outgoing("measurement", entry.log_time, entry.sequence, last), entry.data)
            yield list(self._said_to(entry.log_time))
        if last is not None:
            self._bus.publish_status(
                last.run_id, last.stamp, Phase.ENDED, PlantStatus(last.tick, last.tick).plain(), final=True
            )
            self._finish()
            yield list(self._rest())

    def _said_to(self, stamp: int) -> Iterator[Outgoing]:
        """What the controller says to a measurement; the reference is the last of it."""
        while (message := self._await(stamp)).topic != "reference":
            yield message
        yield message

    def _rest(self) -> Iterator[Outgoing]:
        """What it has said to the plant's events after the last measurement."""
        while not self._answers.empty():
            yield _outgoing(*self._answers.get())

    def _await(self, stamp: int) -> Outgoing:
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            try:
                came, payload = self._answers.get(timeout=0.1)
            except queue.Empty:
                if fault := self._child.fault():
                    raise RunError(fault) from None
                continue
            return _outgoing(came, payload)
        raise RunError(f"the controller has not answered the measurement at t = {stamp / 1e9:g} s in {PATIENCE:g} s")

    def _finish(self) -> None:
        try:
            self._child.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            raise RunError("the controller did not finish") from None
