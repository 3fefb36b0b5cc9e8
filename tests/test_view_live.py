"""A running plant in Rerun: all of it arrives, a stalled or closed viewer holds nobody, mistakes get one line."""

import signal
import time
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from bridge.bus import STAMP
from bridge.inprocess import exchange, manifest, sides
from bridge.link import free_endpoint
from bridge.messages import encode
from bridge.recording.reader import Entry
from bridge.scenario import load
from bridge.view.batch import MOST, WATCHED, Inbox, run_of
from tests.processes import hydrotwin, started, wait_for, with_signal
from tests.test_view import column

pytest.importorskip("rerun")
LONG = ["--set", "duration=4", "--set", "real_time.overruns=100000", "--set", "real_time.length=10 s"]


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


def test_inbox_leaves_out_the_oldest_and_counts_it():
    inbox = Inbox()
    _, entries = messages(0.01)
    state = next(e for e in entries if e.topic == "state")
    for i in range(MOST + 7):
        inbox.put("state", sample(state.data, (i, i)))
    assert inbox.left_out == 7
    assert inbox.take()[0].log_time == 7
    assert inbox.take() == []
    assert inbox.left_out == 7


def test_inbox_hands_on_no_noise():
    inbox = Inbox()
    for topic in ("state", "lines", "event"):
        inbox.put(topic, sample(b"\x00\x01\x00\x00noise"))
    inbox.put("state", sample(b"", None))
    assert inbox.take() == []


def test_every_message_begins_with_its_run():
    head, entries = messages(0.04)
    assert {run_of(entry) for entry in entries} == {int(head["run_id"])}


@pytest.mark.parametrize("size", [1, 7, 1000])
def test_batches_of_any_size_draw_the_same(tmp_path: Path, size: int):
    """A profile and the state of its tick may come in different batches."""
    import rerun as rr

    from bridge.view.drawing import Drawing

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


@contextmanager
def running(*changes: str):
    """A scenario in real time and the address of its plant."""
    endpoint = free_endpoint()
    with started("run", "step", *LONG, "--listen", endpoint, *changes) as process:
        yield process, endpoint


def test_a_running_plant_is_drawn_to_its_end(tmp_path: Path):
    """Into a file, tick by tick: at 1 kHz nothing is missing between the first and the last."""
    path = tmp_path / "live.rrd"
    with running("--record", str(tmp_path / "a.mcap")) as (_, endpoint):
        done = hydrotwin("view", "--connect", endpoint, "--save", str(path), "--patience", "60")
    assert done.returncode == 0, done.stderr
    stamps = np.sort(column(path, "/position_mm/piston", "Scalars:scalars")[0])
    assert stamps[-1] == 4_000_000_000
    assert np.diff(stamps).tolist() == [1_000_000] * (len(stamps) - 1)
    assert len(stamps) > 2000
    assert any("ended" in text for text in column(path, "/events", "TextLog:text")[1])


@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGKILL])
def test_a_stalled_or_killed_viewer_holds_nobody(tmp_path: Path, number: signal.Signals):
    """The run is as long as without it and loses nothing."""
    view = tmp_path / "a.rrd"
    with (
        running("--record", str(tmp_path / "a.mcap")) as (process, endpoint),
        started("view", "--connect", endpoint, "--save", str(view), "--patience", "60") as viewer,
    ):
        wait_for(view.exists, 60.0)
        begin = time.monotonic()
        with_signal(viewer.pid, number)
        assert process.wait(30) == 0, process.stdout.read() if process.stdout else ""
        assert time.monotonic() - begin < 12.0
    from bridge.recording.reader import read

    recording = read(tmp_path / "a.mcap")
    assert recording.counts["state"] == 4001
    assert recording.metadata["summary"]["lost"] == {}


def test_mistakes_get_one_line(tmp_path: Path):
    nobody = free_endpoint()
    for arguments, complaint in (
        (("--connect", nobody, "--patience", "0.3", "--save", "a.rrd"), "nobody answers"),
        (("--web", "--save", "a.rrd"), "choose one"),
        (("--screenshot", "a.jpg"), "name it a.png"),
        (("--screenshot", "missing/a.png"), "there is no folder missing"),
        (("--at", "soon"), "--at soon"),
    ):
        done = hydrotwin("view", *arguments, cwd=tmp_path)
        assert done.returncode in (1, 2)
        assert complaint in done.stderr
        assert done.stderr.count("\n") == 1
