"""A running plant in Rerun: all of it arrives, a stalled or closed viewer holds nobody, mistakes get one line."""

import json
import signal
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from bridge.loop.exchange import exchange, sides
from bridge.recording.entries import Entry
from bridge.recording.inbox import WATCHED, Inbox, inbox, run_of
from bridge.recording.manifest import manifest
from bridge.scenario import load
from bridge.wire.bus import STAMP, Bus
from bridge.wire.codec import encode
from bridge.wire.limits import MESSAGE
from bridge.wire.link import Link, free_endpoint, open_session
from tests.bridge.test_view import column
from tests.support.command import hydrotwin_here
from tests.support.processes import (
    COARSE,
    HYDROTWIN,
    LOOSE,
    PATIENT,
    UNDRAWN,
    grown,
    hydrotwin,
    started,
    wait_for,
    with_signal,
)

pytest.importorskip("rerun")
LONG = ["--set", "duration=3", "--set", "real_time.overruns=1.0", "--set", "real_time.length=10 s"]
GOES_ON = 100_000  # [bytes] of a recording: some hundred ticks
SLOW_CONTROLLER = ("--set", "loop.command_timeout=5 s")  # that has to wait for a processor


def sample(payload: bytes, stamp: tuple[int, int] | None = (0, 0)) -> SimpleNamespace:
    """A message as Zenoh hands it over."""
    attached = None if stamp is None else SimpleNamespace(to_bytes=lambda: STAMP.pack(*stamp))
    return SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: payload), attachment=attached)


def messages(duration: float) -> tuple[dict, list[Entry]]:
    """Head and messages of a run in process."""
    scenario = load("step", [f"duration={duration}"])
    plant, controller = sides(scenario)
    sent = [m for tick in exchange(plant, controller, scenario.ticks) for m in tick]
    entries = [Entry(m.topic, m.log_time, m.sequence, encode(m.message)) for m in sent]
    return manifest(scenario, plant.run_id), [entry for entry in entries if entry.topic in WATCHED]


class Ring(list):
    """What Zenoh's ring does: the next message, or None."""

    def try_recv(self) -> SimpleNamespace | None:
        return self.pop(0) if self else None


def test_inbox_counts_what_the_ring_has_left_out():
    _, entries = messages(0.02)
    states = [entry for entry in entries if entry.topic == "state"]
    ring = Ring(
        sample(entry.data, (entry.log_time, entry.sequence)) for entry in states if entry.sequence not in (3, 4, 9)
    )
    box = Inbox({"state": ring})
    assert len(box.take()) == len(states) - 3
    assert box.left_out == 3
    assert box.take() == []


def test_long_messages_are_left_out_and_counted():
    """Zenoh drops them, without a word."""
    _, entries = messages(0.02)
    states, address = [entry for entry in entries if entry.topic == "state"][:5], free_endpoint()
    to, found = Link(None, address, None, 5.0), []
    with open_session(Link(address, None, None, 5.0)) as session, Bus(to, "rig", "viewer", blocking=False) as bus:
        box, publisher = inbox(bus, WATCHED), session.declare_publisher("rig/state")
        wait_for(lambda: publisher.matching_status.matching, 20.0)
        for entry in states:
            payload = bytes(MESSAGE + 1) if entry is states[2] else entry.data
            publisher.put(payload, attachment=STAMP.pack(entry.log_time, entry.sequence))
        wait_for(lambda: found.extend(box.take()) or len(found) == len(states) - 1, 20.0)
    assert found == [*states[:2], *states[3:]]
    assert box.left_out == 1


def test_inbox_hands_on_no_noise():
    noise = {topic: Ring([sample(b"\x00\x01\x00\x00noise")]) for topic in ("state", "lines", "event")}
    assert Inbox(noise).take() == []
    assert Inbox({"state": Ring([sample(b"", None)])}).take() == []


def test_every_message_begins_with_its_run():
    head, entries = messages(0.04)
    assert {run_of(entry) for entry in entries} == {int(head["run_id"])}


@pytest.mark.parametrize("size", [1, 7, 1000])
def test_batches_of_any_size_draw_the_same(tmp_path: Path, size: int):
    """A profile and the state of its tick may come in different batches."""
    import rerun as rr

    from bridge.view.live_drawing import Drawing

    head, entries = messages(0.1)
    stream, path = rr.RecordingStream("hydrotwin"), tmp_path / "a.rrd"
    stream.save(path)
    drawing = Drawing(stream, head, bare=False)
    for begin in range(0, len(entries), size):
        drawing.add(entries[begin : begin + size])
    stream.disconnect()
    stamps, values = column(path, "/position_mm/piston", "Scalars:scalars")
    assert sorted(stamps) == [k * 1_000_000 for k in range(101)]
    assert len(values) == 101
    assert sorted(column(path, "/rig/piston", "Transform3D:translation")[0]) == [k * 20_000_000 for k in range(6)]
    assert drawing.seconds == pytest.approx(0.1)


def for_all_times(path: Path) -> int:
    """Pieces of a Rerun file that belong to no time."""
    from rerun.chunk import RrdReader

    return sum(chunk.is_static for chunk in RrdReader(path).stream())


def test_what_is_for_all_times_is_sent_once(tmp_path: Path):
    """Rerun's server keeps it for good, the older copies too: it must not grow with a run."""
    import rerun as rr

    from bridge.view.live_drawing import Drawing

    head, entries = messages(1.2)
    found = []
    for share in (0, 1):
        stream, path = rr.RecordingStream("hydrotwin"), tmp_path / f"{share}.rrd"
        stream.save(path)
        drawing = Drawing(stream, head, bare=False)
        for begin in range(0, share * len(entries), 100):
            drawing.add(entries[begin : begin + 100])
        stream.disconnect()
        found.append(for_all_times(path))
    assert found[0] == found[1] > 20
    maps = column(tmp_path / "1.rrd", "/along/pipe_1/picture", "Image:buffer")[0]
    assert len(maps) == 3
    assert (np.diff(sorted(maps)) / 1e9).tolist() == pytest.approx([0.5, 0.5], abs=0.04)  # profiles come every 0.02 s


def test_what_has_waited_is_drawn_in_parts_and_whole(tmp_path: Path):
    """A busy machine lets seconds of messages wait, topic by topic; a profile is drawn with the state of its tick."""
    import rerun as rr

    from bridge.view.live import PART, parts
    from bridge.view.live_drawing import Drawing

    head, entries = messages(3.0)
    waiting = sorted(entries, key=lambda entry: WATCHED.index(entry.topic))
    found = list(parts(waiting, int(head["run_id"])))
    assert len(found) == 2
    assert max(map(len, found)) <= PART
    stream, path = rr.RecordingStream("hydrotwin"), tmp_path / "a.rrd"
    stream.save(path)
    drawing = Drawing(stream, head, bare=False)
    for part in found:
        drawing.add(part)
    stream.disconnect()
    assert sorted(column(path, "/position_mm/piston", "Scalars:scalars")[0]) == [k * 1_000_000 for k in range(3001)]
    assert sorted(column(path, "/rig/piston", "Transform3D:translation")[0]) == [k * 20_000_000 for k in range(151)]


@contextmanager
def running(*changes: str, program: tuple[str, ...] = HYDROTWIN):
    """A scenario in real time and the address of its plant."""
    endpoint = free_endpoint()
    with started("run", *UNDRAWN, "step", *LONG, "--listen", endpoint, *changes, program=program) as process:
        yield process, endpoint


@pytest.mark.timed
@pytest.mark.filterwarnings("ignore:RRD file has no footer")
def test_a_running_plant_is_drawn_to_its_end(tmp_path: Path):
    """Into a file, tick by tick: at 1 kHz nothing is missing between the first and the last."""
    path = tmp_path / "live.rrd"
    with running("--record", str(tmp_path / "a.mcap"), "--set", "duration=5") as (_, endpoint):
        done = hydrotwin("view", "--connect", endpoint, "--save", str(path), "--patience", "60")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    with pytest.warns(Warning, match="no footer"):  # for which Rerun would keep a line a batch in memory
        texts = column(path, "/events", "TextLog:text")[1]
    stamps = np.sort(column(path, "/position_mm/piston", "Scalars:scalars")[0])
    assert stamps[-1] == 5_000_000_000
    assert np.diff(stamps).tolist() == [1_000_000] * (len(stamps) - 1)
    assert len(stamps) > 1000
    assert any("ended" in text for text in texts)


@pytest.mark.parametrize(
    "number",
    [signal.SIGSTOP, pytest.param(signal.SIGKILL, marks=pytest.mark.endurance)],
)
@pytest.mark.timeout(400)
def test_a_stalled_or_killed_viewer_holds_nobody(tmp_path: Path, number: signal.Signals):
    """The run goes on and loses nothing. It lasts until the viewer was there, however busy the machine is.

    The plant's last word waits for its readers, of whom Zenoh gives one up that takes nothing for 5 s.
    """
    view, path = tmp_path / "a.rrd", tmp_path / "a.mcap"
    words = ("--record", str(path), *COARSE, *SLOW_CONTROLLER, *LOOSE, "--set", "duration=1000")
    with (
        running(*words, program=PATIENT) as (process, endpoint),
        started("view", "--connect", endpoint, "--save", str(view), "--patience", "120") as viewer,
    ):
        wait_for(view.exists, 120.0)
        with_signal(viewer.pid, number)
        enough = path.stat().st_size + GOES_ON
        wait_for(lambda: grown(path, enough), 60.0)
        with_signal(process.pid, signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    from bridge.recording.reader import read

    recording = read(path)
    ticks = recording.columns("state")["tick"]
    assert np.array_equal(ticks, np.arange(len(ticks)))
    assert json.loads(output)["faults"] == [f"the run ended early: interrupted after {len(ticks) - 1} ticks"]
    assert recording.metadata["summary"]["lost"] == {}


def test_mistakes_get_one_line(tmp_path: Path):
    nobody = free_endpoint()
    for arguments, complaint in (
        (("--connect", nobody, "--patience", "0.3", "--save", "a.rrd"), "nobody answers"),
        (("--web", "--save", "a.rrd"), "choose one"),
        (("--screenshot", "a.jpg"), "name it a.png"),
        (("--screenshot", "missing/a.png"), "there is no folder missing"),
        (("--at", "soon"), "--at: cannot read 'soon'"),
    ):
        done = hydrotwin_here("view", *arguments, cwd=tmp_path)
        assert done.returncode in (1, 2)
        assert complaint in done.stderr
        assert done.stderr.count("\n") == 1
