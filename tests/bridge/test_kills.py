"""One process of a run is killed at a random moment: the run names it, the recording can be had, nobody is left."""

import random
from pathlib import Path

import pytest

from tests.support.kills import PHASES, ROLES, Killed, kill_one

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
    assert (found.code == 1 and len(killed) == 1) or phase == "ending"  # there it may have ended before


@pytest.mark.timed
@pytest.mark.parametrize("role", ["plant", "record", "router"])
def test_a_kill_is_named_in_one_line_and_the_recording_is_there(tmp_path: Path, role: str):
    """Controller and supervisor: test_processes.py."""
    assert_in_order(kill_one(role, "running", random.Random(3), tmp_path), role, "running")


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
