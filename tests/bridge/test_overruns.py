"""What a plant does when the machine was too slow, by `real_time.on_overrun`: a plant that was held for 0.4 s."""

import json
import re
import signal
import time

import pytest

from bridge.wire.link import free_endpoint
from tests.support.processes import COARSE, LOOSE, started, with_signal

HELD, LENGTH = 0.4, 1.5  # [s]
STATUS = re.compile(r"^\{.*\}$", re.MULTILINE | re.DOTALL)


def held(policy: str, *limits: str) -> tuple[int, str, float]:
    """Exit code, what the plant says, and how long it took from being heard to its end [s]."""
    changes = ("--set", f"real_time.on_overrun={policy}", "--set", "real_time.grace=0", *limits, *COARSE)
    where = free_endpoint()
    command = ("plant", "step", "--set", f"duration={LENGTH}", *changes, "--listen", where, "--json")
    with started(*command) as plant:
        assert plant.stdout is not None
        heard = plant.stdout.readline()
        begin = time.monotonic()
        time.sleep(0.3)
        with_signal(plant.pid, signal.SIGSTOP)
        time.sleep(HELD)
        with_signal(plant.pid, signal.SIGCONT)
        output, _ = plant.communicate(timeout=60)
    return plant.returncode, heard + output, time.monotonic() - begin


def told(output: str) -> dict:
    """The plant's own last words."""
    found = STATUS.search(output)
    assert found is not None, output
    return json.loads(found[0])


@pytest.mark.parametrize(("policy", "behind"), [("catch-up", False), ("skip", True)])
def test_a_plant_catches_up_or_stays_behind_by_whole_periods(policy: str, behind: bool):
    """Every tick is integrated in both; only the clock's share of it differs."""
    _, output, took = held(policy, *LOOSE)
    last = told(output)
    assert last["tick"] == last["ticks"] == 150
    assert last["overruns"] >= 1
    if behind:
        assert last["skipped"] >= 0.9 * HELD / 10e-3
        assert took > LENGTH + 0.5 * HELD
    else:
        assert "skipped" not in last
        assert last["longest_burst"] >= 0.9 * HELD / 10e-3


def test_a_plant_that_may_not_be_late_ends_and_says_why():
    code, output, _ = held("stop", "--set", "real_time.length=0.2", "--set", "real_time.overruns=1.0")
    assert code == 1
    assert "by at most 200 ms (length), and on_overrun is 'stop'" in output
