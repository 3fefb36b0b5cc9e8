"""Faults of processes: the supervisor of a run in real time lets them act, each in its window."""

import time
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import ScenarioError
from bridge.processes.failing import refuse_processes
from bridge.recording.reader import Recording, read
from bridge.scenario import load
from bridge.wire.messages import Mode
from tests.support.processes import LOOSE, UNDRAWN, child, started

FROZEN, SLOWED, DEAF, RESTARTED = (0.6, 1.1), (1.8, 2.4), (2.8, 3.2), 3.6  # [s]
CUT, BACK = 1.0, 0.3  # [s]: the network restarts
ALLOWED = ("allowed.safe_states=20", "allowed.refused=1000", "loop.after_timeout=resume", "loop.command_timeout=0.2")
EACH = (
    f'{{target="process.controller", kind="freeze", at={FROZEN[0]}, lasts=0.5}}',
    f'{{target="process.controller", kind="slow", share=0.9, at={SLOWED[0]}, lasts=0.6}}',
    f'{{target="process.recorder", kind="freeze", at={DEAF[0]}, lasts=0.4}}',
    f'{{target="process.controller", kind="restart", time=0.1, at={RESTARTED}}}',
)
RESTART = f'{{target="process.network", kind="restart", time={BACK}, at={CUT}}}'


def words(duration: float, path: Path, *faults: str) -> list[str]:
    """Of a run in which late ticks, safe states and refusals are no reason to fail."""
    changes = [*ALLOWED, f"duration={duration}", "expect=[]", f"fault=[{', '.join(faults)}]"]
    return [*(word for change in changes for word in ("--set", change)), *LOOSE, "--record", str(path), *UNDRAWN]


def suspended(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "T"
    except OSError:
        return False


def outages(recording: Recording, longest: float = 0.15) -> list[tuple[float, float]]:
    """Stretches [s] without a command for a sample."""
    stamps = np.unique(recording.columns("command")["sample_stamp"]) / 1e9
    gaps = np.flatnonzero(np.diff(stamps) > longest)
    return [(float(stamps[gap]), float(stamps[gap + 1])) for gap in gaps]


def late(recording: Recording, begin: float, end: float) -> int:
    return sum(begin < event.stamp / 1e9 < end for event in recording.messages("event") if event.kind == "late")


def safe(recording: Recording) -> list[float]:
    return [event.stamp / 1e9 for event in recording.messages("event") if event.kind == "safe"]


@pytest.mark.timed
def test_controller_and_recorder_are_frozen_slowed_and_restarted_each_in_its_window(tmp_path: Path):
    path = tmp_path / "a.mcap"
    with started("run", "step", *words(6.5, path, *EACH)) as run:
        pid, stood = child(run.pid, "record", 60.0), 0.0
        while run.poll() is None:
            stood += 0.02 * suspended(pid)
            time.sleep(0.02)
        assert run.stdout is not None
        assert "Traceback" not in run.stdout.read()
    recording = read(path)
    first, last = (min(begins for begins in safe(recording) if begins > at) for at in (FROZEN[0], RESTARTED))
    assert FROZEN[0] + 0.1 < first < FROZEN[1]
    assert RESTARTED + 0.1 < last < RESTARTED + 0.6
    assert late(recording, *SLOWED) >= 10
    assert late(recording, *SLOWED) > 2 * late(recording, SLOWED[1] + 0.1, 2 * SLOWED[1] - SLOWED[0])
    assert stood == pytest.approx(DEAF[1] - DEAF[0], abs=0.2)
    assert len(recording.columns("state")["tick"]) == 6501  # a recorder that stood still for a moment loses nothing
    sources = recording.columns("command")["source"]
    assert len(np.unique(sources)) == 2
    assert recording.columns("command")["sample_stamp"][sources == sources[-1]][0] > RESTARTED * 1e9


@pytest.mark.timed
def test_a_network_that_restarts_is_found_again_by_all(tmp_path: Path):
    path = tmp_path / "a.mcap"
    with started("run", "step", *words(3.0, path, RESTART)) as run:
        assert run.wait(90) in (0, 1)
    recording = read(path)
    ((begin, end),) = [gap for gap in outages(recording) if gap[1] > CUT]
    assert CUT - 0.1 < begin < CUT + 0.2
    assert end - begin > BACK
    assert recording.columns("state")["stamp"][-1] == 3_000_000_000
    assert recording.metadata["summary"]["lost"]["state"] > 1000 * BACK * 0.5  # what was sent into nowhere is counted


@pytest.mark.parametrize("mode", [Mode.LOCKSTEP, Mode.INPROCESS])
@pytest.mark.parametrize("fault", [*EACH, RESTART])
def test_where_nobody_can_be_late_faults_of_processes_are_refused_by_name(mode: Mode, fault: str):
    scenario = load("step", [f"fault=[{fault[:-1]}, name='the bad one'}}]"])
    with pytest.raises(ScenarioError, match=f"'the bad one'.*fails in real time only, {mode}"):
        refuse_processes(scenario, mode)
