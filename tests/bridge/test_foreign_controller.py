"""Somebody else's controller, in forty lines and without the project; and somebody's law inside ours."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

from bridge.recording.reader import Recording, read
from bridge.wire.link import free_endpoint
from bridge.wire.messages import TOPICS, struct_format
from tests.support.processes import ROOT, UNDRAWN, hydrotwin, started

EXAMPLES = ROOT / "examples"
FOREIGN = EXAMPLES / "foreign_controller.py"
STANDARD = {"random", "struct", "sys", "time"}


@contextmanager
def foreign_controller(endpoint: str) -> Iterator[subprocess.Popen[str]]:
    """The example at work; it connects once the plant listens."""
    command = [sys.executable, "-I", str(FOREIGN), endpoint]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def position_at(recording: Recording, time: float) -> float:
    """True position of the piston [m] at a time [s]."""
    state = recording.columns("state")
    return float(np.interp(time, state["stamp"] * 1e-9, state["position"]))


@pytest.fixture(scope="module")
def foreign_run(tmp_path_factory) -> Recording:
    """A run closed by the example; both processes must end well and in time."""
    path, endpoint = tmp_path_factory.mktemp("foreign") / "foreign.mcap", free_endpoint()
    options = ("--mode", "lockstep", "--external", "--duration", "3", "--set", "loop.delay=5 ms", "--patience", "20")
    command = ("run", "step", *options, "--listen", endpoint, "--record", str(path), *UNDRAWN)
    with started(*command) as run, foreign_controller(endpoint) as controller:
        assert run.wait(60) == 0, run.communicate()[0]
        assert controller.wait(10) == 0, controller.communicate()[0]
    return read(path)


def test_a_foreign_controller_moves_the_piston_to_its_targets(foreign_run):
    """160 mm in the first two seconds, then 120 mm; a P controller with its dead band jumped over stops within 1 mm."""
    assert position_at(foreign_run, 1.95) == pytest.approx(0.16, abs=1e-3)
    assert position_at(foreign_run, 3.0) == pytest.approx(0.12, abs=1e-3)


def test_every_command_of_a_foreign_controller_is_taken_in_time(foreign_run):
    result = foreign_run.metadata["summary"]
    assert result["commands"] == {
        "sent": 301,
        "late": 0,
        "worst_lateness": 0.0,
        "refused": {},
        "due": 300,
        "taken": 301,
    }
    assert not sum(result["lost"].values())
    command = foreign_run.columns("command")
    assert np.all(np.diff(command["sample_stamp"]) == 10_000_000)
    assert np.all(command["apply_at"] - command["sample_stamp"] == 5_000_000)


def test_the_foreign_controller_is_forty_lines_of_zenoh_and_struct():
    text = FOREIGN.read_text()
    imported = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert all(isinstance(node, ast.Import) for node in imported)
    names = {alias.name for node in imported for alias in node.names}
    assert {"zenoh", "struct"} <= names <= {"zenoh"} | STANDARD
    assert len(text.splitlines()) <= 40


def test_the_foreign_controller_has_the_layouts_of_our_messages():
    layouts = dict(re.findall(r'^(\w+) = struct\.Struct\("(.+?)"\)', FOREIGN.read_text(), re.MULTILINE))
    kinds = {"MEASUREMENT": TOPICS["measurement"].type, "COMMAND": TOPICS["command"].type}
    assert layouts == {name: struct_format(kind) for name, kind in kinds.items()}


def test_a_law_of_ones_own_moves_the_piston_to_the_target(tmp_path):
    """The built-in step to 160 mm, by the function in the working folder."""
    path = tmp_path / "law.mcap"
    options = (
        "--mode",
        "lockstep",
        "--duration",
        "2",
        "--set",
        "controller.kind=python",
        "--set",
        "controller.law=my_law:law",
    )
    done = hydrotwin("run", "step", *options, "--record", str(path), *UNDRAWN, cwd=EXAMPLES)
    assert done.returncode == 0, done.stdout + done.stderr
    recording = read(path)
    assert recording.scenario().controller.model_dump()["law"] == "my_law:law"
    assert position_at(recording, 2.0) == pytest.approx(0.16, abs=1e-3)
    assert recording.metadata["summary"]["commands"]["sent"] == 201
