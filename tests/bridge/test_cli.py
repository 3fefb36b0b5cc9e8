"""The command line as a newcomer meets it."""

import json
import re
import xml.etree.ElementTree as ET
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from bridge.cli.catalogue import VERBS as CATALOGUE
from bridge.cli.printing import print_differences
from bridge.cli.verbs import app
from bridge.recording.compare import Difference
from bridge.scenario.files import plain
from tests.support.command import hydrotwin_here
from tests.support.processes import ENVIRONMENT, UNDRAWN, hydrotwin

VERBS = (
    *("run", "check", "scenarios", "schema", "plant", "controller", "record", "router", "reset"),
    *("info", "compare", "recover", "export", "import", "replay", "remote"),
    *("advise", "map"),
    *("digest", "messages", "figure", "figures", "view", "doctor"),
)


def test_help_names_every_verb_there_is_and_the_exit_codes():
    """The words of the help, against those that the application has registered."""
    text = hydrotwin("--help").stdout
    listed = set(re.findall(r"^\W*([a-z]+)  +[A-Z]", text, re.MULTILINE))
    assert listed >= set(get_command(app).commands)  # pyright: ignore[reportAttributeAccessIssue]
    assert set(get_command(app).commands) >= set(VERBS)  # pyright: ignore[reportAttributeAccessIssue]
    assert "Exit codes" in text
    assert "--install-completion" in text


def test_the_version_is_that_of_the_package():
    done = CliRunner().invoke(app, ["--version"])
    assert (done.exit_code, done.output) == (0, f"hydrotwin {version('hydrotwin')}\n")


def test_differences_are_printed_in_bar_and_millimetres(capsys: pytest.CaptureFixture[str]):
    pressure = Difference("measurement.p2", "Pa", 10, 0, 2.5e5, 0.1, 1.5e5, 0.1, 2e4, passed=False)
    position = Difference("measurement.position", "m", 10, 0, 0.0, None, 0.0, None, 1e-4, passed=True)
    print_differences([pressure, position], as_json=False)
    printed = capsys.readouterr().out.split()
    assert [word for word, unit in pairwise(printed) if unit == "bar"] == ["2.5", "1.5", "0.2"]
    assert [word for word, unit in pairwise(printed) if unit == "mm"] == ["0", "0", "0.1"]


def test_the_list_of_verbs_says_what_each_says_of_itself():
    """The table that help is made from, against the commands."""
    commands: Any = get_command(app)
    found = {name: command.help.split("\n\n")[0] for name, command in commands.commands.items()}
    assert found == {name: verb.words for name, verb in CATALOGUE.items()}


@pytest.mark.parametrize(
    "words",
    [
        ("nonsense",),
        ("run",),
        ("run", "nonsense"),
        ("run", "step", "--mode", "nonsense"),
        ("run", "step", "--set", "loop.sample_period=1.5ms"),
        ("run", "step", "--speed", "0"),
        (
            "run",
            "step",
            "--set",
            "controller.kind=python",
            "--set",
            "controller.law=nobody:nothing",
            "--mode",
            "inprocess",
        ),
        ("run", "step", "--set", "loop.daq_period=0.0001", "--set", "loop.viewer_period=0.01"),
        ("digest", "nonsense.mcap"),
        ("figure", "nonsense"),
        ("check", "step", "nonsense", "--set", "duration=0.1"),
    ],
)
def test_wrong_use_exits_with_two_and_without_a_traceback(words, tmp_path):
    done = hydrotwin_here(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert done.stderr


def test_a_process_says_wrong_use_like_the_verb_called_here(tmp_path):
    words = ("run", "nonsense")
    there, here = hydrotwin(*words, cwd=tmp_path), hydrotwin_here(*words, cwd=tmp_path)
    assert (there.returncode, there.stdout, there.stderr) == (here.returncode, here.stdout, here.stderr)


def test_run_in_process_leaves_recording_picture_and_summary(tmp_path):
    done = hydrotwin("run", "step", "--mode", "inprocess", "--duration", "1.5", "--json", "s.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "s.json").read_text())
    assert found["metrics"]["rise_time"] == pytest.approx(0.13, abs=0.03)
    assert len(list((tmp_path / "runs").glob("step-*.mcap"))) == 1
    assert len(list((tmp_path / "runs").glob("step-*.png"))) == 1
    for word in ("rise time", "overshoot", "recording", "picture"):
        assert word in done.stdout


def test_run_prints_json_when_asked(tmp_path):
    done = hydrotwin_here("run", "step", "--mode", "inprocess", "--duration", "2", "--json", "-", cwd=tmp_path)
    assert json.loads(done.stdout)["ending"] == "complete after 2000 ticks"


def test_seed_and_set_change_the_run(tmp_path):
    for name, words in (("a", ()), ("b", ("--seed", "2")), ("c", ("--set", "controller.gain=0.5"))):
        run = ("run", "step", "--mode", "inprocess", "--duration", "1.2", "--record", f"{name}.mcap", *words, *UNDRAWN)
        assert hydrotwin_here(*run, cwd=tmp_path).returncode == 0
    assert hydrotwin_here("digest", "a.mcap", "a.mcap", cwd=tmp_path).returncode == 0
    for other in ("b.mcap", "c.mcap"):
        done = hydrotwin_here("digest", "a.mcap", other, cwd=tmp_path)
        assert done.returncode == 1
        assert "DIFFERS" in done.stdout
    assert set(json.loads(hydrotwin_here("digest", "a.mcap", "--json", cwd=tmp_path).stdout)) == {"a.mcap"}


def test_check_passes_good_scenarios_and_writes_junit(tmp_path):
    words = ("step", "slow-sampling", "delay", "--set", f"duration={SHORTER['delay']} s", "--junit", "j.xml")
    done = hydrotwin_here("check", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    root = ET.parse(tmp_path / "j.xml").getroot()
    assert [suite.get("name") for suite in root] == ["step", "slow-sampling", "delay"]
    assert not list(root.iter("failure"))
    assert len(list((tmp_path / "runs").glob("check-*/*.mcap"))) == 3


def test_check_fails_a_detuned_loop_with_a_reason(tmp_path):
    words = ("step", "--set", "controller.gain=8", "--set", "duration=3", "--junit", "j.xml")
    done = hydrotwin_here("check", *words, cwd=tmp_path)
    assert done.returncode == 1
    assert "limit cycle amplitude <= 0.4 mm" in done.stdout
    assert "FAILED" in done.stdout
    messages = [failure.get("message") or "" for failure in ET.parse(tmp_path / "j.xml").getroot().iter("failure")]
    assert any("mm, at" in message and "Hz" in message for message in messages)


SHORTER = {  # [s], where the bands judge the same; whole among the long trials
    "step": 4,
    "slow-sampling": 5,
    "delay": 5,
    "square": 9,
    "sine": 6,
    "pid": 6,
    "relay": 3,
    "hold-load": 40,
}


def sooner(name: str) -> tuple[str, ...]:
    """Changes that shorten a built-in scenario, and the windows of its bands that would reach beyond."""
    bands = [re.sub(r"to 300 s", f"to {SHORTER[name]} s", band) for band in plain(name)["expect"]]
    return ("--set", f"duration={SHORTER[name]} s", "--set", f"expect={bands}")


@pytest.mark.parametrize("name", ["square", "sine", "hold-load", "pid", "relay"])
def test_check_passes_the_other_built_in_scenarios(name, tmp_path):
    done = hydrotwin_here("check", name, *sooner(name), cwd=tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.endurance
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", SHORTER)
def test_check_passes_the_long_scenarios_whole(name, tmp_path):
    done = hydrotwin_here("check", name, cwd=tmp_path)
    assert done.returncode == 0, done.stdout


def test_the_stable_gain_of_slow_sampling_is_stable_at_a_millisecond(tmp_path):
    """Apart from the hops across the overlap, which the compensation makes of the least error whatever the gain."""
    hops = "expect=['limit cycle amplitude <= 0.4 mm']"
    short = ("--set", f"duration={SHORTER['delay']} s", "--set", hops)
    fast = ("--set", "loop.sample_period=0.001", *short)
    assert hydrotwin_here("check", "slow-sampling", *fast, cwd=tmp_path).returncode == 0
    prompt = ("--set", "loop.delay=0", *short)
    assert hydrotwin_here("check", "delay", *prompt, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("verb", ["scenarios", "messages", "figures"])
def test_lists_come_as_json_too(verb, tmp_path):
    assert json.loads(hydrotwin_here(verb, "--json", cwd=tmp_path).stdout)


def test_messages_print_formats_and_definitions(tmp_path):
    text = hydrotwin_here("messages", cwd=tmp_path).stdout
    assert "<4x3Q2qd" in text
    assert "float64 spool" in text


def test_the_schema_is_json_schema(tmp_path):
    schema = json.loads(hydrotwin_here("schema", cwd=tmp_path).stdout)
    assert schema["properties"]["loop"]


def test_completion_can_be_shown(monkeypatch):
    """Of a shell that is named, whatever shell the tests were started from."""
    monkeypatch.setitem(ENVIRONMENT, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    done = hydrotwin("--show-completion", "bash")
    assert done.returncode == 0
    assert "complete" in done.stdout + done.stderr
