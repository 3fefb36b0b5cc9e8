"""A law that is broken in any of these ways gets one sentence, which names the law, the place and the instant.

`python -m tests.bridge.test_broken_laws` prints what each gets.
"""

import sys
import tempfile
from pathlib import Path

import pytest

import hydrotwin as ht
from bridge.errors import RunError, ScenarioError
from bridge.recording.verdict import verdict
from bridge.runs.in_process import record_in_process
from bridge.scenario import load

HEAD = "import numpy as np\nLATER = 20_000_000  # [ns]\n\n\ndef law(sample, target, memory, gains):\n    later = "
HEAD += "sample.stamp_ns >= LATER\n    "
LAWS = {  # what stands in line 7, and a part of what is said of it
    "pass": "returned None at t = 0 s: a law returns (spool, memory), or (spool, memory, signals)",
    "return 0.1": "returned 0.1 at t = 0 s: a law returns (spool, memory)",
    "return 0.1, memory, {}, 4": "returned (0.1, None, {}, 4) at t = 0 s: a law returns",
    "return np.array([0.1, 0.2])": "returned array([0.1, 0.2]) at t = 0 s: a law returns",
    "return np.array([0.1]), memory": "returned as spool array([0.1]) at t = 0 s: give a number from -1 to 1",
    "return '0.1', memory": "returned as spool '0.1' at t = 0 s: give a number",
    "return None, memory": "returned as spool None at t = 0 s: give a number",
    "return 1j, memory": "returned as spool 1j at t = 0 s: give a number",
    "return float('nan'), memory": "not finite: spool reference nan",
    "return float('inf'), memory": "not finite: spool reference inf",
    "return 1.5, memory": "out of range: spool reference 1.5 is outside -1 to 1",
    "raise ValueError('no idea')": "mine.py, line 7: ValueError: no idea",
    "return np.ones(3)[7], memory": "mine.py, line 7: IndexError: index 7 is out of bounds",
    "return sample.p4, memory": "mine.py, line 7: AttributeError: 'Sample' object has no attribute 'p4'",
    "return law(sample, target, memory, gains)": "RecursionError: maximum recursion depth exceeded",
    "import sys; sys.exit('enough')": "mine.py, line 7: SystemExit: enough",
    "return 0.1, memory, [0.3]": "the signals at t = 0 s are [0.3]: signals are a dict of name: number",
    "return 0.1, memory, {'my signal': 1.0}": "signal 'my signal' at t = 0 s: a name is letters, digits and _",
    "return 0.1, memory, {3: 1.0}": "signal 3 at t = 0 s: a name is letters",
    "return 0.1, memory, {'stamp': 1.0}": "signal 'stamp' at t = 0 s: every message has a field of that name",
    "return 0.1, memory, {f's{i}': i for i in range(99)}": "99 signals at t = 0 s are too many: log at most 64",
    "return 0.1, memory, {'e': 'high'}": "signal 'e' is 'high' at t = 0 s: give a number, or (number, unit)",
    "return 0.1, memory, {'e': np.ones(3)}": "signal 'e' is array([1., 1., 1.]) at t = 0 s: give a number",
    "return 0.1, memory, {'e': None}": "signal 'e' is None at t = 0 s: give a number",
    "return 0.1, memory, {'e': 10**999}": "signal 'e' is 1000000000",
    "return 0.1, memory, {'e': (0.3, 4)}": "signal 'e' at t = 0 s has the unit 4: give a text as 'V'",
    "return 0.1, memory, {'e': (0.3, 'V' if later else 'm')}": "is in 'V' at t = 0.02 s and was in 'm': a unit stays",
    "return 0.1, memory, {'e': 0.3, **({'f': 1.0} if later else {})}": "signal 'f' is new at t = 0.02 s: every sample",
    "return 0.1, memory, {} if later else {'e': 0.3}": "signal 'e' is missing at t = 0.02 s: every sample logs",
    "return (0.1, memory, {'e': 0.3}) if later else (0.1, memory)": "signal 'e' is new at t = 0.02 s: every sample",
    "return (0.1, memory) if later else (0.1, memory, {'e': 0.3})": "signal 'e' is missing at t = 0.02 s: every sample",
}
LOADED = {  # a whole file, and a part of what is said of it
    "def law(sample, target memory):\n    return 0.1, memory\n": "mine.py, line 1: invalid syntax",
    "import no_such_module\n": "mine.py, line 1: ModuleNotFoundError: No module named 'no_such_module'",
    "def other(sample, target, memory, gains):\n    return 0.1, memory\n": "has no function 'law'",
    "law = 0.1\n": "has no function 'law'",
    "def law(sample):\n    return 0.1, None\n": "mine.py: TypeError: law() takes 1 positional argument but 4 were",
}
TEXTS = {HEAD + body + "\n": part for body, part in LAWS.items()} | LOADED


def said_of(text: str, folder: Path) -> str:
    """What is said of a law in a file, by the run or by its verdict."""
    (folder / "mine.py").write_text(text)
    changes = ["controller.kind=python", f"controller.law={folder}/mine.py:law", "duration=0.05"]
    try:
        scenario = load("step", changes)
        recorded = record_in_process(scenario, folder / "a.mcap")
    except (RunError, ScenarioError) as error:
        return str(error)
    finally:
        for name in [name for name in sys.modules if name.endswith("mine_py")]:
            del sys.modules[name]
    return verdict(ht.Run(recorded, scenario).summary, scenario)[0]


@pytest.mark.parametrize("text", TEXTS, ids=[*LAWS, *map(repr, LOADED)])
def test_a_broken_law_gets_one_sentence(text: str, tmp_path: Path):
    said = said_of(text, tmp_path)
    assert TEXTS[text] in said
    assert "\n" not in said
    assert len(said.replace(str(tmp_path), "")) < 330


def test_nan_is_a_value_of_a_signal_and_the_order_is_free():
    def law(sample, target, memory, gains):
        first = {"a": float("nan"), "b": (1, "bar")}
        return 0.0, memory, dict(reversed(first.items())) if sample.stamp_ns else first

    run = ht.run("step", law, changes={"duration": 0.02})
    assert run.signal("b").value.tolist() == [1e5] * 3
    assert all(run.signal("a").value != run.signal("a").value)


def test_a_function_in_memory_is_named_with_its_line_too():
    def law(sample, target, memory, gains):
        return 0.1, memory, {"e": 1.0 / (sample.stamp_ns - 10**7)}

    line = law.__code__.co_firstlineno + 1
    with pytest.raises(RunError, match=rf"law'.*test_broken_laws\.py, line {line}: ZeroDivisionError"):
        ht.run("step", law, changes={"duration": 0.05})


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        for law_text in TEXTS:
            shown = law_text.removeprefix(HEAD).strip().replace("\n", " | ")
            print(f"{shown}\n    {said_of(law_text, Path(place)).replace(f'{place}/', '')}")
