"""A state-space law in a file: read by what other programs save, carried by the scenario, refused in one line."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from bridge.errors import ScenarioError
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.scenario.controllers import StateSpace
from tests.support.command import hydrotwin_here

LAW: dict[str, Any] = {
    "A": [[0.5, 0.1], [0.0, 0.25]],
    "B": [[1.0, 0.0], [2.0, -1.0]],
    "C": [[0.5, 2.0]],
    "D": [[4.0, -0.5]],
    "dt": 0.01,
    "inputs": ["error", "velocity"],
}
GAIN: dict[str, Any] = {"D": [[5.0]], "dt": 0.01}
EMPTY: dict[str, Any] = {"A": np.zeros((0, 0)), "B": np.zeros((0, 1)), "C": np.zeros((1, 0)), **GAIN}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(name: str, held: dict[str, Any]) -> None:
    if name.endswith(".json"):
        Path(name).write_text(json.dumps(held))
    elif name.endswith(".npz"):
        np.savez(name, **held)
    else:
        cells = {key: np.array(value, dtype=object) for key, value in held.items() if key == "inputs"}
        savemat(name, held | cells)


def scenario_with(name: str, more: str = "") -> str:
    text = f'extends = "step"\nduration = 0.2\n[controller]\nkind = "state-space"\nfile = "{name}"\n{more}'
    Path("own.toml").write_text(text)
    return "own.toml"


def law_in(name: str, *changes: str) -> StateSpace:
    found = load(scenario_with(name), list(changes)).controller
    assert isinstance(found, StateSpace)
    return found


@pytest.mark.parametrize("name", ["law.json", "law.npz", "law.mat"])
def test_a_law_is_read_as_it_was_saved(name: str):
    write(name, LAW)
    found = law_in(name)
    assert {key: getattr(found, key) for key in LAW} == LAW
    assert found.origin is not None
    assert found.origin.model_dump() == {"file": name, "sha256": hashlib.sha256(Path(name).read_bytes()).hexdigest()}


@pytest.mark.parametrize(
    ("name", "held"),
    [
        ("law.json", GAIN),
        ("law.npz", EMPTY),
        ("law.mat", EMPTY),
        ("law.mat", {"A": [], "B": [], "C": [], **GAIN}),
        ("law.json", GAIN | {"dt": "10 ms"}),
        ("law.mat", GAIN | {"D": csc_matrix([[5.0]])}),
        ("law.npz", GAIN | {"D": np.array([[5]]), "inputs": np.array(["error"])}),
        ("law.MAT", GAIN | {"inputs": "error"}),
    ],
)
def test_a_gain_alone_is_a_law(name: str, held: dict[str, Any]):
    write(name, held)
    found = law_in(name)
    assert (found.A, found.B, found.C, found.D, found.dt) == ([], [], [[]], [[5.0]], 0.01)
    assert found.inputs == ["error"]


def test_a_run_needs_the_file_no_more_and_its_recording_carries_the_law(folder: Path):
    write("law.npz", LAW)
    scenario = load(scenario_with("law.npz"))
    Path("law.npz").unlink()
    record_in_process(scenario, Path("a.mcap"))
    recording = read(Path("a.mcap"))
    assert recording.scenario() == scenario
    assert recording.metadata["run"]["scenario"]["controller"]["A"] == LAW["A"]
    assert f"law.npz, sha256 {recording.metadata['run']['law']['sha256'][:12]}" in (
        hydrotwin_here("info", "a.mcap", cwd=folder).stdout
    )


def test_what_is_changed_is_no_longer_from_the_file(folder: Path, monkeypatch: pytest.MonkeyPatch):
    """A later change comes on top of the file, a later file in place of all matrices; found from anywhere."""
    write("law.json", LAW)
    write("gain.json", GAIN)
    changed = law_in("law.json", "controller.D=[[3.0, 0.0]]", "controller.limit=0.5")
    assert (changed.A, changed.D, changed.origin) == (LAW["A"], [[3.0, 0.0]], None)
    other = law_in("law.json", "controller.D=[[3.0, 0.0]]", "controller.file=gain.json")
    assert (other.A, other.D, other.inputs) == ([], [[5.0]], ["error"])
    assert other.origin is not None
    own = 'extends = "own.toml"\n[controller]\nD = [[3.0, 0.0]]\n'
    (folder / "further.toml").write_text(own)
    (folder / "work").mkdir()
    monkeypatch.chdir(folder / "work")
    further = load("../further.toml").controller
    assert isinstance(further, StateSpace)
    assert (further.A, further.D, further.origin) == (LAW["A"], [[3.0, 0.0]], None)


@pytest.mark.parametrize(
    ("name", "held", "said"),
    [
        ("law.json", {"A": [[0.5]]}, "has no D: a law is A, B, C, D, dt and perhaps inputs (it holds A)"),
        ("law.json", {"D": [[5.0]]}, "has no dt: a law is"),
        ("law.json", LAW | {"K": [[1.0]]}, "holds 'K', which a law does not have"),
        ("law.json", {"continuous": {}, "sampled": {}, "at": {}}, "is the linear model of a rig, as `hydrotwin linear"),
        ("law.json", [1.0], "is not a table of names"),
        ("law.json", GAIN | {"D": 5.0}, "has a matrix D that is not two-dimensional: write rows"),
        ("law.json", GAIN | {"D": [5.0]}, "has a matrix D that is not two-dimensional"),
        ("law.json", GAIN | {"D": [[5.0], [1.0, 2.0]]}, "has rows of different lengths in D"),
        ("law.json", GAIN | {"D": [["5"]]}, "holds something else than numbers in D"),
        ("law.json", GAIN | {"D": [[float("nan")]]}, "holds a number that is not finite in D"),
        ("law.npz", GAIN | {"D": np.array([[5.0 + 1j]])}, "has complex numbers in D: bring the law into real form"),
        ("law.npz", GAIN | {"D": np.array([[None]])}, "is not an archive of plain arrays: save it with numpy.savez"),
        ("law.mat", GAIN | {"dt": 0.0}, "has dt 0: a law is sampled; discretise it"),
        ("law.mat", GAIN | {"dt": [0.01, 0.02]}, "has a dt that is not one number"),
        ("law.json", GAIN | {"inputs": [1]}, "has inputs that are not names"),
        ("law.json", GAIN | {"inputs": ["eror"]}, "'eror' is unknown; did you mean 'error'?"),
        ("law.json", LAW | {"B": [[1.0], [2.0]]}, "B is 2 x 1, expected 2 x 2: A has 2 rows, there are 2 inputs"),
        ("law.json", GAIN | {"dt": 0.02}, "controller.dt 0.02 s must equal loop.sample_period, 0.01 s"),
        ("law.txt", GAIN, "give a file that ends in .json, .npz, .mat"),
    ],
)
def test_what_is_not_a_law_is_refused_in_one_line(name: str, held: Any, said: str):
    write(name, held) if name != "law.txt" else Path(name).write_text("1")
    assert said in refusal(scenario_with(name))


def refusal(which: str, *changes: str) -> str:
    with pytest.raises(ScenarioError) as error:
        load(which, list(changes))
    assert "\n" not in str(error.value)
    return str(error.value)


HDF5 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"  # its first 128 bytes


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("law.mat", HDF5 + bytes(512), "is a MATLAB file of version 7.3, which is HDF5: save it with save('law.mat', "),
        ("law.mat", b"# Created by Octave\n", "is not a MATLAB file that can be read"),
        ("law.mat", b"", "is not a MATLAB file that can be read"),
        ("law.npz", b"PK\x03\x04 cut off", "is not an archive of plain arrays"),
        ("law.npz", b"", "is not an archive of plain arrays"),
        ("law.json", b'{"A": [[1', "is not JSON: "),
        ("law.json", b"\xff\xfe", "is not JSON: "),
    ],
)
def test_a_file_that_cannot_be_read_is_refused_in_one_line(name: str, content: bytes, said: str):
    Path(name).write_bytes(content)
    assert f"controller.file '{name}' {said}" in refusal(scenario_with(name))


def test_a_law_stands_in_the_file_or_in_the_scenario_not_in_both():
    write("law.json", GAIN)
    assert "and controller.D: give the law once, here or there" in refusal(scenario_with("law.json", "D = [[1.0]]\n"))
    assert "controller.file 'none.json': there is no such file beside" in refusal(scenario_with("none.json"))
    assert "kind 'pd' does not have it, but 'state-space'" in refusal("step", "controller.file=law.json")
