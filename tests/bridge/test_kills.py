"""One process of a run is killed at a random moment: the run names it, the recording can be had, nobody is left."""

import random
import signal
from pathlib import Path
from typing import Any

import pytest

from bridge.machine.process import Stop
from bridge.processes.child import Child
from bridge.processes.failing import Failing
from bridge.processes.options import RunOptions
from bridge.processes.supervisor import Supervisor
from bridge.scenario import load
from bridge.wire.messages import Mode
from tests.support.kills import PHASES, ROLES, Killed, kill_one
from tests.support.processes import IMPATIENT, with_signal

KILLS = 50  # of each process in each phase


def assert_in_order(found: Killed, role: str, phase: str) -> None:
    assert "Traceback" not in found.words
    assert not found.left
    assert found.readable in ("", "whole", "recovered")
    if phase == "running":
        assert found.readable
    if role == "supervisor":
        return  # who is killed cannot speak
    named = [line for line in found.words.splitlines() if f"the {role} (pid " in line]
    killed = [line for line in named if "was killed" in line]
    assert found.code == len(killed) <= 1  # 0: it had ended before
    assert killed or phase == "ending"


@pytest.mark.parametrize("role", ["plant", "record", "router"])
def test_a_kill_is_named_in_one_line_and_the_recording_is_there(tmp_path: Path, role: str):
    """Controller and supervisor: test_processes.py."""
    assert_in_order(kill_one(role, "running", random.Random(3), tmp_path, IMPATIENT), role, "running")


def supervisor(folder: Path) -> Supervisor:
    options = RunOptions(Mode.REALTIME, folder / "a.mcap")
    return Supervisor(load("step"), options, lambda *_: None, Stop())


def test_a_kill_while_all_are_ended_is_named_and_our_own_are_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The plant gets it, the others our SIGTERM."""

    def kill(run: Supervisor, endpoint: str) -> None:
        with_signal(run.children[0].process.pid, signal.SIGKILL)

    monkeypatch.setattr(Supervisor, "_watch", kill)
    run = supervisor(tmp_path)
    assert run.run() == [f"the plant (pid {run.children[0].process.pid}) was killed by SIGKILL"]
    assert len(run.children) == 3


def test_a_kill_between_two_looks_of_the_last_turn_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Whoever is found gone is asked what for after that, not before."""

    class Fleeting(Child):
        """Killed at the moment at which somebody asks whether it has ended."""

        def __init__(self) -> None:
            self.role, self.gone = "plant", False

        def ended(self) -> bool:
            self.gone = True
            return True

        def fault(self) -> str | None:
            return "the plant was killed" if self.gone else None

        def killed(self) -> bool:
            return False

        def notes(self) -> list[str]:
            return []

        def end(self) -> None:
            """It has."""

        ask = end

    def start(run: Any, *_: object) -> None:
        run.children, run._failing = [Fleeting()], Failing(run.scenario, 1.0, lambda *_: run.children[0])

    monkeypatch.setattr(Supervisor, "_start", start)
    monkeypatch.setattr(Supervisor, "_listen", lambda *_: None)
    assert supervisor(tmp_path).run() == ["the plant was killed"]


@pytest.mark.endurance
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("role", ROLES)
def test_fifty_kills(tmp_path: Path, role: str, phase: str):
    rng = random.Random(f"{role} {phase}")
    for turn in range(KILLS):
        (folder := tmp_path / str(turn)).mkdir()
        found = kill_one(role, phase, rng, folder)
        print(f"{role} {phase} {turn}: code {found.code}, recording {found.readable or 'none'}", flush=True)
        assert_in_order(found, role, phase)
