"""A user's law in a file of its own: found beside its scenario, hidden by nobody, its mistakes named by their line."""

import hashlib
import math
import re
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import RunError, ScenarioError
from bridge.loop.law import find_law
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.runs.run import ready_to_run
from bridge.scenario import Scenario, load
from bridge.scenario.controllers import Python
from controller.law import Gains, Sample
from controller.reference import Target
from tests.support.command import hydrotwin_here
from tests.support.processes import ROOT, UNDRAWN

ANSWER = "def law(sample, target, memory, gains):\n    return 0.25, memory\n"
CALL = (Sample(0, 0.1, 0.0, 0.0, 0.0, 0.0), Target(0.1, 0.0), None, Gains(1.0, 0.0, "measured", 0.0, 0.01, 1.0, 0.0))


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty working folder; gives a folder beside it. What is imported is forgotten afterwards."""
    (tmp_path / "work").mkdir()
    (tmp_path / "mine").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setattr(sys, "path", [*sys.path])
    before = set(sys.modules)
    yield tmp_path / "mine"
    for name in set(sys.modules) - before:
        if str(tmp_path) in str(getattr(sys.modules[name], "__file__", None)):
            del sys.modules[name]


def law_named_by(scenario: Scenario) -> str:
    """The user's function of a scenario."""
    assert isinstance(scenario.controller, Python)
    return scenario.controller.law


def scenario_with(folder: Path, law: str) -> str:
    """A scenario file whose law is `law`."""
    path = folder / "mine.toml"
    path.write_text(f'extends = "step"\nduration = 0.05\n[controller]\nkind = "python"\nlaw = "{law}"\n')
    return str(path)


@pytest.mark.parametrize("name", ["controller:law", "controller.py:law", "deep.er:law", "deep/er.py:law", "deep:law"])
def test_a_law_is_found_beside_its_scenario_from_anywhere(elsewhere: Path, name: str):
    """Also where its file, or its package, has the name of one of ours."""
    (elsewhere / "controller.py").write_text(ANSWER)
    (elsewhere / "deep").mkdir()
    (elsewhere / "deep" / "__init__.py").write_text("from .er import law\n")
    (elsewhere / "deep" / "er.py").write_text("from .number import SPOOL\n" + ANSWER.replace("0.25", "SPOOL"))
    (elsewhere / "deep" / "number.py").write_text("SPOOL = 0.25\n")
    law = law_named_by(load(scenario_with(elsewhere, name)))
    assert find_law(law).answer(*CALL) == (0.25, None)


def test_a_law_in_the_working_folder_keeps_its_short_name(elsewhere: Path):
    Path("mine.py").write_text(ANSWER)
    assert law_named_by(load("step", ["controller.kind=python", "controller.law=mine:law"])) == "mine:law"
    assert find_law("mine:law").answer(*CALL) == (0.25, None)


def test_a_law_is_found_beside_the_scenario_that_is_extended(elsewhere: Path):
    (elsewhere / "swing.py").write_text(ANSWER)
    scenario_with(elsewhere, "swing:law")
    Path("own.toml").write_text(f'extends = "{elsewhere / "mine.toml"}"\nseed = 4\n')
    assert find_law(law_named_by(load("own.toml"))).answer(*CALL) == (0.25, None)


def test_an_installed_law_is_found():
    assert find_law("controller.law:open_loop").answer(*CALL)[0] == 0.1


def test_neighbours_are_imported_and_never_take_our_place(elsewhere: Path):
    (elsewhere / "mine.py").write_text("import controller, own_spool\n" + ANSWER.replace("0.25", "own_spool.SPOOL"))
    (elsewhere / "controller.py").write_text("raise RuntimeError('imported by mistake')\n")
    (elsewhere / "own_spool.py").write_text("SPOOL = 0.5\n")
    assert find_law(f"{elsewhere}/mine.py:law").answer(*CALL) == (0.5, None)


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("\ndef law(sample) return 0.0\n", 2, "expected ':'"),
        ("import sys\nsys.exit(0)\n", 2, "SystemExit: 0"),
        ("import json\n\njson.loads('{')\n", 3, "JSONDecodeError: Expecting property name"),
        ("import no_such_module_of_mine\n", 1, "ModuleNotFoundError"),
        ("x = 1\n", None, "has no function 'law'"),
        ("law = 3\n", None, "has no function 'law'"),
    ],
)
def test_a_mistake_in_the_file_is_one_line_with_its_place(elsewhere: Path, text: str, line: int | None, reason: str):
    Path("wrong.py").write_text(text)
    with pytest.raises(ScenarioError) as raised:
        find_law("wrong:law")
    said = str(raised.value)
    assert "\n" not in said
    assert reason in said
    assert line is None or f"wrong.py, line {line}: " in said


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("return 1.0 / 0.0, None", "wrong.py, line 2: ZeroDivisionError"),
        ("raise SystemExit(3)", "wrong.py, line 2: SystemExit: 3"),
        ("return sample.nothing, None", "wrong.py, line 2: AttributeError"),
        ("return 0.0", "returned 0.0 at t = 0 s: a law returns (spool, memory)"),
        ("return None, None", "returned as spool None at t = 0 s: give a number"),
    ],
)
def test_a_failing_call_is_one_line_with_its_place(elsewhere: Path, body: str, said: str):
    """The recording of the run ends where the law did, and is whole."""
    Path("wrong.py").write_text(f"def law(sample, target, memory, gains):\n    {body}\n")
    scenario = load("step", ["controller.kind=python", "controller.law=wrong.py:law", "duration=0.05"])
    with pytest.raises(RunError) as raised:
        record_in_process(scenario, elsewhere / "a.mcap")
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("name", ["controller:law", "twin:law", "nowhere.py:law", "no/where.py:law"])
def test_a_law_that_is_nowhere_is_said_to_be(elsewhere: Path, name: str):
    with pytest.raises(ScenarioError, match="no such file"):
        find_law(name)


@pytest.mark.parametrize("name", [":law", "mine:", "mine:1", "pdd"])
def test_what_names_no_function_is_refused(name: str):
    with pytest.raises(ScenarioError, match=r"FILE\.py:function"):
        load("step", ["controller.kind=python", f"controller.law={name}"])


def test_a_failing_law_ends_a_run_with_its_line(elsewhere: Path):
    """In lockstep: `test_own_signals.py`."""
    (elsewhere / "controller.py").write_text("def law(sample, target, memory, gains):\n    return 1 / 0, memory\n")
    command = ("run", scenario_with(elsewhere, "controller:law"), "--mode", "inprocess", *UNDRAWN)
    done = hydrotwin_here(*command, cwd=Path.cwd())
    assert done.returncode == 1
    assert "controller.py, line 2: ZeroDivisionError: division by zero" in (done.stdout + done.stderr).replace("\n", "")
    assert "Traceback" not in done.stdout + done.stderr


DATACLASS = """\
from dataclasses import dataclass


@dataclass
class Parameters:
    kp: float  # [1/m]
    ki: float = 0.0  # [1/(m s)]
    deep: bool = False
"""
MODEL = """\
from pydantic import BaseModel, Field


class Parameters(BaseModel):
    kp: float = Field(gt=0.0)
    ki: float = 0.0
"""
PI = """\
from controller.law import compensate, saturate


def law(sample, target, memory, gains):
    p, error, integral = gains.parameters, target.position - sample.position, memory or 0.0
    u = saturate(compensate(p.kp * error + integral, gains.overlap), gains.limit)
    return u, integral + p.ki * gains.sample_period * error
"""


def with_parameters(text: str, *parameters: str) -> Scenario:
    """A short run of a law in `pi.py`."""
    Path("pi.py").write_text(text + PI)
    given = [f"controller.parameters.{parameter}" for parameter in parameters]
    return load("step", ["controller.kind=python", "controller.law=pi.py:law", "duration=1.5", *given])


@pytest.mark.parametrize("text", ["", DATACLASS, MODEL], ids=["free", "dataclass", "model"])
def test_parameters_arrive_in_si_and_make_the_law_that_our_pid_is(elsewhere: Path, text: str):
    """The same true positions as from kind = "pid" with those gains; the recording keeps the law and its numbers."""
    gains = {"kp": "1.5 V/%", "ki": "0.2 V/(% s)"}
    recorded = record_in_process(with_parameters(text, *map("=".join, gains.items())), Path("a.mcap"))
    pid = ["controller.kind=pid", "controller.gain=1.5 V/%", "controller.integral=0.2 V/(% s)"]
    other = [*pid, "controller.anti_windup=none", "duration=1.5"]
    ours = record_in_process(load("step", other), Path("b.mcap"))
    theirs = [run.columns("state")["position"] for run in (recorded, ours)]
    assert np.ptp(theirs[0]) > 0.01
    assert theirs[0] == pytest.approx(theirs[1], abs=1e-9)
    run = read(Path("a.mcap")).metadata["run"]
    assert run["law"]["text"] == text + PI
    assert run["law"]["sha256"] == hashlib.sha256((text + PI).encode()).hexdigest()
    assert run["scenario"]["controller"]["parameters"] == gains


@pytest.mark.parametrize(
    ("text", "parameters", "complaint"),
    [
        (DATACLASS, ["ki=1"], "controller.parameters.kp: pi.py wants it and has no default"),
        (DATACLASS, ["kp=1", "kj=1"], "controller.parameters.kj: pi.py declares none (valid: kp, ki, deep)"),
        (DATACLASS, ["kp=true"], "controller.parameters.kp = True: pi.py wants a number"),
        (DATACLASS, ["kp=1", "deep=2"], "controller.parameters.deep = 2: pi.py wants true or false"),
        (MODEL, ["kp=-1"], "controller.parameters.kp: -1 must be greater than 0.0, by pi.py"),
        (MODEL, ["kp=1", "kj=1"], "controller.parameters.kj: pi.py declares none"),
        ("Parameters = 3\n", ["kp=1"], "pi.py: Parameters is neither a dataclass nor a pydantic model"),
    ],
)
def test_parameters_that_do_not_fit_are_refused_before_the_run(
    elsewhere: Path, text: str, parameters: list[str], complaint: str
):
    scenario = with_parameters(text, *parameters)
    with pytest.raises(ScenarioError) as refused:
        ready_to_run(scenario)
    assert complaint in str(refused.value)


@pytest.mark.parametrize(
    ("parameter", "complaint"),
    [
        ("kp=3 foo", "unit 'foo' is unknown"),
        ("kp={a=1}", "a parameter is a number, a text"),
        ("kp=nan", "kp is not a number"),
    ],
)
def test_a_parameter_that_is_none_is_refused_when_it_is_read(elsewhere: Path, parameter: str, complaint: str):
    with pytest.raises(ScenarioError, match=complaint):
        with_parameters("", parameter)


def test_a_word_that_begins_as_infinity_does_is_a_word(elsewhere: Path):
    controller = with_parameters("", "word=info", "other=inf").controller
    assert isinstance(controller, Python)
    assert controller.parameters == {"word": "info", "other": math.inf}


def test_describe_shows_what_a_law_gets(elsewhere: Path):
    with_parameters("", "kp=3 V/%", "word=fast")
    changes = [f"--set={change}" for change in ("controller.kind=python", "controller.law=pi.py:law")]
    done = hydrotwin_here("describe", "step", *changes, "--set=controller.parameters.kp=2500", cwd=Path.cwd())
    assert "2500" in done.stdout, done


def test_an_undeclared_parameter_is_named_with_those_that_there_are(elsewhere: Path):
    scenario = with_parameters("", "kp=1", "word=fast")
    with pytest.raises(RunError, match=r"pi\.py, line 7: AttributeError: there is no controller\.parameters\.ki"):
        record_in_process(scenario, Path("a.mcap"))


@pytest.mark.parametrize("logs", [False, True])
def test_the_page_s_law_runs_with_its_scenario(elsewhere: Path, logs: bool):
    """The law that logs signals does what the other one does."""
    page = (ROOT / "docs/running.md").read_text(encoding="utf-8").partition("## A law of your own")[2]
    plain, logging, *_ = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    Path("pi.py").write_text(f"{plain}\n\n{logging}" if logs else plain)
    text = page.partition("    [controller]\n")[2].partition("```python")[0]
    Path("own.toml").write_text('extends = "step"\nduration = 3.0\n' + textwrap.dedent("    [controller]\n" + text))
    recorded = record_in_process(load("own.toml"), Path("a.mcap"))
    assert abs(recorded.metadata["summary"]["metrics"]["steady_error"]) < 1e-3
    assert list(recorded.columns("signals"))[4:] == (["integral", "error", "saturated"] if logs else [])
