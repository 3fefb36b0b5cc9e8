"""Common and uncommon places: folders, disks, streams and locales that refuse get one line, never a traceback."""

import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from bridge.cli.verbs import app
from bridge.errors import RunError, ScenarioError, UsageError, visible, writing
from bridge.recording import sink
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire import link

ROOT = Path(__file__).parents[2]
SHORT = ["--set", "duration=0.1"]


def hydrotwin(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


def command(text: str, folder: Path, **environment: str) -> "subprocess.CompletedProcess[str]":
    """A shell's command line; `ht` stands for the command of these sources."""
    text = text.replace("ht ", f"{sys.executable} -m bridge ")
    variables = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {text}"],
        cwd=folder,
        env=variables,
        capture_output=True,
        text=True,
        timeout=100,
    )


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_picture_that_is_refused_does_not_hide_the_summary(here: Path):
    (here / "a.png").mkdir()
    done = hydrotwin("run", "step", "--mode", "inprocess", "--duration", "0.1", "--record", "a.mcap")
    assert done.exit_code == 1
    assert "complete after" in done.output
    assert "a.png: cannot be written: Is a directory" in done.output


@pytest.mark.parametrize(("verb", "option"), [("check", "--junit"), ("run", "--json")])
def test_a_result_that_cannot_be_written_is_printed_all_the_same(here: Path, verb: str, option: str):
    (here / "file").touch()
    where = ["-o", "out"] if verb == "check" else ["--mode", "inprocess", "--record", "a.mcap"]
    done = hydrotwin(verb, "step", "--set", "duration=0.1", "--set", "expect=[]", *where, option, "file/j")
    assert done.exit_code == 1
    assert done.stdout
    assert done.stderr == "hydrotwin: file/j: cannot be written: Not a directory\n"


def test_a_recording_that_cannot_be_begun_names_the_way_out(here: Path):
    (here / "runs").touch()
    done = hydrotwin("run", "step", "--mode", "inprocess", *SHORT, "--record", "runs/a.mcap")
    assert done.exit_code == 1
    assert "runs/a.mcap: Not a directory; record elsewhere: --record FILE" in done.stdout


def test_an_earlier_recording_is_not_taken_for_the_one_that_was_refused(here: Path, monkeypatch: pytest.MonkeyPatch):
    record_in_process(load("step", ["duration=0.1"]), here / "a.mcap")

    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied", "a.mcap")

    monkeypatch.setattr(sink.os, "open", refuse)
    done = hydrotwin("run", "step", "--mode", "inprocess", *SHORT, "--record", "a.mcap")
    assert done.exit_code == 1
    assert "complete" not in done.output


def fill_up(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """A disk with room for so many bytes."""
    real, room = os.write, [most]

    def write(file: int, data: memoryview) -> int:
        if len(data) > room[0]:
            raise OSError(28, "No space left on device")
        room[0] -= len(data)
        return real(file, data)

    monkeypatch.setattr(sink.os, "write", write)


def test_a_disk_that_fills_up_leaves_a_recording_that_says_why_it_ends(here: Path, monkeypatch: pytest.MonkeyPatch):
    fill_up(monkeypatch, 100_000)
    monkeypatch.setattr(sink.Sink, "_free_reserve", lambda self: monkeypatch.undo())  # as closing the reserve does
    with pytest.raises(RunError, match=r"a\.mcap: No space left on device: nothing from about t = \d"):
        record_in_process(load("step", ["duration=3"]), here / "a.mcap")
    left = read(here / "a.mcap")
    assert left.counts["state"] > 100
    assert left.metadata["refused"]["reason"] == "No space left on device"


def test_a_full_disk_costs_one_scenario_its_verdict_and_not_the_others(here: Path, monkeypatch: pytest.MonkeyPatch):
    fill_up(monkeypatch, 100_000)
    done = hydrotwin("check", "step", "pid", "--set", "duration=1.5", "-o", "m", "--junit", "j.xml")
    assert done.exit_code == 1
    assert "Traceback" not in done.output
    suites = ET.parse(here / "j.xml").getroot()
    assert [suite.get("name") for suite in suites] == ["step", "pid"]
    failures = [[failure.get("message") or "" for failure in suite.iter("failure")] for suite in suites]
    assert any("No space left on device" in message for message in failures[0])


@pytest.mark.parametrize(
    "name", ["../../out", "/tmp/out", "a/../../out", "..", "", " ", "a\\..\\b", "x" * 300, "a\x1b[2J"]
)
def test_names_that_no_recording_can_have_are_refused(name: str):
    with pytest.raises(ScenarioError, match="name"):
        load("step", [f"name={json.dumps(name)}"])


@pytest.mark.parametrize("name", ["rig [/lab]", "[bold]x", "[/]", "Prüfstand 2 (µ)"])
def test_names_are_shown_as_they_are(here: Path, name: str):
    done = hydrotwin(
        "check",
        "step",
        *SHORT,
        "--set",
        f"name={json.dumps(name, ensure_ascii=False)}",
        "-o",
        "runs",
        "--junit",
        "j.xml",
    )
    assert name in done.stdout
    assert ET.parse(here / "j.xml").getroot()[0].get("name") == name


def test_control_characters_are_spelled_out():
    assert visible("a\x1b[2Jb\x00\u2028\udce4µ") == r"a\x1b[2Jb\x00\u2028\udce4µ"


def test_what_is_written_names_its_file_whatever_the_system_says(tmp_path: Path):
    """A full disk names no file of its own."""
    refused = pytest.raises(RunError, match=r"x/a\.csv: cannot be written: No space left on device")
    with refused, writing(tmp_path / "x" / "a.csv"):
        raise OSError(28, "No space left on device")


def test_without_ipv4_the_loop_runs_over_ipv6(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(link, "LOOPBACK", ((link.socket.AF_INET, "192.0.2.1", "192.0.2.1"), *link.LOOPBACK[1:]))
    assert link.free_endpoint().startswith("tcp/[::1]:")


def test_without_any_loopback_one_line_says_so(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(link, "LOOPBACK", ((link.socket.AF_INET, "192.0.2.1", "192.0.2.1"),))
    with pytest.raises(RunError, match="no loopback address"):
        link.free_endpoint()


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("ht scenarios >&-", 1, "cannot write to standard output"),
        ("ht schema > /dev/full", 1, "cannot write to standard output"),
        ("ht scenarios > /dev/full", 1, "cannot write to standard output"),
        ("ht schema | true", 1, ""),
        ("ht scenarios <&- 2>&- | grep -q step", 0, ""),
        ("ht describe nonsense >&-", 2, "nonsense: no such scenario"),
    ],
)
def test_streams_that_refuse_get_a_line_at_most(tmp_path: Path, text: str, code: int, words: str):
    done = command(text, tmp_path)
    assert done.returncode == code
    assert done.stderr.count("\n") == bool(words)
    assert words in done.stderr


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (("record", "--connect", "127.0.0.1:17490"), "tcp/127.0.0.1:17490"),
        (("run", "step", "--listen", "17448"), "tcp/127.0.0.1:17448"),
        (("plant", "--listen", "[::1]:7000"), "tcp/[::1]:7000"),
        (("plant", "--connect", "rig.local"), "tcp/rig.local:7447"),
        (("router", "--listen", "localhost:1"), "tcp/localhost:1"),
        (("reset", "--connect", ""), "tcp/127.0.0.1:7447"),
        (("controller", "--connect", "tcp:/1"), "begins with its protocol"),
        (("view", "--connect", "127.0.0.1:1"), "tcp/127.0.0.1:1"),
        (("replay", "a.mcap", "--connect", "127.0.0.1:1"), "tcp/127.0.0.1:1"),
    ],
)
def test_an_address_without_its_protocol_is_answered_with_one_that_has_it(words: tuple[str, ...], meant: str):
    result = hydrotwin(*words)
    assert isinstance(result.exception, UsageError)
    assert meant in str(result.exception)


def test_an_address_that_zenoh_refuses_is_one_line():
    for refused in ("nonsense/127.0.0.1:1", "tcp/127.0.0.1:1?a#"):
        with pytest.raises(link.LinkError, match="nobody answers at"):
            link.open_session(link.Link(None, refused, None, 0.2))


@pytest.mark.parametrize("text", ["ht scenarios", "ht schema > /dev/null; ht figure 2.2"])
def test_a_working_folder_that_was_removed_is_named(tmp_path: Path, text: str):
    (tmp_path / "gone").mkdir()
    done = command(f"cd gone; rmdir ../gone; {text}", tmp_path)
    assert "the working folder no longer exists" in done.stderr.splitlines()[-1]
    assert "Traceback" not in done.stderr
    assert done.returncode == 1


@pytest.mark.parametrize("locale", ["C", "en_US.ISO-8859-1"])
def test_files_are_utf_8_in_any_locale(tmp_path: Path, locale: str):
    (tmp_path / "own.toml").write_text('extends = "step"\ntitle = "Größe µ"\nduration = "0.1 s"\n', encoding="utf-8")
    run = "ht check own.toml --junit j.xml -o m; ht info m/own.mcap; ht info m/own.mcap --json"
    done = command(run, tmp_path, LC_ALL=locale, PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
    assert "Traceback" not in done.stderr
    assert done.returncode == 0
    assert json.loads(done.stdout[done.stdout.index("\n{") :])["title"] == "Größe µ"
    assert ET.parse(tmp_path / "j.xml").getroot().tag == "testsuites"
