"""Nothing hangs on a value without sense, such as one whose unit was forgotten: it is refused, or it has a bound."""

import signal
import subprocess
import sys

import numpy as np
import pytest

from bridge.errors import ScenarioError
from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from bridge.studies.stability.amplitude import loop_of
from controller.stability.amplitude.edges import LEAST, LONGEST, SLOWEST, lasting
from controller.stability.amplitude.run import COARSEST
from tests.support.processes import ENVIRONMENT, ROOT

WAITING = """
import time
from bridge.cli.streams import done_when_interrupted
with done_when_interrupted(lambda: print("the summary")):
    print("waiting", flush=True)
    time.sleep(60)
"""
IN_A_WRITE = """
import io, os, signal, sys

class Raw(io.RawIOBase):
    def writable(self):
        return True
    def write(self, data):
        written = os.write(1, data)
        if bytes(data).startswith(b"waiting"):
            signal.raise_signal(signal.SIGINT)
        return written

sys.stdout = io.TextIOWrapper(io.BufferedWriter(Raw()))
"""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("loop.step=1e-9", "is 1187335 steps, limit 50000; take a larger loop.step"),
        ("rig.pipe_1.length=1e6", "is 17590150 steps, limit 50000; take a larger loop.step, a shorter pipe"),
    ],
)
def test_a_pipe_of_too_many_steps_is_refused_before_its_filters_are_fitted(change: str, words: str):
    with pytest.raises(ScenarioError, match=words):
        circuit_of(load("step", [change]))


@pytest.mark.parametrize(
    ("change", "words"),
    [("loop.sample_period=10", "beyond the theory.*a unit may be missing"), ("reference.end=160", "160 mm")],
)
def test_what_the_theory_does_not_reach_names_the_unit_that_may_be_missing(change: str, words: str):
    with pytest.raises(ScenarioError, match=words):
        loop_of(load("step", [change]))


def test_a_run_of_the_theory_has_a_longest_time_whatever_the_loop():
    """So no run has more than 200 thousand steps beyond the whole periods that it is rounded up to."""
    for period in np.geomspace(1e-3, SLOWEST, 40).tolist():
        for delay in (0.0, 0.01, 1.0, 10.0):
            assert lasting(period, delay) <= max(LONGEST, LEAST * period) + period
    assert LONGEST == LEAST * SLOWEST
    assert LONGEST / COARSEST <= 200_000


def test_ctrl_c_while_more_is_computed_leaves_what_is_known():
    """It ends by the signal, as ever, and what it was to say first is out."""
    command = [sys.executable, "-c", WAITING]
    with subprocess.Popen(command, cwd=ROOT, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "waiting\n"
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=30)
    assert rest == "the summary\n"
    assert process.returncode == -signal.SIGINT


def test_ctrl_c_in_the_middle_of_a_write_loses_nothing_and_repeats_nothing():
    command = [sys.executable, "-c", IN_A_WRITE + WAITING]
    done = subprocess.run(command, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, timeout=30)
    assert done.stdout == "waiting\nthe summary\n"
    assert done.returncode == -signal.SIGINT
