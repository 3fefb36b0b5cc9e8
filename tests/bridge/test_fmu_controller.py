"""An FMU as the controller of a run: ours gives the recording of its law; one of another tool; faults in sentences."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description

from bridge.errors import RunError, ScenarioError
from bridge.recording.digest import digest
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process, run_in_memory
from bridge.scenario import load
from tests.bridge.test_fmu import pytestmark as pytestmark
from tests.support.fmu import exported
from tests.support.processes import ROOT, hydrotwin

REFERENCE = ROOT / "build" / "peers" / "Reference-FMUs"
FEEDTHROUGH = REFERENCE / "2.0" / "Feedthrough.fmu"
FOREIGN = ROOT / "tests/support/foreign_law_fmu.py"
MAP = "controller.inputs={x='position in mm', x_ref='reference in mm', p='p2 in bar'}"
THEIRS = ("controller.kind=fmu", "controller.fmu=ForeignLaw.fmu", "controller.output=u in V", MAP)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Our own controllers and one of PythonFMU, in one folder."""
    made = tmp_path_factory.mktemp("laws")
    for version in ("2", "3"):
        exported("controller", load("step"), version, made / f"own{version}.fmu")
    build = [sys.executable, "-m", "pythonfmu", "build", "-f", str(FOREIGN), "-d", str(made)]
    subprocess.run(build, check=True, capture_output=True, cwd=made)
    return made


@pytest.fixture(autouse=True)
def here(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


@pytest.mark.parametrize("version", ["2", "3"])
def test_our_own_controller_gives_the_recording_of_its_law(version: str):
    """Also with a gain that changes on the way: bit for bit."""
    changed = '\n[[timeline]]\nset = "{}"\nat = "0.4 s"\nto = {}\n'
    own = f'extends = "step"\n[controller]\nkind = "fmu"\nfmu = "own{version}.fmu"\n[controller.parameters]\n'
    own += '"controller.proportional" = 12.0\n' + changed.format("controller.parameters.controller.proportional", 8.0)
    law = 'extends = "step"\n[controller]\ngain = "12 1/m"\n' + changed.format("controller.gain", '"8 1/m"')
    found = []
    for name, text in (("own", own), ("law", law)):
        Path(f"{name}{version}.toml").write_text(text)
        run = run_in_memory(load(f"{name}{version}.toml", ["duration=0.8", "reference.at=0.1"]))
        found.append([run.columns("command")["spool"].tolist(), run.columns("state")["position"].tolist()])
    assert found[0] == found[1]
    assert max(found[0][1]) - min(found[0][1]) > 0.01


def theirs(*changes: str):
    return load("step", [*THEIRS, "controller.parameters={kp=0.06}", "duration=0.3", "reference.at=0.05", *changes])


def test_an_fmu_of_another_tool_reads_its_units_and_writes_volts():
    run = run_in_memory(theirs())
    commands, seen = run.columns("command"), run.columns("measurement")
    wanted = run.columns("reference")["position"].tolist()
    for k, spool in enumerate(commands["spool"].tolist()):
        at = seen["stamp"].tolist().index(commands["sample_stamp"].tolist()[k])
        volts = 0.06 * (wanted[k] / 1e-3 - seen["position"][at] / 1e-3) - 0.001 * (seen["p2"][at] / 1e5)
        assert spool == pytest.approx(volts / 10.0, abs=1e-12)  # 10 V: full scale of the valve's input


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["controller.fmu=none.fmu"], "there is no such file beside the scenario"),
        (["controller.fmu=broken.fmu"], "is not an FMU"),
        (["controller.inputs={x='position'}"], "the FMU's input 'p' reads nothing: map it to a signal, or give it a"),
        (["controller.inputs.y=position"], "has no input 'y'"),
        (["controller.inputs.x=positon"], "reads the channel 'positon'"),
        (["controller.inputs.x=position in bar"], "unit 'bar' does not fit here"),
        (["controller.output=v"], "has no output 'v' that is a single number (valid: u)"),
        (["controller.output=u in mA"], "'mA' is not a unit of a spool reference: write 'u in V' or 'u in %'"),
        (["controller.parameters={k=1}"], "has no parameter of this name"),
    ],
)
def test_what_does_not_fit_is_one_sentence(changes: list[str], said: str):
    Path("broken.fmu").write_bytes(b"no archive")
    with pytest.raises(ScenarioError) as error:
        run_in_memory(theirs(*changes))
    assert said in str(error.value)


def test_an_fmu_that_fails_ends_the_run_with_what_it_says():
    with pytest.raises(RunError, match=r"controller\.fmu 'ForeignLaw\.fmu' at t = 0 s: .*fail"):
        run_in_memory(theirs("controller.parameters.kp=-1"))


def test_an_fmu_for_another_machine_says_so(folder: Path):
    with zipfile.ZipFile("own2.fmu") as ours, zipfile.ZipFile("other.fmu", "w") as other:
        for name in ours.namelist():
            other.writestr(name.replace("linux64", "win64"), ours.read(name))
    with pytest.raises(ScenarioError, match="cannot be loaded on this machine"):
        run_in_memory(load("step", ["controller.kind=fmu", "controller.fmu=other.fmu"]))


def test_an_array_is_no_spool_reference(folder: Path):
    with zipfile.ZipFile("own3.fmu") as ours, zipfile.ZipFile("array.fmu", "w") as other:
        for name in ours.namelist():
            content = ours.read(name).decode("latin-1")
            if name == "modelDescription.xml":
                before, begin, after = content.partition('<Float64 name="spool"')
                content = before + begin + after.replace("/>", '><Dimension start="2" /></Float64>', 1)
            other.writestr(name, content.encode("latin-1"))
    with pytest.raises(ScenarioError, match="has no output 'spool' that is a single number"):
        run_in_memory(load("step", ["controller.kind=fmu", "controller.fmu=array.fmu"]))


def test_without_fmpy_one_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(ScenarioError, match=r"needs FMPy: pip install 'hydrotwin\[fmu\]'"):
        run_in_memory(theirs())


@pytest.mark.skipif(not FEEDTHROUGH.is_file(), reason=f"unpack the FMI project's Reference FMUs into {REFERENCE}")
def test_the_feedthrough_of_the_fmi_project_is_a_proportional_law():
    """Numbers of every type go in; the output in % of an error in mm is a gain of 10 1/m."""
    numbers = "Float64_discrete_input=0, Int32_input=3, Boolean_input=1, Enumeration_input=2"
    own = [
        "controller.kind=fmu",
        f"controller.fmu={FEEDTHROUGH}",
        f"controller.inputs={{Float64_continuous_input='error in mm', {numbers}}}",
        "controller.output=Float64_continuous_output in %",
    ]
    short = ["duration=0.4", "reference.at=0.05"]
    theirs = run_in_memory(load("step", [*own, *short])).columns("command")["spool"]
    gains = ["controller.gain=10 1/m", "controller.derivative=0", "controller.compensate_overlap=false"]
    ours = run_in_memory(load("step", [*gains, *short])).columns("command")["spool"]
    assert max(theirs) > 0.3
    assert theirs == pytest.approx(ours, abs=1e-9)  # rounding alone, over a run


@pytest.mark.endurance
@pytest.mark.timeout(120)
@pytest.mark.skipif(not REFERENCE.is_dir(), reason=f"unpack the FMI project's Reference FMUs into {REFERENCE}")
def test_each_fmu_of_the_fmi_project_runs_or_says_in_a_sentence_why_not():
    found = {}
    for path in sorted(REFERENCE.glob("[23].0/*.fmu")):
        outputs = [v.name for v in read_model_description(path).modelVariables if v.causality == "output"]
        changes = ["controller.kind=fmu", f"controller.fmu={path}", f"controller.output={outputs[0]}", "duration=0.3"]
        try:
            run_in_memory(load("step", changes))
            found[path.parts[-2:]] = "runs"
        except (ScenarioError, RunError) as error:
            found[path.parts[-2:]] = str(error)
        print(*path.parts[-2:], found[path.parts[-2:]])
    assert all(words and "Traceback" not in words for words in found.values())


@pytest.mark.endurance
@pytest.mark.timeout(120)
@pytest.mark.parametrize("mode", ["lockstep", "realtime"])
@pytest.mark.parametrize("whose", ["ours", "theirs"])
def test_over_zenoh_the_data_are_those_of_one_process(whose: str, mode: str):
    """Of our FMU and of PythonFMU's; a good run, and in real time without a late command the same bytes."""
    own = load("step", ["controller.kind=fmu", "controller.fmu=own2.fmu", "duration=2"])
    scenario = {"ours": own, "theirs": theirs("duration=2")}[whose]
    alone = record_in_process(scenario, Path(f"{whose}-alone.mcap"))
    Path(f"{whose}.json").write_text(scenario.model_dump_json())
    done = hydrotwin("run", f"{whose}.json", "--mode", mode, "--record", f"{whose}.mcap", cwd=Path.cwd())
    assert done.returncode == 0, done.stderr
    summary = read(Path(f"{whose}.mcap")).metadata["summary"]
    print(whose, mode, summary["commands"], summary["timing"].get("round_trip"))
    assert (summary["commands"]["refused"], summary["safe_states"]) == ({}, 0)
    if not summary["commands"]["late"]:
        assert digest(Path(f"{whose}.mcap")) == digest(alone.path)
