"""Every verb that has --json prints JSON alone on standard output; whatever else it has to say is on standard error."""

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from bridge.cli.verbs import app
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.link import free_endpoint

SHORT = ("--set", "duration=0.1")
ALONE = {  # what each verb is called with; FILE is a recording
    "run": ("step", "--mode", "inprocess", *SHORT, "--record", "r.mcap", "--json", "-"),
    "check": ("step", *SHORT, "--json"),
    "sweep": ("step", "controller.gain=1,2", *SHORT, "--workers", "1", "-o", "sweep", "--json"),
    "tune": (
        "step",
        "--vary",
        "controller.gain=1:2",
        *SHORT,
        "--workers",
        "1",
        "--runs",
        "30",
        "-o",
        "t.toml",
        "--json",
    ),
    "identify": ("MOVING", "--fit", "rig.load.mass", "--workers", "1", "-o", "fitted.toml", "--json"),
    "campaign": ("CAMPAIGN", "-o", "campaign", "--workers", "1", "--json"),
    "scenarios": ("--json",),
    "faults": ("--json",),
    "describe": ("step", "--json"),
    "convergence": ("step", *SHORT, "--json"),
    "linearise": ("step", "--json"),
    "advise": ("relay", "--step", "20mm", "--json"),
    "dimensionless": ("slow-sampling", "--at", "gamma=0.23", "--json"),
    "map": ("--cells", "4", "-o", "map", "--json"),
    "report": ("FILE", "-o", "r.html", "--json"),
    "info": ("FILE", "--json"),
    "compare": ("FILE", "FILE", "--json"),
    "recover": ("FILE", "-o", "whole.mcap", "--json"),
    "export": ("FILE", "--csv", "--json"),
    "import": ("LOG", "--map", "MAP", "--json"),
    "follow": ("FILE", "-o", "followed.mcap", "--json"),
    "whatif": ("FILE", "--horizon", "0.1 s", "--json"),
    "digest": ("FILE", "FILE", "--json"),
    "fmu plant": ("step", "-o", "rig.fmu", "--json"),
    "fmu controller": ("step", "-o", "law.fmu", "--json"),
    "messages": ("--json",),
    "figures": ("--json",),
    "figure": ("2.14", "--json"),
    "line": ("--json",),
    "doctor": ("--json",),
    "valve static": ("--json",),
    "valve seat": ("--json",),
    "valve chatter": ("--json",),
    "valve chart": ("--cells", "2", "--workers", "1", "--json"),
}
CAMPAIGN = 'scenarios = ["step"]\n[common]\nduration = "0.1 s"\n'
LOG = "t_s,x_mm\n0,100\n0.001,101\n0.002,102\n"
MAP = 'rig = "ehla"\n[time]\ncolumn = "t_s"\n[signal.position]\ncolumn = "x_mm"\n'
ON_A_BUS = {"plant", "record", "reset", "replay", "remote", "get", "set", "fault", "watch", "status"}


def strict(text: str) -> object:
    """What other programs read: Python alone takes NaN and Infinity, too."""

    def refuse(word: str) -> object:
        raise ValueError(f"{word} is not JSON")

    return json.loads(text, parse_constant=refuse)


def verbs(command: object, name: str = "") -> Iterator[str]:
    """Every verb of the application that has --json."""
    for word, below in getattr(command, "commands", {}).items():
        yield from verbs(below, f"{name} {word}".strip())
    if any("--json" in option.opts for option in getattr(command, "params", [])):
        yield name


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("json") / "run.mcap"
    return record_in_process(load("step", ["duration=0.2", "controller.kind=open-loop"]), path).path


@pytest.fixture
def moving(recorded: Path) -> str:
    """A recording in which the rod moves; made by whoever asks first."""
    path = recorded.parent / "moving.mcap"
    if not path.is_file():
        record_in_process(load("ehla", ["duration=1.4"]), path)
    return str(path)


def test_no_verb_is_forgotten():
    assert set(verbs(typer.main.get_command(app))) == {*ALONE, *ON_A_BUS}


@pytest.mark.parametrize("verb", ALONE)
def test_a_verb_prints_json_alone(
    verb: str, recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "campaign.toml").write_text(CAMPAIGN, encoding="utf-8")
    (tmp_path / "log.csv").write_text(LOG, encoding="utf-8")
    (tmp_path / "map.toml").write_text(MAP, encoding="utf-8")
    files = {"FILE": str(recorded), "CAMPAIGN": "campaign.toml", "LOG": "log.csv", "MAP": "map.toml"}
    if "MOVING" in ALONE[verb]:
        files["MOVING"] = request.getfixturevalue("moving")
    words = [files.get(word, word) for word in (*verb.split(), *ALONE[verb])]
    done = CliRunner().invoke(app, words)
    assert done.exit_code in (0, 1), done.output
    assert strict(done.stdout)


def begun(*words: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "bridge", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def said(process: "subprocess.Popen[str]") -> object:
    return strict(process.communicate(timeout=60)[0])


def repeated(*words: str) -> object:
    """What a short verb says once its other side is there."""
    for _ in range(20):
        process = begun(*words)
        text = process.communicate(timeout=60)[0]
        if process.returncode == 0:
            return strict(text)
        time.sleep(0.2)
    raise TimeoutError(f"{words} never found its other side")


def test_verbs_of_a_loop_print_json_alone(tmp_path: Path):
    """plant, record and reset, around a run in real time without a controller."""
    address = free_endpoint()
    short = ("--set", "duration=3", "--set", "real_time.overruns=1.0", "--set", "real_time.length=100")
    wait = ("--patience", "60")
    plant = begun("plant", "step", *short, "--listen", address, *wait, "--await", "recorder", "--json")
    assert repeated("reset", "--connect", address, "--json")
    record = begun("record", "-o", str(tmp_path / "a.mcap"), "--connect", address, *wait, "--json")
    assert said(plant)
    assert said(record)


def test_replay_and_its_remote_control_print_json_alone(recorded: Path):
    address = free_endpoint()
    replay = begun("replay", str(recorded), "--listen", address, "--paused", "--json")
    assert repeated("remote", "quit", "--connect", address, "--json")
    assert said(replay)
