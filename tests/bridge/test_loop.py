"""One loop, four ways to run it, the same data."""

from pathlib import Path

import numpy as np
import pytest

from bridge.recording.digest import digest
from bridge.recording.reader import Recording, read
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from controller.grid import NS
from tests.support.processes import (
    COARSE,
    run_recorded,
    started,
    summary,
    wait_for,
)

SHORT = ("step", "--duration", "1.6")
LOOSE = (  # a busy machine is no failure here
    *("--set", "real_time.overruns=1.0", "--set", "real_time.length=10", "--set", "real_time.late_commands=1.0"),
    *("--set", "loop.command_timeout=2"),
)
EXACT = ("daq.noise=0", "daq.quantise=false", "rig.cylinder.leakage_resistance=inf")


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("loop")


@pytest.fixture(scope="module")
def in_process(folder) -> dict[str, str]:
    record_in_process(load("step", [f"duration={SHORT[-1]}"]), folder / "inprocess.mcap")
    return digest(folder / "inprocess.mcap")


@pytest.fixture(scope="module")
def lockstep(folder) -> Recording:
    return run_recorded(folder / "lockstep.mcap", *SHORT, "--mode", "lockstep")


def test_lockstep_through_the_wire_is_the_in_process_loop(in_process, lockstep):
    assert digest(lockstep.path) == in_process


def test_lockstep_recordings_are_in_order_across_channels(folder, in_process, lockstep):
    whole = lockstep
    assert [e for e in whole.entries if e.topic != "status"] == read(folder / "inprocess.mcap").entries


def test_a_real_time_run_without_late_commands_is_the_same(folder):
    """With a delay that a busy machine keeps to; a run that was late all the same says so and is tried again."""
    ample = ("--set", "loop.delay=0.3", *COARSE)
    record_in_process(load("step", ["duration=2", "loop.delay=0.3", COARSE[1]]), folder / "ample.mcap")
    for attempt in range(3):
        path = folder / f"realtime-{attempt}.mcap"
        run_recorded(path, "step", "--duration", "2", *ample, *LOOSE)
        result = summary(path)
        assert result["timing"]["lateness"]["max"] > 0.0
        if result["commands"]["late"] == 0:
            assert digest(path) == digest(folder / "ample.mcap")
            return
    pytest.fail("late commands in three runs with 0.3 s to spare: this machine is too busy to tell")


def test_the_gain_lives_in_the_controller_process_alone(folder):
    """The same plant command line; only the controller is told another gain."""
    digests = []
    for gain in ("1", "1.1"):
        path = folder / f"gain-{gain}.mcap"
        endpoint = _endpoint()
        common = ("--mode", "lockstep")
        changes = ("--set", "duration=1.5", "--run-id", "77", "--await", "recorder", "--await", "controller")
        controller = ("controller", "step", *common, "--connect", endpoint, "--source", "5")
        with (
            started("plant", "step", *common, "--listen", endpoint, *changes) as plant,
            started("record", "-o", str(path), *common, "--connect", endpoint) as recorder,
            started(*controller, "--set", f"controller.gain={gain}"),
        ):
            assert plant.wait(60) == 0
            assert recorder.wait(20) == 0
        digests.append(digest(path))
    assert digests[0]["state"] != digests[1]["state"]
    assert digests[0]["command"] != digests[1]["command"]


def _endpoint() -> str:
    from bridge.wire.link import free_endpoint

    return free_endpoint()


@pytest.mark.parametrize("delay_ms", [20.0, 50.0])
def test_a_delay_shifts_the_response_by_exactly_itself(folder, delay_ms):
    """T = 20 ms, delay 1 and 2.5 T: from rest the response is the same, so many samples later.

    On the rig whose pilot is calm at rest: a singing one does not wait for a delayed command.
    """
    undelayed, columns = (
        record_in_process(load("assumed-rig", _open_loop_step(delay)), folder / f"{delay:g}.mcap").columns("state")
        for delay in (0.0, delay_ms)
    )
    shift = round(delay_ms)
    assert np.array_equal(columns["reference"][shift:], undelayed["reference"][:-shift])
    moved, reference = columns["position"][shift:], undelayed["position"][:-shift]
    assert reference[-1] - reference[0] > 0.05
    assert np.abs(moved - reference).max() < 1e-12


def test_a_delay_between_two_samples_is_the_same_through_the_wire(folder):
    changes = _open_loop_step(50.0)
    flags = [word for change in changes for word in ("--set", change)]
    there = run_recorded(folder / "wire.mcap", "step", "--mode", "lockstep", *flags)
    assert digest(there.path) == digest(record_in_process(load("step", changes), folder / "here.mcap").path)


def _open_loop_step(delay_ms: float) -> list[str]:
    return [
        "duration=0.8",
        'controller.kind="open-loop"',
        'rig.pump.ripple="none"',  # teeth do not wait for a delayed command
        'reference={kind="step", start=0.0, end=0.5, at=0.2}',
        'loop.sample_period="20 ms"',
        f'loop.delay="{delay_ms:g} ms"',
        *EXACT,
    ]


def test_every_late_command_has_its_instant(folder, tmp_path):
    """A law thinks for 30 ms at every tenth sample of 10 ms, without delay: each late command says when it acted."""
    (tmp_path / "slow.py").write_text(
        "import time\n\ndef law(sample, target, memory, gains):\n"
        "    count = (memory or 0) + 1\n"
        "    time.sleep(0.03 if count % 10 == 0 else 0.0)\n"
        "    return 0.2 * (target.position - sample.position), count\n"
    )
    law = ("controller.kind=python", f"controller.law={tmp_path / 'slow.py'}:law", "loop.delay=0")
    changes = [word for change in law for word in ("--set", change)]
    path = folder / "late.mcap"
    recording = run_recorded(path, "step", "--duration", "2", *COARSE, *LOOSE, *changes)
    late = [event for event in recording.messages("event") if event.kind == "late"]
    assert summary(path)["commands"]["late"] == len(late) >= 20
    assert all(event.applied_at > event.apply_at for event in late)
    assert all(event.applied_at % 10_000_000 == 0 for event in late)


def test_slow_motion_is_paced_by_its_factor(folder):
    recording = run_recorded(
        *(folder / "slow.mcap", "step", "--duration", "1", "--speed", "0.5", *COARSE),
        *LOOSE,
    )
    assert recording.columns("state")["stamp"][-1] == NS
    assert recording.metadata["run"]["speed"] == 0.5


def test_any_law_of_a_user_closes_the_loop(folder, tmp_path):
    (tmp_path / "mine.py").write_text(
        "def law(sample, target, memory, gains):\n"
        "    error = target.position - sample.position\n"
        "    return max(-1.0, min(1.0, 5.0 * error + (0.1 if error > 0 else -0.1))), None\n"
    )
    law = ("controller.kind=python", f"controller.law={tmp_path / 'mine.py'}:law")
    changes = [word for change in law for word in ("--set", change)]
    recording = run_recorded(folder / "mine.mcap", "step", "--duration", "2.2", "--mode", "lockstep", *changes)
    assert recording.columns("state")["position"][-1] == pytest.approx(0.16, abs=2e-3)


def test_plants_of_two_names_share_one_network(folder):
    """A second rig connects to the first one's plant as its router, and neither hears the other."""
    endpoint = _endpoint()
    with (
        started("plant", "step", *COARSE, "--set", "rig_name=one", "--set", "duration=60", "--listen", endpoint),
        started(
            "plant", "step", *COARSE, "--set", "rig_name=two", "--set", "duration=60", "--connect", endpoint
        ) as second,
    ):
        path = folder / "two.mcap"
        with started("record", "-o", str(path), "--rig", "two", "--connect", endpoint) as recorder:
            wait_for(lambda: path.is_file() and path.stat().st_size > 5_000, 30)
            second.terminate()
            assert recorder.wait(20) == 0
    assert {m.run_id for m in read(path).messages("measurement")} == {int(read(path).metadata["run"]["run_id"])}
