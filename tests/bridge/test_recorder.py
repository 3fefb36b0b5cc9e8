"""The recorder as its user has it: filters, parts, a ring, disks that are full or slow, processes that are killed."""

import json
import random
import resource
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bridge.processes.recorder.process import RecorderProcess
from bridge.processes.recorder.ring import Ring, Window
from bridge.processes.recorder.run_file import Request
from bridge.recording.info import describe
from bridge.recording.reader import Recording, read
from bridge.recording.recover import recover
from bridge.recording.sink import Sink
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.codec import decode
from bridge.wire.link import Link, free_endpoint
from tests.support.command import hydrotwin_here
from tests.support.processes import (
    COARSE,
    LOOSE,
    UNDRAWN,
    child,
    children,
    grown,
    hydrotwin,
    started,
    wait_for,
    with_signal,
)

RUNNING = 30_000  # bytes of a recording in which the loop has been seen to run
AWAITED = ("--set", "duration=3", "--await", "controller", "--await", "recorder", "--json", "--quiet")
KEPT = 0.25  # seconds before a kill up to which everything is in the file


@contextmanager
def recorded(path: Path, *options: str, run: tuple[str, ...] = ("step", "--duration", "1.2")) -> Iterator[str]:
    """A lockstep run recorded by `hydrotwin record` with options; gives where the plant listens."""
    endpoint = free_endpoint()
    awaited = ("--await", "controller", "--await", "recorder", "--mode", "lockstep", "--listen", endpoint)
    name, _, duration, *changes = run
    plant = ("plant", name, "--set", f"duration={duration}", *changes, *awaited)
    client = ("--mode", "lockstep", "--connect", endpoint)
    with (
        started(*plant) as first,
        started("controller", name, "--set", f"duration={duration}", *changes, *client) as second,
        started("record", "-o", str(path), *client, *options) as third,
    ):
        yield endpoint
        for process in (first, second, third):
            assert process.wait(120) == 0, process.communicate()[0]


def test_only_what_is_chosen_is_recorded_with_the_users_own_words(tmp_path):
    path = tmp_path / "few.mcap"
    with recorded(path, "--topics", "state,pressure/*", "--without", "pressure/p3", "--meta", "operator=Ada"):
        pass
    found = read(path)
    assert set(found.counts) == {"state", "pressure/p1", "pressure/p2"} == set(found.channels)
    assert found.counts["state"] == 1201
    assert found.metadata["user"] == {"operator": "Ada"}
    assert not found.metadata["summary"]["lost"]
    done = hydrotwin("info", str(path), "--json")
    told = json.loads(done.stdout)
    assert (told["problems"], told["metadata"]["user"]) == ([], {"operator": "Ada"})


@pytest.mark.parametrize("option", [("--split-time", "0.4 s"), ("--split-size", "100 kB")])
def test_parts_are_whole_and_join_to_the_run(tmp_path, option):
    """Each part opens by itself; joined, they are the file that would have been without splitting."""
    path, whole = tmp_path / "a.mcap", tmp_path / "whole.mcap"
    with recorded(path, *option, "--fsync"):
        pass
    parts = [path, *sorted(tmp_path.glob("a-part*.mcap"))]
    assert len(parts) >= 3
    for part, following in pairwise(parts):
        recording = read(part)
        assert recording.complete
        assert recording.scenario().name == "step"
        assert recording.metadata["part_end"]["next"] == following.name
        assert describe(recording).problems == []
    assert read(parts[-1]).metadata["summary"]["ending"] == "complete after 1200 ticks"
    assert read(parts[-1]).metadata["summary"]["messages"]["state"] == 1201
    assert recover(parts, whole).whole
    record_in_process(load("step", ["duration=1.2"]), tmp_path / "b.mcap")
    theirs, ours = (read(file).columns("state")["position"] for file in (tmp_path / "b.mcap", whole))
    assert np.array_equal(theirs, ours)


def test_a_ring_keeps_what_was_before_and_after_an_event(tmp_path):
    """The run's end is the event: so much before it as was asked for, and nothing of what was earlier."""
    path = tmp_path / "ring.mcap"
    with recorded(path, "--ring", "0.5 s", "--triggers", "ended"):
        pass
    stamps = read(path).columns("state")["stamp"]
    assert stamps[-1] == 1_200_000_000
    assert 690_000_000 <= stamps[0] <= 700_000_000
    assert np.all(np.diff(stamps) == 1_000_000)


def test_a_ring_without_an_event_writes_no_file_and_one_by_query_does(tmp_path):
    path, asked = tmp_path / "none.mcap", tmp_path / "asked.mcap"
    with recorded(path, "--ring", "1 s", "--triggers", "late"):
        pass
    assert not path.exists()
    run = ("step", "--duration", "6")
    with (
        recorded(asked, "--ring", "0.2 s", "--after", "0.1 s", "--triggers", "none", run=run) as endpoint,
        Bus(Link(None, endpoint, None, 20.0), "rig", "operator", blocking=True) as bus,
    ):
        stamps: list[int] = []
        bus.subscribe("state", lambda sample: stamps.append((stamp_of(sample) or (0, 0))[0]))
        wait_for(lambda: stamps and stamps[-1] > 1_000_000_000, 60)  # a slow recorder, too, has 0.2 s by then
        assert bus.ask("recorder/save", 10.0) == b"saved"
    length = np.ptp(read(asked).columns("state")["stamp"].astype(np.int64))
    assert 250_000_000 <= length <= 350_000_000


def test_a_ring_is_a_window_around_each_trigger():
    ring, out = Ring(Window(before=10, after=5)), []
    for time_ns in range(100):
        if time_ns in (30, 33, 80):
            ring.trigger(time_ns)
        out += [entry[1] for entry in ring.add("state", time_ns, time_ns, b"")]
    assert out == [*range(20, 39), *range(70, 86)]


def test_a_disk_that_refuses_leaves_whole_records(tmp_path):
    """The kernel's own limit on the size of a file; what is written after the last whole flush is cut off again."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    sink = Sink(tmp_path / "a")
    sink.write(b"a" * 1000)
    sink.flush()
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1500, before[1]))
        sink.write(b"b" * 1000)
        with pytest.raises(OSError, match="File too large"):
            sink.flush()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert (tmp_path / "a").read_bytes() == b"a" * 1000
    sink.write(b"c" * 10)
    sink.close()
    assert (tmp_path / "a").read_bytes() == b"a" * 1000 + b"c" * 10


@pytest.fixture
def small_disk(tmp_path) -> Iterator[tuple[Path, int | None]]:
    """A file system of 1 MB; without the right to mount one, the kernel's limit on the recorder's files [bytes]."""
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(tmp_path)]
    if subprocess.run(mount, capture_output=True).returncode:
        yield tmp_path, 700_000
        return
    try:
        yield tmp_path, None
    finally:
        subprocess.run(["umount", "-l", str(tmp_path)], check=True)


@pytest.mark.timed
def test_a_full_disk_is_told_what_was_written_stays_and_the_loop_goes_on(small_disk):
    folder, limit = small_disk
    path = folder / "a.mcap"
    with started("run", *UNDRAWN, "square", "--duration", "3", *LOOSE, "--record", str(path)) as run:
        recorder = child(run.pid, "record")
        if limit is not None:
            wait_for(lambda: grown(path, RUNNING), 30)
            resource.prlimit(recorder, resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
        output, _ = run.communicate(timeout=60)
        assert run.returncode == 1
    words = " ".join(output.split())
    assert "No space left on device" in words or "File too large" in words
    assert "what was written before stays readable" in words
    assert "Traceback" not in output
    found = read(path)
    assert_whole(found)
    told = describe(found)
    assert any("ended badly" in problem for problem in told.problems)
    if limit is None:
        assert found.metadata["refused"]["reason"] == "No space left on device"
    assert found.columns("measurement")["stamp"][-1] > 500_000_000


@pytest.mark.timed
def test_the_loop_runs_to_its_end_without_its_recorder_s_disk(tmp_path):
    """The plant's own words: every tick, no overrun by the disk that is full from the start of the second second."""
    endpoint, path = free_endpoint(), tmp_path / "a.mcap"
    plant = ("plant", "square", *AWAITED)
    with (
        started(*plant, "--listen", endpoint) as first,
        started("controller", "square", "--connect", endpoint),
        started("record", "-o", str(path), "--connect", endpoint) as third,
    ):
        wait_for(lambda: grown(path, RUNNING), 30)
        resource.prlimit(third.pid, resource.RLIMIT_FSIZE, (path.stat().st_size + 1000, resource.RLIM_INFINITY))
        output, _ = first.communicate(timeout=30)
        assert third.wait(20) == 1
        said, _ = third.communicate(timeout=10)
    assert json.loads(output)["tick"] == 3000
    assert "messages are not in it" in said
    assert_whole(read(path))


@pytest.mark.timed
def test_a_slow_disk_loses_nothing_and_holds_nobody(tmp_path, monkeypatch):
    """Every flush takes 0.6 s, three times as long as they are apart: messages wait in memory, the plant does not."""
    hand_over = Sink._hand_over

    def slow(sink: Sink) -> None:
        time.sleep(0.6)
        hand_over(sink)

    monkeypatch.setattr(Sink, "_hand_over", slow)
    endpoint, path = free_endpoint(), tmp_path / "slow.mcap"
    plant = ("plant", "step", *COARSE, *AWAITED, "--set", "duration=1.5")
    with (
        started(*plant, "--listen", endpoint) as first,
        started("controller", "step", *COARSE, "--connect", endpoint),
        Bus(Link(None, endpoint, None, 30.0), "rig", "recorder", blocking=False) as bus,
    ):
        RecorderProcess(bus, path, 20.0, lambda: False, Request()).run()
        output, _ = first.communicate(timeout=30)
    assert json.loads(output)["tick"] == 150
    assert json.loads(output)["worst_overrun"] < 0.5
    found = read(path)
    assert found.counts["state"] == found.counts["measurement"] == 151
    assert not found.metadata["summary"]["lost"]
    assert found.metadata["recorder"]["longest_flush"] > 0.5
    assert found.metadata["recorder"]["most_waiting"] > 50


def assert_whole(recording: Recording) -> None:
    """Nothing undecodable, and no tick missing up to where it ends."""
    for entry in recording.entries:
        decode(entry.data, entry.topic)
    assert np.all(np.diff(recording.columns("measurement")["stamp"]) == 1_000_000)


def killed(path: Path, roles: tuple[str, ...], seconds: float) -> None:
    """Kill processes of a real-time run after a while; everything up to 0.25 s before that is in the file."""
    endpoint = free_endpoint()
    with started(
        "run", *UNDRAWN, "square", "--duration", "60", *LOOSE, "--listen", endpoint, "--record", str(path)
    ) as run:
        wait_for(lambda: grown(path, RUNNING), 30)
        with Bus(Link(None, endpoint, None, 20.0), "rig", "witness", blocking=False) as bus:
            seen: list[Any] = []
            bus.subscribe("measurement", lambda sample: seen.append(sample.payload))
            pids = [child(run.pid, role) for role in roles]
            time.sleep(seconds)
            assert wait_for(lambda: seen, 10)
            reached = decode(seen[-1].to_bytes(), "measurement").stamp
            for pid in pids:
                with_signal(pid, signal.SIGKILL)
        ours = children(run.pid)
        output, _ = run.communicate(timeout=60)
        assert run.returncode == 1, output
        assert not set(ours) & set(children(run.pid))
    found = read(path)
    assert_whole(found)
    assert found.columns("measurement")["stamp"][-1] / 1e9 >= reached / 1e9 - KEPT
    assert any("ended badly" in problem or "went badly" in problem for problem in describe(found).problems)
    again = path.with_stem("again")
    recover([path], again)
    whole = read(again)
    assert whole.complete
    assert whole.entries == found.entries
    assert any("badly" in problem for problem in describe(whole).problems)


ROLES = [("record",), ("plant",), ("controller",), ("plant", "controller", "record")]


@pytest.mark.timed
@pytest.mark.parametrize("roles", [ROLES[0], ROLES[-1]], ids="+".join)
def test_a_kill_leaves_all_up_to_a_quarter_of_a_second_before_it(tmp_path, roles):
    killed(tmp_path / "a.mcap", roles, 0.7)


@pytest.mark.endurance
@pytest.mark.timeout(1800)
def test_fifty_kills_at_random_moments(tmp_path):
    rng = random.Random(11)
    for turn in range(50):
        killed(tmp_path / f"{turn}.mcap", ROLES[turn % len(ROLES)], rng.uniform(0.0, 2.5))


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--topics", "presure/p1"), "no topic fits 'presure/p1'; did you mean 'pressure/p1'?"),
        (("--topics", "state", "--without", "stat*"), "no topic is left of state"),
    ],
)
def test_topics_that_are_not_in_the_table_are_refused_before_anybody_is_waited_for(words, complaint, tmp_path):
    done = hydrotwin_here("record", *words, "--connect", free_endpoint(), "--patience", "60", cwd=tmp_path)
    assert done.returncode == 2
    assert complaint in done.stderr
