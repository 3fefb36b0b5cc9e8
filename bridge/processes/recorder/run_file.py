"""One run as it is recorded: what belongs to it, in which order it is written, what was lost, what it came to.

The network is the caller's. A disk that refuses ends the writing, not the counting: what was written stays readable.
"""

import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from bridge.processes.recorder.order import Order
from bridge.processes.recorder.parts import Keeping, Parts
from bridge.processes.recorder.ring import Ring, Window
from bridge.processes.recorder.triggers import Triggers, topics_of
from bridge.recording.entries import Entries
from bridge.recording.reader import Recording, read
from bridge.recording.summarise import NEEDED, summarise
from bridge.recording.tally import Tally
from bridge.recording.writer import FLUSH_PERIOD
from bridge.scenario import Scenario, check
from bridge.scenario.channels import layout_of
from bridge.wire.codec import decode
from bridge.wire.messages import CHANNELS_TOPIC, GOING, SOURCED, TOPICS, EventKind, Mode
from bridge.wire.status import PUBLISHED, TURNED, counts, numbers_of
from controller.grid import NS

AHEAD = NS  # a command may overtake the measurement that it answers, not by more than this [ns]
MOST_KINDS = 100  # of what was turned away: a status may come from anybody
ORDERING = ("measurement", "command", "event", "said", "status")  # the recorder follows a run by these, recorded or not


class Arrival(NamedTuple):
    """A message as it came off the bus."""

    topic: str
    payload: bytes
    stamp: tuple[int, int] | None  # log time, sequence


class Request(NamedTuple):
    """What is to be recorded, and how."""

    keeping: Keeping = Keeping()
    window: Window | None = None  # None: everything; else only what is around triggers
    triggers: tuple[str, ...] = ()  # kinds of events
    conditions: tuple[str, ...] = ()  # "p2 > 60 bar": a signal goes past a limit
    metadata: tuple[tuple[str, str], ...] = ()  # the user's own

    def wants(self, topic: str) -> bool:
        """Is a topic to be recorded?"""
        return self.keeping.topics is None or topic in self.keeping.topics

    def follows(self, topic: str) -> bool:
        """Must a topic be heard, recorded or not?"""
        return self.wants(topic) or topic in ORDERING or topic in topics_of(self.conditions)


class RunFile:
    """One run being written. Raises OSError when its file cannot be made."""

    def __init__(self, path: Path, manifest: dict[str, Any], request: Request, number: int = 0) -> None:
        self.number = number
        self.request = request
        self.scenario: Scenario = check(manifest["scenario"], "the plant's scenario")
        self.run_id = int(manifest["run_id"])
        self.stamp = 0
        self.ended_at: float | None = None
        self.announced: set[str] = set()  # roles that have said how many messages they sent
        self.tally = Tally(from_start=manifest["tick"] == 0)
        self.rejected = 0
        self.turned: dict[str, int] = {}  # what processes say that they turned away, by process, kind and reason
        self.spoken: set[str] = set()  # topics of a controller that have come
        self.unstamped = 0  # messages of a controller without the stamp that ours attach
        self.mixed: list[str] = []  # what was said of a controller with another scenario, not yet told
        self.refusal: str | None = None  # of the disk
        self.unwritten: Counter[str] = Counter()  # messages per topic that came and are in no file
        self._ending: str | None = None  # the plant's own words, also where events are not recorded
        self._live = manifest["mode"] != Mode.LOCKSTEP  # a replay is, too
        self._flushed = time.monotonic_ns()
        self._order = Order(self.scenario.loop.grid())
        self._ring = Ring(request.window) if request.window else None
        head = {"run": manifest | {"recorded": time.strftime("%Y-%m-%dT%H:%M:%S%z")}}
        self._layout = layout_of(self.scenario)
        self._triggers = Triggers(request.triggers, request.conditions, self._layout)
        self._parts = Parts(path, self.scenario.rig_name, head | _own(request), request.keeping, self._layout)
        if self._ring is None:
            self._parts.open()

    @property
    def paths(self) -> list[Path]:
        """The files written so far."""
        return self._parts.paths

    def is_of_another_run(self, arrival: Arrival) -> bool:
        """A measurement of another run than this file's?"""
        if arrival.topic != "measurement":
            return False
        try:
            return decode(arrival.payload, "measurement").run_id != self.run_id
        except ValueError:
            return False

    def take(self, arrival: Arrival) -> None:
        """Write a message, or keep it until its place has come; what is not a message of this run is counted."""
        try:
            message = decode(arrival.payload, arrival.topic)
            log_time, sequence = self._place(arrival, message)
        except ValueError:
            self.rejected += 1
            return
        self._heed(arrival.topic, message, sequence)
        if self._live:
            self._write([(arrival.topic, log_time, sequence, arrival.payload)])
        else:
            self._write(self._order.add(arrival.topic, log_time, sequence, arrival.payload))

    def trigger(self, time_ns: int) -> None:
        """Keep what is around a moment; without a ring everything is kept anyway."""
        if self._ring is not None:
            self._ring.trigger(time_ns)

    def flush_by_time(self) -> None:
        """In real time chunks close by the wall clock."""
        if self._live and self.refusal is None and time.monotonic_ns() - self._flushed >= FLUSH_PERIOD:
            self._guarded(self._parts.flush)
            self._flushed = time.monotonic_ns()  # after it: a disk that is slow must leave time to write

    def close(self, facts: dict[str, Any]) -> None:
        """Write what waits, the summary and the index; `facts`: what the recorder says of itself."""
        self._write(self._order.rest())
        if self._ring is not None and self._ring.open:
            self._pass_on(self._ring.drain())
        if self.refusal is None:
            self._guarded(lambda: self._finish(facts))

    def losses(self) -> dict[str, int]:
        """Messages that were to be recorded and never came, per topic."""
        return {topic: count for topic, count in self.tally.losses().items() if self.request.wants(topic)}

    def _heed(self, topic: str, message: Any, sequence: int) -> None:
        if topic == "status":
            self._note_status(message)
        else:
            self.tally.add(topic, getattr(message, "source", 0) * (topic in SOURCED), sequence)
        if topic == "measurement":
            self.stamp = max(self.stamp, message.stamp)
        if topic == "event" and message.kind == EventKind.ENDED:
            self._ending = message.text
        if topic == "event" and message.kind == EventKind.DIFFERS:
            self.mixed.append(message.text)
        if self._ring is not None and self._triggers.heed(topic, message):
            self.trigger(message.stamp)

    def _write(self, messages: Iterable[tuple[str, int, int, bytes]]) -> None:
        wanted = (message for message in messages if self.request.wants(message[0]))
        if self._ring is None:
            self._pass_on(wanted)
            return
        for message in wanted:
            self._pass_on(self._ring.add(*message))
        if not self._ring.open and self._parts.writer is not None:
            self._guarded(lambda: self._finish({}))

    def _pass_on(self, messages: Iterable[tuple[str, int, int, bytes]]) -> None:
        for message in messages:
            if self.refusal is not None:
                self.unwritten[message[0]] += 1
            else:
                self._guarded(lambda message=message: self._put(message))

    def _put(self, message: tuple[str, int, int, bytes]) -> None:
        self._parts.write(*message)
        if not self._live:
            self._parts.flush_by(message[1])

    def _guarded(self, action: Any) -> None:
        """Do what may meet a disk that refuses; from then on messages are only counted."""
        try:
            action()
        except OSError as error:
            path, writer = self._parts.paths[-1], self._parts.writer
            kept = "what was written before stays readable"
            self.refusal = (
                f"{path}: {error.strerror}: nothing from about t = {self.stamp / NS:g} s on is recorded; {kept}"
            )
            if writer is not None:
                self.unwritten += writer.pending
                writer.give_up("refused", {"reason": str(error.strerror), "time": f"{self.stamp / NS:g} s"})

    def _finish(self, facts: dict[str, Any]) -> None:
        """End the file that is open: with what the whole run came to, or in a ring what its own part did."""
        if self._parts.writer is None:
            return
        self._parts.flush()
        paths = self._parts.paths[-1:] if self._ring is not None else self._parts.paths
        turned = self.turned | {f"recorder: {what}": n for what, n in facts.get("turned_away", {}).items()}
        summary = summarise(_joined([read(path, NEEDED, growing=True) for path in paths]), self.scenario, self.losses())
        ending = self._ending or ("complete in itself: the run went on" if self._ring is not None else summary.ending)
        writer = self._parts.open()
        writer.metadata("summary", summary._replace(ending=ending, rejected=self.rejected, turned=turned).plain())
        causes = [f"{cause.by} at {cause.time / NS:g} s" for cause in self._triggers.causes]
        facts |= {"triggered": causes} if causes else {}
        self._triggers.causes.clear()
        writer.metadata("recorder", facts | {"longest_flush": max(self._parts.longest, writer.sink.longest)})
        self._parts.close()

    def _place(self, arrival: Arrival, message: Any) -> tuple[int, int]:
        """Log time and sequence; a controller's come from its message itself, so that any can be recorded."""
        if arrival.topic == CHANNELS_TOPIC and len(message.values) != len(self._layout):
            raise ValueError("not the channels of this run")
        if arrival.topic in SOURCED:
            stamp = message.sample_stamp if arrival.topic == "command" else message.stamp
            if message.run_id != self.run_id or not 0 <= stamp <= self.stamp + AHEAD:
                raise ValueError("not of this run")
            self.spoken.add(arrival.topic)
            self.unstamped += arrival.stamp is None
            return stamp, message.sequence
        if arrival.topic != "status" and getattr(message, "run_id", self.run_id) != self.run_id:
            raise ValueError("not of this run")
        if arrival.stamp is None or arrival.stamp[0] < 0:
            raise ValueError("no stamp")
        return arrival.stamp

    def _note_status(self, status: Any) -> None:
        sent = counts(PUBLISHED, numbers_of(status))
        if sent:
            self.announced.add(status.role)
            self.tally.announce({name: n for name, n in sent.items() if self.request.wants(name) or name in ORDERING})
        if status.role in ("plant", "controller", "follower") and len(self.turned) < MOST_KINDS:
            turned = counts(TURNED, numbers_of(status))
            self.turned |= {f"{status.role}: {what}": number for what, number in turned.items()}
        if status.role == "plant" and status.phase not in GOING:
            self.ended_at = time.monotonic()


def _own(request: Request) -> dict[str, dict[str, Any]]:
    """What the file says of its own making, apart from the run."""
    own: dict[str, dict[str, Any]] = {"user": dict(request.metadata)} if request.metadata else {}
    if request.keeping.topics is not None:
        own["chosen"] = {"topics": sorted(request.keeping.topics), "of": list(TOPICS)}
    if request.window is not None:
        own["ring"] = {**request.window._asdict(), "triggers": [*request.triggers, *request.conditions]}
    return own


def _joined(parts: list[Recording]) -> Recording:
    counts: Counter[str] = Counter()
    for part in parts:
        counts.update(part.counts)
    entries = Entries(entry for part in parts for entry in part.entries)
    return parts[-1]._replace(entries=entries, counts=dict(counts))
