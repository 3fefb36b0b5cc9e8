"""`hydrotwin campaign`: runs judged as single ones are; interrupted, resumed and shared, the same bytes."""

import csv
import json
import re
import shlex
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

import hydrotwin as ht
from bridge.studies.sweep.journal import Journal
from tests.support.command import hydrotwin_here
from tests.support.processes import ENVIRONMENT

SHORT = """
scenarios = ["step"]
metrics = ["rms error", "mean p1 from 100 ms to end"]
[common]
duration = "0.2 s"
reference.at = "50 ms"
expect = [{id = "HYD-7", text = "stays near", band = "max error <= 60.5 mm"}]
"""
WHOLE = (
    SHORT
    + """
[parameters]
controller.gain = ["1 V/%", "2 V/%"]
[faults.push]
title = "somebody leans on it"
[[faults.push.timeline]]
set = "rig.load.force"
at = "100 ms"
to = "-6000 N"
[margin]
delay = "0 ms:20 ms:2"
loss = ["0 %", "90 %"]
"""
)
ONE = ("--workers", "1")


def write(folder: Path, text: str) -> str:
    (folder / "c.toml").write_text(text)
    return "c.toml"


def table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the whole campaign leaves."""
    folder = tmp_path_factory.mktemp("whole")
    done = hydrotwin_here("campaign", write(folder, WHOLE), *ONE, "-o", "c", cwd=folder)
    assert done.returncode == 1, done.stderr
    return folder / "c"


def test_a_row_is_what_a_single_run_says(whole: Path):
    """The run with the push and the second gain, asked for by hand: its bands and metrics are those of the row."""
    rows = table(whole / "campaign.csv")
    assert [(row["fault"], row["controller.gain"]) for row in rows] == [
        *(("none", "1 V/%"), ("none", "2 V/%")),
        *(("push", "1 V/%"), ("push", "2 V/%")),
    ]
    push = 'timeline=[{set = "rig.load.force", at = "100 ms", to = "-6000 N"}]'
    band = 'expect=["max error <= 60.5 mm"]'
    run = ht.run("step", changes=["duration=0.2 s", "reference.at=50 ms", "controller.gain=2 V/%", push, band])
    assert rows[3]["rms error [mm]"] == f"{run.metrics.rms_error * 1e3:.9g}"
    assert rows[3]["HYD-7: max error [mm]"] == f"{run.metrics.max_error * 1e3:.9g}"
    assert rows[3]["not kept"].count("HYD-7") == (not run.bands[0].passed)
    assert rows[3]["passed"] == "no"


def test_junit_names_runs_bands_and_requirements(whole: Path):
    suites = ET.parse(whole / "campaign.xml").getroot()
    rows = table(whole / "campaign.csv")
    assert [suite.get("name") for suite in suites][3] == "step / push / controller.gain=2 V/% / seed 1"
    assert [int(suite.get("failures", "0")) > 0 for suite in suites] == [row["passed"] == "no" for row in rows]
    properties = {(p.get("name"), p.get("value")) for p in suites.iter("property")}
    assert {("requirement", "HYD-7"), ("requirement text", "stays near")} <= properties


def test_the_page_stands_alone_and_shows_the_worst_first(whole: Path):
    page = (whole / "campaign.html").read_text()
    assert not re.search(r'(src|href)="?(https?:|//|[\w/]+\.\w+)', page.replace("http://www.w3.org", ""))
    assert page.count("<svg") >= page.count("<h3") >= 1
    shown = [int(number) for number in re.findall(r"<h3 id='run(\d+)'", page)]
    rows = {int(row["run"]): row for row in table(whole / "campaign.csv")}
    assert all(rows[number]["passed"] == "no" for number in shown)
    assert "somebody leans on it" in page


def test_interrupted_resumed_and_shared_campaigns_write_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    words = ("campaign", write(tmp_path, WHOLE), "--shrink", "push.timeline.1.to")
    hydrotwin_here(*words, "--workers", "1", "-o", "one", cwd=tmp_path)
    hydrotwin_here(*words, "--workers", "2", "-o", "two", cwd=tmp_path)
    add = Journal.add

    def stop(self, point, result):
        add(self, point, result)
        if len(self.found) in (2, 12):
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(Journal, "add", stop)
        for kept in (2, 12):  # in the runs, then in the search for the smallest fault
            assert hydrotwin_here(*words, *ONE, "-o", "cut", cwd=tmp_path).returncode == 130
            assert len((tmp_path / "cut/campaign.part").read_text().splitlines()) == 1 + kept
    assert hydrotwin_here(*words, *ONE, "-o", "cut", cwd=tmp_path).returncode == 1
    files = [{path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("one", "two", "cut")]
    assert sorted(files[0]) == ["campaign.csv", "campaign.html", "campaign.xml", "margins.csv"]
    assert files[0] == files[1] == files[2]


def test_lockstep_finds_the_same_numbers(tmp_path: Path):
    text = SHORT.replace("scenarios", 'mode = "lockstep"\nscenarios')
    hydrotwin_here("campaign", write(tmp_path, text), *ONE, "-o", "lock", cwd=tmp_path)
    hydrotwin_here("campaign", write(tmp_path, SHORT), *ONE, "-o", "here", cwd=tmp_path)
    assert (tmp_path / "lock/campaign.csv").read_bytes() == (tmp_path / "here/campaign.csv").read_bytes()


def test_ctrl_c_ends_it_within_a_second_and_says_how_to_continue(tmp_path: Path):
    words = ["campaign", write(tmp_path, f"seeds = 400\n{SHORT}"), "--workers", "1"]
    command = [sys.executable, "-m", "bridge", *words]
    with subprocess.Popen(command, cwd=tmp_path, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True) as process:
        end = time.monotonic() + 60.0
        while not (parts := list(tmp_path.glob("runs/*/campaign.part"))) or parts[0].read_bytes().count(b"\n") < 3:
            assert process.poll() is None
            assert time.monotonic() < end
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        begun = time.monotonic()
        said = process.communicate(timeout=30.0)[1]
    assert time.monotonic() - begun < 1.0
    assert process.returncode == -signal.SIGINT
    again = re.search(r"hydrotwin: interrupted; \d+ runs kept in (\S+); to continue: hydrotwin (.*)\n", said)
    assert again is not None, said
    assert shlex.split(again[2]) == [*words, "-o", str(parts[0].parent.relative_to(tmp_path))]


def test_draws_give_shares_with_intervals_and_a_share_to_accept(tmp_path: Path):
    draw = "[draw]\nruns = 6\n[draw.uniform]\nrig.load.mass = ['150 kg', '250 kg']\n"
    text = f"accept = '10 %'\n{SHORT.replace('60.5 mm', '1 m')}{draw}"
    done = hydrotwin_here("campaign", write(tmp_path, text), *ONE, "-o", "c", "--json", cwd=tmp_path)
    found = json.loads(done.stdout)
    rows = table(tmp_path / "c/campaign.csv")
    masses = [float(row["rig.load.mass"].split()[0]) for row in rows]
    assert len(set(masses)) == 6
    assert all(150.0 <= mass <= 250.0 for mass in masses)
    assert [row["seed"] for row in rows] == list("123456")  # each draw has a noise of its own
    assert found["cells"][0]["share"]["passed"] == sum(row["passed"] == "yes" for row in rows)
    assert done.returncode == (found["passed"] < 0.6)


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("scenario = ['step']", "scenario: unknown key; did you mean 'scenarios'"),
        ("scenarios = []", "scenarios: none is named"),
        ("scenarios = ['stepp']", "no such scenario or file; did you mean 'step'"),
        ("scenarios = ['step', 'step']", "stands twice"),
        ("scenarios = 3", "scenarios: 3 is not a list"),
        ("scenarios = ['step']\nfault = []", "write [faults.NAME]"),
        (
            "scenarios = ['step']\nfaults.a.rig.laod.mass = '1 kg'",
            "faults.a: rig.laod: unknown key; did you mean 'load'",
        ),
        ("scenarios = ['step']\nfaults.a.rig.load.mass = '1 m'", "unit 'm' does not fit here"),
        ("scenarios = ['step']\n[faults.a]", "faults.a: is empty"),
        ("scenarios = ['step']\nfaults.loop.duration = '1 s'", "a section of scenarios is called so"),
        ("scenarios = ['step']\nbaseline = false\nfaults.a.scenarios = ['sine']\nfaults.a.seed = 2", "matrix is empty"),
        (
            "scenarios = ['step']\n[parameters]\ncontroller.gian = [1, 2]",
            "controller.gian=1: controller.gian: unknown key",
        ),
        ("scenarios = ['step']\nparameters.controller.gain = 2", "one value is not an axis"),
        (
            "scenarios = ['step']\nfaults.a.seed = 2\nparameters.a.sed = '1:2:2'",
            "fault 'a' has no number 'sed'; did you",
        ),
        ("scenarios = ['step']\nseeds = 0", "seeds: 0: write how many"),
        ("scenarios = ['step']\nseeds = [1, 1]", "seeds: one stands twice"),
        ("scenarios = ['step']\nseeds = 200000", "200000 runs (1 cells of scenario, fault and parameters x 1 draws"),
        ("scenarios = ['step']\ndraw.uniform.rig.load.mass = ['2 kg', '1 kg']", "LOW must lie below what is HIGH"),
        ("scenarios = ['step']\ndraw.unifrom.rig.load.mass = ['1 kg', '2 kg']", "did you mean 'uniform'"),
        ("scenarios = ['step']\ndraw.uniform.rig.load.mas = ['1 kg', '2 kg']", "rig.load.mas: unknown key"),
        ("scenarios = ['step']\ndraw.runs = 5", "draw: nothing is drawn"),
        ("scenarios = ['step']\nmetrics = ['overshot']", "did you mean 'overshoot'"),
        ("scenarios = ['step']\nmargin.dealy = '0 ms:1 ms:2'", "margin.dealy: unknown key; did you mean 'delay'"),
        ("scenarios = ['step']\nmargin.delay = '0:10:2'", "10 has no unit"),
        ("scenarios = ['step']\nmargin.delay = '0 ms:0.13 ms:3'", "nearest"),
        ("scenarios = ['step']\nshrink = ['psh']\nfaults.push.seed = 2", "no such fault; did you mean 'push'"),
        (
            "scenarios = ['step']\nshrink = ['a']\nfaults.a.rig.load = {mass = 9, force = 1}",
            "a.rig.load.mass, a.rig.load",
        ),
        ("scenarios = ['step']\nmode = 'realtime'", "mode: 'realtime' is unknown"),
        ("scenarios = ['step']\naccept = '200 %'", "is not a share"),
        ("scenarios = ['step']\ncommon.expect = ['overshot <= 5 %']", "did you mean 'overshoot'"),
        (
            "scenarios = ['step']\nfaults.a.fault = [{target = 'process.recorder', kind = 'crash', at = '1 s'}]",
            "faults of processes need real time",
        ),
        ("scenarios = [", "cannot be read"),
    ],
)
def test_a_mistake_gets_one_line_before_anything_runs(text: str, answer: str, tmp_path: Path):
    done = hydrotwin_here("campaign", write(tmp_path, text), cwd=tmp_path)
    assert done.returncode == 2
    assert answer in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["c.toml"]


def test_the_runs_can_be_listed_without_running_them(tmp_path: Path):
    done = hydrotwin_here("campaign", write(tmp_path, f"seeds = 3\n{WHOLE}"), "--list", cwd=tmp_path)
    assert done.returncode == 0
    assert "12 runs: 4 cells of scenario, fault and parameters x 1 draws x 3 seeds" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["c.toml"]
