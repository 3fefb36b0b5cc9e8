"""Real processes that misbehave: stopped, killed, interrupted, intruding."""

import json
import signal
import struct
import time
from pathlib import Path

import numpy as np
import pytest
import zenoh

from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.bus import Bus
from bridge.wire.codec import ValveCommand, decode, encode
from bridge.wire.link import Link, free_endpoint
from tests.support.processes import (
    COARSE,
    IMPATIENT,
    LOOSE,
    UNDRAWN,
    child,
    children,
    grown,
    hydrotwin,
    listening,
    started,
    wait_for,
    with_signal,
)

RUNNING = 30_000  # bytes of a recording in which the loop has been seen to run


@pytest.fixture
def path(tmp_path) -> Path:
    return tmp_path / "a.mcap"


def events(path: Path, kind: str) -> list:
    return [event for event in read(path).messages("event") if event.kind == kind]


@pytest.mark.timed
def test_a_stopped_controller_in_real_time_leads_to_the_safe_state(path):
    """Within the timeout and one tick of simulated time, said in the recording; the run ends and names the silent."""
    timeout = ("--set", "loop.command_timeout=0.2")
    words = ("run", *UNDRAWN, "square", "--duration", "2", *timeout, *LOOSE, "--record", str(path))
    with started(*words, program=IMPATIENT) as run:
        controller = child(run.pid, "controller")
        wait_for(lambda: grown(path, RUNNING), 30)
        with_signal(controller, signal.SIGSTOP)
        output, _ = run.communicate(timeout=60)
    assert run.returncode == 1
    faults = json.loads(output)["faults"]
    assert faults[0].startswith("the plant went to its safe state 1 time, first at ")
    assert any("did not exit within" in fault for fault in faults)
    (safe,) = events(path, "safe")
    last = read(path).messages("command")[-1]
    period, wait, tick = 10_000_000, 200_000_000, 1_000_000
    assert safe.applied_at - (last.apply_at + period + wait) in range(tick)
    state = read(path).columns("state")
    after = state["stamp"] > safe.applied_at
    assert after.sum() > 500
    assert np.all(state["reference"][after] == 0.0)


def test_a_stopped_controller_in_lockstep_is_named_with_the_tick(path):
    lockstep = ("--mode", "lockstep", "--patience", "2")
    words = ("run", *UNDRAWN, "step", "--duration", "600", *lockstep, "--record", str(path))
    with started(*words, program=IMPATIENT) as run:
        controller = child(run.pid, "controller")
        wait_for(lambda: grown(path, RUNNING), 30)
        with_signal(controller, signal.SIGSTOP)
        begin = time.monotonic()
        output, _ = run.communicate(timeout=40)
    assert time.monotonic() - begin < 35.0  # 2 s of patience, and what a starved machine needs to end three processes
    assert run.returncode == 1
    assert "the controller has not answered the measurement of tick " in output
    assert "Traceback" not in output
    ended = events(path, "ended")[-1]
    assert ended.text.startswith("failed: the controller has not answered")
    state = read(path).columns("state")["stamp"]
    assert np.array_equal(np.diff(state), np.full(len(state) - 1, 1_000_000))


def test_a_killed_controller_is_named_and_nothing_is_left(path):
    with started("run", *UNDRAWN, "step", "--duration", "20", "--record", str(path)) as run:
        controller = child(run.pid, "controller")
        wait_for(lambda: grown(path, RUNNING), 30)
        ours = set(children(run.pid))
        with_signal(controller, signal.SIGKILL)
        output, _ = run.communicate(timeout=40)
        assert run.returncode == 1
        assert f"the controller (pid {controller}) was killed by SIGKILL" in output.replace("\n", " ")
        assert not any(alive(pid) for pid in ours)


def alive(pid: int) -> bool:
    status = Path(f"/proc/{pid}/stat")
    return status.exists() and status.read_text().rpartition(")")[2].split()[0] != "Z"


BEGUN = {  # how far a run has come, seen from outside
    "a child is started": lambda run, path: children(run.pid),
    "the file is there": lambda run, path: path.exists(),
    "the loop runs": lambda run, path: grown(path, RUNNING),
    "the loop has run for seconds": lambda run, path: grown(path, 10 * RUNNING),
}


@pytest.mark.parametrize("moment", BEGUN)
def test_ctrl_c_at_any_time_leaves_no_process_and_a_readable_recording(path, moment):
    with started("run", *UNDRAWN, "step", "--duration", "60", *LOOSE, "--record", str(path)) as run:
        wait_for(lambda: BEGUN[moment](run, path), 60)
        ours = set(children(run.pid))
        with_signal(run.pid, signal.SIGINT)
        output, _ = run.communicate(timeout=60)
        assert "Traceback" not in output
        assert not any(alive(pid) for pid in ours)
    assert ours
    if moment.startswith("the loop"):
        assert "interrupted" in output
        assert read(path).complete
        assert len(read(path).columns("state")["stamp"]) > 100
        assert events(path, "ended")[-1].text.startswith("interrupted")
    elif path.exists():  # begun, and whole as far as it goes
        assert read(path).complete


@pytest.mark.timed
def test_a_stalled_recorder_neither_holds_the_plant_nor_loses_a_message(path):
    """Stopped for a second: ticks go on, by far less late than that, and what was sent meanwhile still comes."""
    with started("run", *UNDRAWN, "square", "--duration", "2.5", *COARSE, *LOOSE, "--record", str(path)) as run:
        recorder = child(run.pid, "record")
        wait_for(lambda: grown(path, RUNNING), 30)
        with_signal(recorder, signal.SIGSTOP)
        time.sleep(1.0)
        with_signal(recorder, signal.SIGCONT)
        run.communicate(timeout=60)
    recording = read(path)
    assert recording.metadata["summary"]["timing"]["lateness"]["max"] < 0.5
    assert len(recording.columns("measurement")["tick"]) == 251
    assert not recording.metadata["summary"]["lost"]


def test_a_killed_supervisor_takes_its_processes_along(path):
    with started("run", *UNDRAWN, "step", "--duration", "60", "--record", str(path)) as run:
        wait_for(lambda: grown(path, RUNNING), 30)
        ours = set(children(run.pid))
        with_signal(run.pid, signal.SIGKILL)
        wait_for(lambda: not any(alive(pid) for pid in ours), 20)
    assert read(path).complete


def test_intruders_are_refused_told_and_change_nothing(tmp_path):
    """In lockstep, over the wire: the same true states, bit for bit, with and without them."""
    quiet, disturbed = tmp_path / "quiet.mcap", tmp_path / "disturbed.mcap"
    run = ("run", *UNDRAWN, "step", "--duration", "1.5", "--mode", "lockstep", "--set", "allowed.refused=100000")
    record_in_process(load("step", ["duration=1.5"]), quiet)
    endpoint = free_endpoint()
    with started(*run, "--listen", endpoint, "--record", str(disturbed)) as process:
        noise(endpoint, int(read(quiet).metadata["run"]["run_id"]))
        output, _ = process.communicate(timeout=60)
        assert process.returncode == 0, output
    calm, wild = read(quiet), read(disturbed)
    for topic in ("measurement", "state"):
        assert [e.data for e in calm.of(topic)] == [e.data for e in wild.of(topic)]
    refused = wild.metadata["summary"]["commands"]["refused"]
    assert set(refused) >= {"undecodable", "not finite", "out of range", "far future", "second controller"}
    told = {event.text.partition(":")[0] for event in wild.messages("event") if event.kind == "refused"}
    assert told == set(refused)


def noise(endpoint: str, run_id: int) -> None:
    """Send all kinds of wrong commands until the plant is gone."""
    with Bus(Link(None, endpoint, None, 30.0), "rig", "intruder", blocking=True) as bus:
        came: list[bytes] = []
        bus.subscribe("command", lambda sample: came.append(sample.payload.to_bytes()))
        bus.watch()
        wait_for(lambda: len(came) > 5, 30)
        _, owner, sequence, stamp, _, _ = struct.unpack("<4xQQQqqd", came[-1])
        for turn in range(100):
            for source, number, ahead, spool in (
                (4711, turn, 0, 0.9),
                (4711, turn, 0, float("nan")),
                (4711, turn, 0, 1e300),
                (owner, sequence, 60_000_000_000, 0.5),
            ):
                wrong = ValveCommand(run_id, source, number, stamp, stamp + ahead, spool)
                bus.session.put("rig/command", encode(wrong))
            bus.session.put("rig/command", b"no command at all")
            bus.session.put("rig/command", b"\x00" * 52, encoding=zenoh.Encoding("application/cdr;std_msgs/msg/String"))
            time.sleep(0.005)


def test_a_second_controller_is_told_and_goes(tmp_path):
    endpoint, path = free_endpoint(), tmp_path / "a.mcap"
    options = (*UNDRAWN, "--duration", "100", *COARSE, *LOOSE, "--listen", endpoint, "--record", str(path))
    with started("run", "square", *options) as run:
        wait_for(lambda: path.exists(), 30)
        second = hydrotwin("controller", "square", *COARSE, "--connect", endpoint)
        assert second.returncode == 1
        assert "the plant refuses this controller" in second.stderr
        assert "Traceback" not in second.stderr
        with_signal(run.pid, signal.SIGINT)
        run.communicate(timeout=60)
    assert "second controller" in read(path).metadata["summary"]["commands"]["refused"]


def test_reset_leaves_the_safe_state(tmp_path):
    """The controller is stopped and continued: latched, its commands are refused until somebody resets."""
    endpoint, path = free_endpoint(), tmp_path / "a.mcap"
    timeout = ("--set", "loop.command_timeout=0.1")
    options = (*UNDRAWN, "--duration", "100", *timeout, *LOOSE, "--listen", endpoint, "--record", str(path))
    with (
        started("run", "square", *options) as run,
        Bus(Link(None, endpoint, None, 60.0), "rig", "witness", blocking=False) as bus,
    ):
        kinds: list[str] = []
        bus.subscribe("event", lambda sample: kinds.append(decode(sample.payload.to_bytes(), "event").kind))
        controller = child(run.pid, "controller")
        wait_for(lambda: grown(path, RUNNING), 60)
        with_signal(controller, signal.SIGSTOP)
        wait_for(lambda: "safe" in kinds, 30)
        with_signal(controller, signal.SIGCONT)
        wait_for(lambda: "refused" in kinds, 30)
        time.sleep(0.3)
        assert hydrotwin("reset", "--connect", endpoint).returncode == 0
        wait_for(lambda: "reset" in kinds, 30)
        time.sleep(1.0)
        with_signal(run.pid, signal.SIGINT)
        run.communicate(timeout=60)
    assert len(events(path, "reset")) == 1
    assert read(path).metadata["summary"]["commands"]["refused"]["latched"] > 10
    reset_at = events(path, "reset")[0].stamp
    state = read(path).columns("state")
    assert np.abs(state["reference"][state["stamp"] > reset_at]).max() > 0.0


def test_nobody_at_home_is_said_in_one_line():
    for command in (("controller", "step"), ("record",)):
        done = hydrotwin(*command, "--connect", free_endpoint(), "--patience", "1")
        assert done.returncode == 1
        assert done.stderr.count("\n") == 1
        assert "nobody answers" in done.stderr


def test_a_taken_address_is_said_in_one_line():
    endpoint = free_endpoint()
    with started("plant", "step", "--listen", endpoint):
        wait_for(lambda: listening(endpoint), 60)
        done = hydrotwin("plant", "step", "--listen", endpoint)
    assert done.returncode == 1
    assert "cannot listen" in done.stderr
    assert done.stderr.count("\n") == 1
