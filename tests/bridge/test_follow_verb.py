"""`hydrotwin follow FILE`: what it says of channels and of health, the file that it leaves, and what it refuses."""

import json
import math
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bridge.cli.follow import ENSEMBLE
from bridge.cli.follow_printing import print_report
from bridge.loop.follower import FollowerSide
from bridge.processes.follower import FollowerReport
from bridge.recording.entries import Entries
from bridge.recording.reader import Recording, read
from bridge.recording.writer import save
from bridge.replay.into_follower import through_follower
from bridge.report.estimates import draw_estimates, innovations_table, unknown_groups
from bridge.report.subject import load_run
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.wire.messages import ESTIMATE, INNOVATION
from tests.support.command import hydrotwin_here
from tests.support.processes import ENVIRONMENT
from twin.estimation.filter import fewest
from twin.estimation.health import Health, Rules
from twin.estimation.hypotheses import Verdict
from twin.estimation.quantities import Standing
from twin.estimation.settings import Settings

LENGTH = 0.5  # [s]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """run.mcap, and later.mcap with its second half."""
    here = tmp_path_factory.mktemp("follow")
    run = record_in_process(load("sine", [f"duration={LENGTH}", "loop.delay=5 ms"]), here / "run.mcap")
    kept = [entry for entry in run.entries if entry.log_time >= 0.25e9]
    save(run._replace(entries=Entries(kept)), here / "later.mcap", "rig")
    return here


@pytest.fixture(scope="module")
def without(folder: Path) -> tuple[dict, Recording]:
    """What is said of a run whose p3 is not used, and its file."""
    done = hydrotwin_here("follow", "run.mcap", "--without", "p3", "-o", "p3.mcap", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout, parse_constant=pytest.fail), read(folder / "p3.mcap")


def test_a_channel_that_is_left_out_says_how_well_it_is_found(without: tuple[dict, Recording]):
    """By the innovations in the file, where the estimate follows: within 0.3 bar of a sensor that it has not."""
    told, made = without
    found, estimates = made.columns(INNOVATION), made.columns(ESTIMATE)
    rows = estimates["standing"] == Standing.FOLLOWING
    assert 20 < rows.sum() < len(rows)
    p3 = told["channels"]["p3"]
    assert p3["use"] == "left out"
    assert p3["rms"] == pytest.approx(np.sqrt(np.mean(found["p3"][rows] ** 2)))
    assert p3["rms_in_deviations"] == pytest.approx(np.sqrt(np.mean((found["p3"] / found["p3_sd"])[rows] ** 2)))
    assert 0.0 < p3["rms"] < 0.3e5
    assert (p3["nis"], p3["whiteness"]) == (None, None)  # no reading was used
    used = told["channels"]["p2"]
    assert used["independent"] == pytest.approx(
        used["nis"] * (1 + max(0, used["whiteness"])) / (1 - max(0, used["whiteness"]))
    )


def test_the_report_says_the_same_and_draws_every_unknown(without: tuple[dict, Recording], folder: Path):
    told, made = without
    run = load_run(folder / "p3.mcap")
    rms = told["channels"]["p3"]["rms"] / 1e5
    assert f"<td>p3</td><td>not used</td><td>{rms:.3g} bar</td>" in innovations_table(run)
    groups = [names for _, names in unknown_groups(made.columns(ESTIMATE))]
    assert {name for names in groups for name in names} == set(told["unknowns"])
    labels = [[text.get_text() for text in axis.get_legend().get_texts()] for axis in draw_estimates(run).axes]
    assert labels[2:] == [[*names] for names in groups]
    assert max(map(len, groups)) <= 3  # bands of more hide one another


def test_a_recording_that_begins_later_is_followed_for_as_long_as_it_is(folder: Path):
    done = hydrotwin_here("follow", "later.mcap", "--json", cwd=folder)
    assert sum(json.loads(done.stdout)["seconds"].values()) == pytest.approx(0.25, abs=1e-9)


def test_a_file_that_was_followed_before_is_replaced_with_a_word_and_no_other(folder: Path):
    words = ("follow", "run.mcap", "-o")
    assert "in place of" not in hydrotwin_here(*words, "a.mcap", cwd=folder).stdout
    done = hydrotwin_here(*words, "a.mcap", "--health", cwd=folder)
    assert "a.mcap, in place of an earlier one: " in done.stdout
    assert (
        "health not judged: 42 s of an estimate that follows are needed (10 s to come to rest, 30 s of" in done.stdout
    )
    assert "it was followed for 0.155 s" in done.stdout
    before = (folder / "later.mcap").read_bytes()
    done = hydrotwin_here(*words, "later.mcap", cwd=folder)
    assert (done.returncode, (folder / "later.mcap").read_bytes()) == (2, before)
    assert "-o later.mcap: is there and was not written by hydrotwin follow" in done.stderr


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("follow run.mcap -o a.csv", "-o a.csv: a recording is an MCAP file"),
        ("follow run.mcap --alarms 0.1", "--alarms is of --health, which is not asked for"),
        ("follow run.mcap --commissioning 20s", "--commissioning is of --health"),
        ("follow run.mcap --health --commissioning 5s", "--commissioning 5s: at least 6 s, three windows of 2 s"),
        ("follow run.mcap --patience 3", "--patience is of a rig that runs, and run.mcap is a recording"),
        ("follow rig -o a.mcap", "--output is of a recording"),
        ("whatif run.mcap --listen-for 2s", "--listen-for is of a rig that runs, and run.mcap is a recording"),
        ("whatif rig --at 2s", "--at is of a recording"),
    ],
)
def test_an_option_that_means_nothing_here_is_refused(folder: Path, words: str, why: str):
    done = hydrotwin_here(*words.split(), cwd=folder)
    assert done.returncode == 2
    assert why in done.stderr
    assert done.stderr.count("\n") == 1


def test_what_is_printed_of_a_rig_that_ends_while_it_is_commissioned(
    without: tuple[dict, Recording], capsys: pytest.CaptureFixture[str]
):
    """No number stands for what is not known, no name for two things."""
    side = FollowerSide(load("sine", ["loop.delay=5 ms"]), Settings(without=("p3",)))
    for _ in through_follower(without[1], side):
        pass
    health = Health(0.5, Verdict.COMMISSIONING, (), math.nan, math.nan, {})
    print_report(FollowerReport(side.latest, health, 100, 0, 0.5, 0.001), Rules(), ("p3",))
    out = capsys.readouterr().out
    assert "health commissioning: 42 s of an estimate that follows are needed" in out
    assert "nan" not in out
    names = [line.split("  ")[0] for line in out.splitlines()]
    assert names.count("friction") == 1
    assert "friction factor" in names
    (p3,) = (line for line in out.splitlines() if line.startswith("p3 "))
    assert "left out" in p3
    assert "bar, " in p3


def test_the_help_says_how_many_twins_the_unknowns_of_a_rig_ask_for(without: tuple[dict, Recording]):
    assert f"{fewest(Settings(), len(without[0]['unknowns']))} for nine" in ENSEMBLE
    assert len(without[0]["unknowns"]) == 9


INTERRUPTED = """
import os, signal, sys
from bridge.cli import main
from bridge.replay import followed
followed.through_follower = lambda *_: os.kill(os.getpid(), signal.SIGINT)
sys.argv = ["hydrotwin", "follow", "run.mcap", "-o", "cut.mcap"]
main()
"""


def test_ctrl_c_ends_it_as_it_ends_other_long_verbs(folder: Path):
    command = [sys.executable, "-c", INTERRUPTED]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, env=ENVIRONMENT)
    assert done.returncode == -signal.SIGINT
    assert done.stderr == "hydrotwin: interrupted; cut.mcap is not written\n"
    assert not (folder / "cut.mcap").exists()
