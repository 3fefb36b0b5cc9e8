"""Nothing loads what it does not use: looked at in fresh interpreters, of which one forks for each look."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import bridge.scenario.circuit as circuits
from bridge.cli.catalogue import VERBS
from bridge.processes.options import RunOptions
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.messages import Mode

HEAVY = ("numba", "scipy", "matplotlib", "control", "mcap", "rerun", "rosbags")
HOT = (
    "numba",
    "scipy",
    "matplotlib",
    "control",
    "rerun",
    "rich",
)
LISTS = (
    *("bridge.wire.messages", "bridge.wire.link", "bridge.scenario", "bridge.scenario.bands", "bridge.errors"),
    *(
        "bridge.recording.summary",
        "bridge.wire.status",
        "bridge.figures.catalogue",
        "bridge.runs.campaign.matrix",
        "bridge.runs.campaign.shrink",
        "bridge.cli.verbs",
        "bridge.cli.printing",
        "bridge.cli.tables",
    ),
    *("twin.topology", "twin.rig", "controller.bands", "controller.law", "controller.grid", "controller.hold"),
)
PROCESSES = {
    "bridge.processes.plant": HOT,
    "bridge.processes.controller": (*HOT, "mcap"),
    "bridge.processes.recorder.process": HOT,
    "bridge.processes.router": HEAVY,
    "bridge.processes.supervisor": (*HOT, "mcap"),
    "hydrotwin.policy": ("gymnasium",),
}
WORDS = (
    *("--help", "run --help", "scenarios", "scenarios --json", "schema", "messages", "messages --json", "figures"),
    *(
        "figures --json",
        "figure 9.99",
        "run nonsense",
        "run step --set loop.dely=1",
        "check nonsense",
        "plant nonsense",
    ),
    *("controller nonsense", "describe nonsense", "advise nonsense", "convergence nonsense", "nonsense"),
    *("tune nonsense", "tune step", "tune step --vary controller.gain=2:1"),
    *("sweep nonsense a=1,2", "sweep step controller.gain=1", "sweep step controller.gain=1,2 -m overshot"),
    *("campaign none.toml", "campaign pyproject.toml"),
    *("run step --set rig.valve.kind=round", "run step --duration 1.00001"),
    *(f"{verb} none.mcap" for verb in ("info", "view", "digest", "replay", "report", "recover", "export --csv")),
    *("import none.csv --guess", "import pyproject.toml", "import none.csv --map none.toml"),
    *("compare none.mcap none.mcap", "replay none.mcap --into plant"),
)
LIGHT = ("--help", "scenarios", "nonsense")
WITH_VALUES = ("messages", "messages --json")  # of options, for which typer itself loads pydantic
MODELS = ("bridge.scenario.model", "numpy")
VALIDATING = ("pydantic.main", *MODELS)
PROGRAM = """
import importlib, json, os, sys
work, heavy = json.loads(sys.argv[1])
if work[0].startswith("hydrotwin "):  # light themselves, by the test above
    import bridge.cli.verbs
for name in work:
    reader, writer = os.pipe()
    if os.fork() == 0:
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1), os.dup2(quiet, 2)
        try:
            if name.startswith("hydrotwin "):
                sys.argv = name.split()
                from bridge.cli import answer
                code = answer()
            else:
                importlib.import_module(name)
                code = 0
        except SystemExit as end:
            code = end.code
        os.write(writer, json.dumps([code, sorted(set(heavy) & set(sys.modules))]).encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as answer:
        print(json.dumps([name, *json.loads(answer.read())]))
"""


def loaded(work: list[str], heavy: tuple[str, ...]) -> dict[str, tuple[int | None, list[str]]]:
    """Exit code, and which heavy packages were loaded, of each module imported or command run."""
    command = [sys.executable, "-c", PROGRAM, json.dumps([work, heavy])]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
    return {name: (code, found) for name, code, found in map(json.loads, done.stdout.splitlines())}


def test_modules_that_list_load_nothing_heavy():
    assert loaded(list(LISTS), HEAVY) == {name: (0, []) for name in LISTS}


def test_verbs_that_list_print_or_refuse_load_nothing_heavy():
    commands = {f"hydrotwin {words}": words for words in WORDS}
    found = loaded(list(commands), HEAVY)
    assert {name: heavy for name, (_, heavy) in found.items() if heavy} == {}
    lists = ("--help", "scenarios", "schema", "messages", "figures")
    refused = {words for name, words in commands.items() if found[name][0]}
    assert refused == {words for words in WORDS if not words.endswith(lists) and "--json" not in words}


def test_lists_load_nothing_that_validates():
    for light, heavy in ((LIGHT, VALIDATING), (WITH_VALUES, MODELS)):
        found = loaded([f"hydrotwin {words}" for words in light], heavy)
        assert {name: modules for name, (_, modules) in found.items() if modules} == {}


def test_a_verb_imports_no_other():
    others = tuple(f"bridge.cli.{place.partition(':')[0]}" for _, place, _ in VERBS.values())
    assert loaded(["hydrotwin --help", "hydrotwin messages"], others) == {
        "hydrotwin --help": (0, []),
        "hydrotwin messages": (0, ["bridge.cli.machine"]),
    }


def test_a_scenario_that_is_refused_by_name_waits_for_no_model():
    assert loaded(["hydrotwin run nonsense"], ("bridge.scenario.model",)) == {"hydrotwin run nonsense": (2, [])}


@pytest.mark.parametrize("module", PROCESSES)
def test_processes_of_the_loop_load_only_what_they_run(module: str):
    assert loaded([module], PROCESSES[module]) == {module: (0, [])}


def test_a_run_of_what_was_compiled_before_needs_neither_compiler_nor_solver(tmp_path: Path):
    command = f"hydrotwin run step --mode inprocess --duration 0.05 --record {tmp_path / 'run.mcap'} --json -"
    loaded([command], ())  # compiles where nothing is kept, and builds the circuit
    unused = (*(name for name in HOT if name != "rich"), "twin.compiler")
    assert loaded([command], unused) == {command: (0, [])}


def test_a_figure_is_imported_when_it_is_asked_for():
    drawn = "bridge.figures.oil.viscosity"
    assert loaded(["bridge.figures.catalogue"], (drawn,))["bridge.figures.catalogue"] == (0, [])
    assert loaded([drawn], (drawn,))[drawn] == (0, [drawn])  # so the look does see what is there


@pytest.fixture
def builds(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[list[float]]:
    """The step of each circuit that is built, where none is remembered at first."""
    made: list[float] = []
    build = circuits.build
    monkeypatch.setattr(circuits, "FOLDER", tmp_path)
    monkeypatch.setattr(circuits, "build", lambda rig, step: made.append(step) or build(rig, step))
    circuits.forget()
    yield made
    circuits.forget()


def test_a_run_builds_its_circuit_once(builds: list[float], tmp_path: Path):
    options = RunOptions(Mode.INPROCESS, tmp_path / "run.mcap")
    for _ in range(2):
        run_scenario(load("step", ["duration=0.05"]), options)
    assert builds == [50e-6]


def test_what_a_process_has_built_the_next_one_reads(builds: list[float]):
    first = circuits.rest_of(load("step")), circuits.circuit_of(load("step"))
    circuits.forget()
    again = circuits.rest_of(load("step")), circuits.circuit_of(load("step"))
    assert builds == [50e-6]
    assert (first[0] == again[0]).all()
    assert repr(first[1]) == repr(again[1])


def test_other_numbers_are_another_circuit(builds: list[float]):
    for change in ("rig.load.mass=150", "rig.load.mass=151", "loop.step=0.000025"):
        circuits.circuit_of(load("step", [change]))
    assert builds == [50e-6, 50e-6, 25e-6]


def test_loading_a_scenario_builds_nothing(builds: list[float]):
    load("step", ["rig.load.mass=150"])
    assert builds == []
