"""`hydrotwin replay FILE`: the messages of a recording on the bus again, with their own timing."""

import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import zenoh

from bridge.errors import RunError, UsageError
from bridge.machine.process import Stop, prepare
from bridge.recording.choice import choose
from bridge.recording.entries import Entry
from bridge.recording.reader import Recording, read
from bridge.replay.keyboard import keyboard
from bridge.replay.keys import live_publishers, remapped
from bridge.replay.player import Player
from bridge.replay.remote import heeding
from bridge.replay.timeline import Timeline
from bridge.wire.bus import STAMP, Bus
from bridge.wire.link import Link
from bridge.wire.messages import Phase


class Playing(NamedTuple):
    """How a recording is played."""

    speed: float = 1.0  # infinite: as fast as it goes
    loop: bool = False
    start: int | None = None  # [ns] of recorded time
    end: int | None = None
    topics: Sequence[str] | None = None
    without: Sequence[str] | None = None
    remap: Sequence[str] = ()
    paused: bool = False
    force: bool = False  # speak on keys with a live publisher, too
    wait: float = 0.0  # seconds for somebody to listen before it begins


def replay(path: Path, link: Link, playing: Playing) -> dict[str, Any]:
    """Play a recording; its last status. Raises UsageError, LinkError, or RunError where somebody else speaks."""
    recording = read(path)
    entries = selected(recording, playing)
    keys = remapped(_keys(recording, {entry.topic for entry in entries}), playing.remap)
    rig = _rig(recording, playing)
    prepare()
    with Bus(link, rig, "replay", blocking=True) as bus:
        others = live_publishers(bus, keys) if not playing.force else []
        if others:
            raise RunError(
                f"{' and '.join(others)} is live on the keys of this replay: stop it, choose other keys with --remap, "
                "or say --force"
            )
        stop = Stop().listen()
        sender = Sender(bus.session, recording, entries, keys)
        timeline = Timeline([entry.log_time for entry in entries], 0, playing.speed, playing.loop)
        player = Player(timeline, sender.send)
        held = _stand_in(bus, recording, keys)
        with heeding(bus, rig, player):
            sender.await_listeners(playing.wait, stop)
            timeline.paused = playing.paused
            timeline.seek(timeline.times[0], time.monotonic_ns())
            with keyboard(player):
                player.run(stop)
        _take_leave(bus, recording)
        del held
        return player.status()


def selected(recording: Recording, playing: Playing) -> list[Entry]:
    """What is to be played, in the order of time; what has the same stamp stays in the order of the file."""
    topics = choose(list(recording.counts), playing.topics, playing.without)
    begin = 0 if playing.start is None else playing.start
    end = math.inf if playing.end is None else playing.end
    found = [entry for entry in recording.entries if entry.topic in topics and begin <= entry.log_time <= end]
    if not found:
        raise UsageError(f"{recording.path}: nothing in it between those times")
    return sorted(found, key=lambda entry: entry.log_time)


class Sender:
    """Puts entries on the bus."""

    def __init__(self, session: Any, recording: Recording, entries: list[Entry], keys: dict[str, str]) -> None:
        self._publishers = {topic: _publisher(session, recording, topic, key) for topic, key in keys.items()}
        self._puts = {topic: publisher.put for topic, publisher in self._publishers.items()}
        self._entries = entries

    def send(self, indices: range) -> None:
        """Publish some of the entries."""
        puts, pack = self._puts, STAMP.pack
        for topic, log_time, sequence, data in self._entries[indices.start : indices.stop]:
            puts[topic](data, attachment=pack(log_time, sequence))

    def await_listeners(self, patience: float, stop: Stop) -> None:
        """Wait until somebody listens to any of it."""
        until = time.monotonic() + patience
        while time.monotonic() < until and not stop():
            if any(publisher.matching_status.matching for publisher in self._publishers.values()):
                return
            time.sleep(0.01)


def _publisher(session: Any, recording: Recording, topic: str, key: str) -> Any:
    facts = recording.channels[topic]
    return session.declare_publisher(
        key,
        encoding=f"application/{facts.encoding};{facts.type}",
        congestion_control=zenoh.CongestionControl.BLOCK,
        reliability=zenoh.Reliability.RELIABLE,
    )


def _keys(recording: Recording, topics: set[str]) -> dict[str, str]:
    return {topic: recording.channels[topic].key.strip("/") for topic in sorted(topics)}


def _rig(recording: Recording, playing: Playing) -> str:
    """The rig's name, remapped where it is as a whole."""
    name = recording.metadata.get("run", {}).get("scenario", {}).get("rig_name", "rig")
    for rule in playing.remap:
        old, _, new = rule.partition(":=")
        name = new if old == name else name
    return name


def _take_leave(bus: Bus, recording: Recording) -> None:
    """Say that nothing more comes, behind all that was sent: reliable, blocking, and of the same priority."""
    run_id = int(recording.metadata.get("run", {}).get("run_id", 0))
    bus.publish_status(run_id, recording.entries[-1].log_time, Phase.ENDED, {}, final=True)


def _stand_in(bus: Bus, recording: Recording, keys: dict[str, str]) -> list[Any]:
    """Recorders and viewers find a plant's manifest, and that a plant is there, where a replay has its measurements."""
    bus.announce()
    if "run" not in recording.metadata or "measurement" not in keys:
        return []
    manifest = json.dumps(recording.metadata["run"] | {"mode": "replay", "tick": 1, "replay_of": recording.path.name})
    bus.answer("scenario", manifest.encode)
    return [bus.session.liveliness().declare_token(f"{bus.rig_name}/alive/plant/replay")]
