"""`hydrotwin tune`: the search on functions whose minimum is known, and the scenario file that comes of it."""

import csv
import json
import math
import shlex
import tomllib
from collections.abc import Sequence
from pathlib import Path

import pytest

from bridge.runs.tune.goal import goal_of
from bridge.runs.tune.search import Search, Shares
from bridge.runs.tune.tune import Runs, Wanted
from bridge.runs.tune.varied import varied_of
from bridge.scenario import load
from bridge.studies.sweep.journal import Journal
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT

PAGE = (ROOT / "docs/sweeps.md").read_text(encoding="utf-8").replace("\\\n", "")
SHORT = ("--set", "duration=0.25", "--set", "reference.at=50 ms", "--workers", "1")
GOAL = goal_of("rms error", ["overshoot <= 10 %", "peak p_lower >= 20 bar"])


def result(*values: float | None, reason: str = "") -> dict:
    return {"values": [*values], "reason": reason, "failed": []}


def searched(energy, start: Shares, runs: int, seed: int = 1) -> tuple[Search, bool, list[Shares]]:
    asked: list[Shares] = []

    def evaluate(points: list[Shares]) -> list[float]:
        asked.extend(points)
        return [energy(*point) for point in points]

    search = Search(evaluate, runs)
    return search, search.run(start, seed), asked


def test_it_finds_a_known_minimum_among_many():
    """Rastrigin's function has 121 minima here; the least is at 0.3, 0.7."""

    def energy(x: float, y: float) -> float:
        return sum(100 * d * d - 10 * math.cos(20 * math.pi * d) + 10 for d in (x - 0.3, y - 0.7))

    search, converged, _ = searched(energy, (0.9, 0.1), 1500)
    assert converged
    assert search.best is not None
    assert search.best.shares == pytest.approx((0.3, 0.7), abs=3e-3)


def test_it_finds_a_minimum_on_the_edge_of_what_is_allowed():
    """The nearest point to the corner on the allowed side of x + y = 1.2 is 0.6, 0.6."""

    def energy(x: float, y: float) -> float:
        return math.hypot(x, y) if x + y >= 1.2 else 1e30 * (1.0 + 1.2 - x - y)

    search, _, _ = searched(energy, (0.1, 0.1), 600)
    assert search.best is not None
    assert search.best.shares == pytest.approx((0.6, 0.6), abs=0.03)
    assert search.best.energy == pytest.approx(math.hypot(0.6, 0.6), abs=3e-3)


@pytest.mark.parametrize("runs", [20, 57, 200])
def test_it_spends_no_more_than_it_may_and_has_one_course_per_seed(runs: int):
    def energy(x: float, y: float) -> float:
        return abs(x - 0.123) + abs(y - 0.456)

    first, again, other = (searched(energy, (0.5, 0.5), runs, seed)[2] for seed in (1, 1, 2))
    assert first == again != other
    assert len(set(first)) <= runs
    assert first[0] == (0.5, 0.5)  # where the scenario stands


def test_runs_are_ordered_by_the_rules_of_feasibility():
    good, better = result(0.02, 0.05, 30e5), result(0.01, 0.1, 20e5)
    near, far = result(0.001, 0.11, 30e5), result(0.001, 0.11, 10e5)
    nothing, failed = result(None, 0.05, 30e5), result(None, None, None, reason="law")
    energies = [GOAL.energy(one) for one in (better, good, near, far, nothing, failed)]
    assert energies == sorted(energies)
    assert len(set(energies)) == 6
    assert [GOAL.feasible(one) for one in (better, good, near, far, nothing, failed)] == [True, True, *[False] * 4]
    assert GOAL.violations(near) == pytest.approx([0.1, 0.0])
    cycle = goal_of("rms error", ["limit cycle: none"])
    assert cycle.measures[1].words == "limit cycle amplitude"
    assert cycle.violations(result(0.0, 0.5e-3)) == pytest.approx([0.5])  # mm, since the limit is 0


def test_values_stay_in_their_range_and_on_the_grid():
    scenario = load("step")
    gain, delay, ratio = varied_of(
        ["controller.gain=0.5:2", "loop.delay=0:20 ms", "controller.derivative=0.001:0.1 V s/%:log"], scenario
    )
    assert [gain.value(share) for share in (0.0, 0.5, 1.0)] == [0.5, 1.25, 2.0]
    assert gain.own_share == pytest.approx(1.0 / 3.0)
    for share in (0.0, 0.123456, 0.77, 1.0):
        load("step", [f"loop.delay={delay.text(delay.value(share))}"])  # off the grid it would be refused
    assert delay.own == pytest.approx(5.0)
    assert ratio.value(0.5) == pytest.approx(0.01)
    assert ratio.share(ratio.value(0.3)) == pytest.approx(0.3, abs=1e-5)
    assert gain.value(0.12345, digits=2) == 0.69


def test_the_order_in_which_runs_end_does_not_matter(tmp_path: Path):
    """As with many workers: the last of each batch comes first."""
    scenario = load("step")
    wanted = Wanted(scenario, varied_of(["controller.gain=0.5:2"], scenario), goal_of("rms error", []), 40, 1)

    def run(point) -> dict:
        return result(abs(float(point["changes"][0].split("=")[1].split()[0]) - 1.234))

    def ask(points: Sequence, turned: bool):
        yield from ((point, run(point)) for point in (points[::-1] if turned else points))

    found = []
    for turned in (False, True):
        journal = Journal(tmp_path / f"{turned}", {})
        runs = Runs(wanted, lambda points, turned=turned: ask(points, turned), journal, lambda: None)
        Search(runs.energies, 40).run((0.5,), 1)
        found.append(runs.trials)
    assert found[0] == found[1]
    assert min(trial.result["values"][0] for trial in found[0]) < 2e-3


def test_the_command_of_the_page_writes_a_scenario_that_is_better_and_keeps_the_bands(tmp_path: Path):
    command = next(line for line in PAGE.splitlines() if line.startswith("    hydrotwin tune"))
    words = shlex.split(command)[1:]
    bands = words.index("limit cycle: none")
    words[bands] = "peak p_lower <= 80 bar"  # a run as short as this has no stretch to judge
    done = hydrotwin_here(*words, *SHORT, "--runs", "40", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    text = (tmp_path / "tuned.toml").read_text()
    assert tomllib.loads(text)["extends"] == "step"
    tuned = load(str(tmp_path / "tuned.toml"))
    assert (tuned.name, tuned.duration) == ("tuned", 0.25)
    assert found["set"] == {name: tomllib.loads(text)["controller"][name.split(".")[1]] for name in found["set"]}
    values, start = found["best"]["values"], found["start"]["values"]
    assert values["rms error"] < start["rms error"]
    assert values["overshoot"] <= 0.02
    checked = hydrotwin_here(
        "run", "tuned.toml", "--mode", "inprocess", "--json", "-", "--record", "r.mcap", cwd=tmp_path
    )
    assert json.loads(checked.stdout)["metrics"]["rms_error"] == values["rms error"]
    rows = list(csv.DictReader((tmp_path / "tuned.csv").read_text().splitlines()[1:]))
    assert len(rows) == found["runs"] <= 40
    assert values["rms error"] * 1e3 <= 1.005 * min(
        float(r["rms error [mm]"]) for r in rows if r["bands kept"] == "yes"
    )
    assert (tmp_path / "tuned.png").is_file()
    assert not (tmp_path / "tuned.part").exists()


def test_bands_that_no_run_keeps_are_said_with_what_fails_least(tmp_path: Path):
    bands = ("--subject-to", "peak p_lower <= 50 bar", "--subject-to", "overshoot <= 2 %")
    words = ("tune", "step", "--vary", "controller.gain=0.5:2", *bands, *SHORT, "--runs", "30")
    done = hydrotwin_here(*words, "-o", "t/tuned.toml", cwd=tmp_path)
    assert done.returncode == 1
    assert not (tmp_path / "t/tuned.toml").exists()
    table = done.stdout.partition("No run kept all bands; what fails least first:")[2].splitlines()
    assert table[2].startswith("overshoot <= 2 %")
    assert table[3].startswith("peak p_lower <= 50 bar")
    assert " 0 of " in table[3]


def test_a_scenario_file_in_another_folder_is_extended_from_there(tmp_path: Path):
    (tmp_path / "own.toml").write_text('extends = "step"\nduration = 0.1\nreference.at = 0.02\n')
    (tmp_path / "mine.py").write_text(
        "def law(sample, target, memory, gains):\n    return gains.parameters.k, memory\n"
    )
    words = ("--set", "controller.law=mine.py:law", "--vary", "controller.parameters.k=0.1:0.5", "--runs", "30")
    done = hydrotwin_here("tune", "own.toml", *words, "--workers", "1", "-o", "t/tuned.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    data = tomllib.loads((tmp_path / "t/tuned.toml").read_text())
    assert data["extends"] == "../own.toml"
    assert data["controller"]["law"] == "../mine.py:law"
    assert data["controller"]["parameters"]["k"] == 0.5  # the farther out the better, in so short a run


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        ("", "name what may be varied"),
        ("--vary controller.gain", "write NAME=LOW:HIGH"),
        ("--vary controller.gain=2:1", "must rise"),
        ("--vary controller.gain=0:1:log", "from above 0"),
        ("--vary controller.gain=a:b", "cannot read 'a'"),
        ("--vary controller.gian=1:2", "did you mean 'gain'"),
        ("--vary controller.limit=0.5:1.5", "1.5 must be at most 1.0"),
        ("--vary loop.delay=0:10", "10 has no unit"),
        ("--vary controller.gain=1:2 --vary controller.gain=1:3", "named twice"),
        ("--vary controller.gain=1:2 --set controller.gain=3", "controller.gain is varied"),
        ("--vary controller.gain=1:2 --minimise overshot", "did you mean 'overshoot'"),
        ("--vary controller.gain=1:2 --subject-to 'overshoot <= 5'", "has no unit"),
        ("--vary controller.gain=1:2 --subject-to 'mean p1 from 3 s to 30 s <= 1 bar'", "lengthen duration"),
        ("--vary controller.gain=1:2 -o mine.toml", "was not written by hydrotwin tune"),
        ("--vary controller.gain=1:2 -o mine.json", "a scenario is a TOML file"),
    ],
)
def test_a_mistake_gets_one_line_before_anything_runs(words: str, answer: str, tmp_path: Path):
    (tmp_path / "mine.toml").write_text('extends = "step"\n')
    done = hydrotwin_here("tune", "step", *shlex.split(words), cwd=tmp_path)
    assert done.returncode == 2
    assert answer in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml"]
