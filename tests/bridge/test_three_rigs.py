"""Several rigs on one network: three plants and three controllers meet at one router, by the names of their rigs."""

import json
from contextlib import ExitStack
from pathlib import Path

import pytest

from bridge.runs.in_process import run_in_memory
from bridge.scenario import load
from bridge.wire.link import Link, free_endpoint, open_session
from tests.support.processes import started, wait_for

RIGS = {"press": 130, "lift": 150, "ladle": 190}  # end of the step [mm]
SECONDS = 0.3


def changes(rig: str) -> list[str]:
    step = ["reference.at=0.02", f"reference.end={RIGS[rig]} mm"]
    return [f"rig_name={rig}", f"duration={SECONDS}", "expect=[]", *step]


def test_each_controller_moves_its_own_rig(tmp_path: Path):
    """In lockstep, which is exact: every rig ends where it ends alone, to the last bit."""
    endpoint = free_endpoint()
    reached = ("--connect", endpoint, "--mode", "lockstep", "--quiet", "--patience", "60")
    with ExitStack() as stack:
        stack.enter_context(started("router", "--listen", endpoint, cwd=tmp_path))
        plants = {}
        for rig in RIGS:
            words = [word for change in changes(rig) for word in ("--set", change)]
            plants[rig] = stack.enter_context(started("plant", "step", *words, *reached, "--json", cwd=tmp_path))
            stack.enter_context(started("controller", "step", *words, *reached, cwd=tmp_path))
        for rig, plant in plants.items():
            assert plant.wait(90) == 0
            assert plant.stdout is not None
            told = json.loads(plant.stdout.read())
            alone = run_in_memory(load("step", changes(rig)))
            assert told["commands"] == round(SECONDS * 100) + 1
            assert told["position"] == alone.columns("measurement")["position"][-1]


def test_nobody_is_found_who_was_not_named(tmp_path: Path):
    """Nothing is announced by multicast: two peers on one machine do not know of one another unless told."""
    links = [Link(free_endpoint(), None, None, 1.0) for _ in range(2)]
    with open_session(links[0]) as one, open_session(links[1]) as other:
        wait_for(lambda: one.info.zid() != other.info.zid(), 1.0)
        assert list(one.info.peers_zid()) == list(other.info.peers_zid()) == []
        with open_session(Link(None, links[0].listen, None, 5.0)) as client:
            assert list(client.info.peers_zid()) == [one.info.zid()]


@pytest.mark.parametrize("rig", RIGS)
def test_the_rigs_differ(rig: str):
    """Else the first test would not see a mistaken one."""
    others = [run_in_memory(load("step", changes(name))).columns("state")["position"][-1] for name in RIGS]
    own = run_in_memory(load("step", changes(rig))).columns("state")["position"][-1]
    assert others.count(own) == 1
