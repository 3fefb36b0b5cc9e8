"""Replay: how true to its timing, and how fast beside a bare loop that reads a file and puts its messages."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import zenoh
from mcap.reader import make_reader

from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.link import Link, free_endpoint, open_session
from tests.benchmarks.plant import Row

SECONDS = 10
QUANTILES = (50.0, 99.0, 99.9, 100.0)
TURNS = 3


def rows(folder: Path) -> Iterator[Row]:
    """Seen by a subscriber in another process; both speeds with one subscriber to everything that counts."""
    path = record_in_process(load("step", [f"duration={SECONDS}"]), folder / "a.mcap").path
    wall, stamps = _heard(path, "measurement", "1")
    errors = np.abs(np.diff(wall) - np.diff(stamps)) * 1e-3
    found = " / ".join(f"{np.percentile(errors, q):.0f}" for q in QUANTILES)
    yield "replay at 1x, error: p50 / p99 / p99.9 / max", f"{found} us", "goal 1000 us", ""
    ours, bare = (min(_seconds(path, send) for _ in range(TURNS)) for send in (_replay, _bare))
    count = _count(path)
    yield (
        "replay at top speed, from the file on",
        f"{count / ours:,.0f} messages/s",
        f"{count / bare:,.0f} bare read and put",
        f"{bare / ours:.2f}",
    )


def _heard(path: Path, topic: str, speed: str) -> tuple[np.ndarray, np.ndarray]:
    endpoint = free_endpoint()
    words = [str(path), "--topics", topic, "--speed", speed, "--wait", "20", "--listen", endpoint]
    came: list[tuple[int, int]] = []
    with (
        subprocess.Popen([sys.executable, "-m", "bridge", "replay", *words], stdout=subprocess.DEVNULL) as process,
        Bus(Link(None, endpoint, None, 20.0), "rig", "bench", blocking=True) as bus,
    ):
        bus.subscribe(topic, lambda sample: came.append((time.monotonic_ns(), (stamp_of(sample) or (0, 0))[0])))
        process.wait()
    return np.array([wall for wall, _ in came]), np.array([stamp for _, stamp in came])


def _seconds(path: Path, send: Callable[[Path, Any], None]) -> float:
    """Wall time from opening the file to its last message put, with a subscriber that takes it all."""
    endpoint = free_endpoint()
    with (
        open_session(Link(endpoint, None, None, 5.0)) as session,
        open_session(Link(None, endpoint, None, 5.0)) as other,
    ):
        subscriber = other.declare_subscriber("rig/**", zenoh.handlers.RingChannel(10))
        time.sleep(0.2)
        start = time.perf_counter()
        send(path, session)
        took = time.perf_counter() - start
        subscriber.undeclare()
    return took


def _bare(path: Path, session: Any) -> None:
    block = zenoh.CongestionControl.BLOCK
    with path.open("rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            session.put(channel.topic, message.data, congestion_control=block)


def _replay(path: Path, session: Any) -> None:
    """What `hydrotwin replay --speed max` does between its start and its end."""
    from bridge.recording.reader import read
    from bridge.replay.player import Player
    from bridge.replay.republish import Playing, Sender, selected
    from bridge.replay.timeline import Timeline

    recording = read(path)
    entries = selected(recording, Playing())
    keys = {topic: facts.key for topic, facts in recording.channels.items()}
    sender = Sender(session, recording, entries, keys)
    timeline = Timeline([entry.log_time for entry in entries], time.monotonic_ns(), float("inf"))
    Player(timeline, sender.send).run()


def _count(path: Path) -> int:
    with path.open("rb") as file:
        summary: Any = make_reader(file).get_summary()
    return summary.statistics.message_count
