"""Plant and controller as FMUs: the same bits as a run, in a host in C and in FMPy; what cannot be is one sentence."""

import ctypes
import random
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from bridge.connect.fmu.build import OURS
from bridge.connect.fmu.platforms import zig
from bridge.connect.fmu.ziggurat import tables
from bridge.loop.law import law_of
from bridge.recording.reader import Recording
from bridge.runs.in_process import run_in_memory
from bridge.scenario import Scenario, load
from bridge.scenario.gains import law_gains
from bridge.scenario.unit_dimensions import dimensions
from bridge.scenario.units import UNITS
from controller.law import Sample
from controller.laws import LAWS
from controller.reference import Target
from tests.support.c_law import page
from tests.support.command import hydrotwin_here
from tests.support.fmu import EMULATORS, Opened, coupled, coupled_elsewhere, exported, opened, watched
from twin.sensors import noise_block

CC = shutil.which("cc")
pytestmark = pytest.mark.skipif(CC is None, reason="there is no C compiler `cc` on this machine")
PID = ("controller.kind=pid", "controller.integral=1 V/(% s)", "controller.velocity=filtered")
CHANGES = (
    "duration=1.2",
    "reference.at=0.1",
    "loop.delay=2.35 ms",
    *PID,
    "daq.channels=['force','acceleration','p_a']",
)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    """With noise, channels that are derived, and a delay that is not whole ticks."""
    return load("step", list(CHANGES))


@pytest.fixture(scope="module")
def run(scenario: Scenario) -> Recording:
    return run_in_memory(scenario)


@pytest.fixture(scope="module")
def files(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Both FMUs in both versions."""
    folder = tmp_path_factory.mktemp("fmus")
    return {
        f"{kind}{version}": exported(kind, scenario, version, folder / f"{kind}{version}.fmu")
        for kind in ("plant", "controller")
        for version in ("2", "3")
    }


@pytest.mark.parametrize("version", ["2", "3"])
def test_a_host_in_c_closes_the_loop_as_run_does(version: str, files: dict[str, Path], run: Recording, tmp_path: Path):
    """Bit for bit: all that the card reads and all true quantities, at every tick; half way a step is taken back."""
    ticks, step = len(run.columns("state")["stamp"]) - 1, 1e-3
    with opened(files[f"plant{version}"]) as plant, opened(files[f"controller{version}"]) as law:
        found = coupled(plant, law, run, step, ticks, tmp_path)
        columns = watched(plant, run)
    assert np.ptp(run.columns("state")["position"]) > 0.03
    assert len(columns) > 40
    for column, (name, recorded) in zip(found.T, columns.items(), strict=False):
        assert np.array_equal(column, recorded, equal_nan=True), name


def test_fmpy_finds_nothing_wrong_in_either_version(files: dict[str, Path]):
    assert {name: validate_fmu(str(path)) for name, path in files.items()} == {name: [] for name in files}


def stepped(plant: Opened, begin: int, end: int, spools: dict[int, float], *names: str) -> list[list[float]]:
    """What a plant says at the end of each millisecond of a stretch [ms]."""
    rows = []
    for tick in range(begin, end):
        if tick in spools:
            plant.set("spool", spools[tick])
        plant.step(tick * 1e-3, 1e-3)
        rows.append(plant.get([*names]))
    return rows


def test_numbers_of_the_rig_change_as_the_timeline_changes_them(files: dict[str, Path], tmp_path: Path):
    """Inputs and tunable parameters, in the middle of a run, bit for bit; the card's too."""
    changes = {"rig.load.force": 800.0, "rig.pump.speed": 18.5, "rig.relief.spool_mass": 0.08, "sensor.p2.offset": 2e5}
    lines = [f'[[timeline]]\nset = "{name}"\nat = "0.2 s"\nto = {value}\n' for name, value in changes.items()]
    (tmp_path / "own.toml").write_text('extends = "step"\n' + "\n".join(lines))
    own = run_in_memory(load(str(tmp_path / "own.toml"), [*CHANGES, "duration=0.4"]))
    commands = own.columns("command")
    spools = dict(zip((commands["sample_stamp"] // 1_000_000).tolist(), commands["spool"].tolist(), strict=True))
    with opened(files["plant2"]) as plant:
        names = [*watched(plant, own)]
        rows = stepped(plant, 0, 200, spools, *names)
        for name, value in changes.items():
            plant.set(name, value)
        rows += stepped(plant, 200, 400, spools, *names)
        columns = watched(plant, own)
    for column, name in zip(np.array(rows).T, names, strict=True):
        seen = np.flatnonzero(column != columns[name][1:])
        assert seen.tolist() == ([199] if name == "measurement.p2" else []), name  # a host cannot set before a scan
    assert abs(columns["measurement.p2"][-1] - columns["state.p_lower"][-1] - 2e5) < 1e5


def test_a_saved_state_goes_on_as_if_nothing_had_been(files: dict[str, Path]):
    """Also as bytes, and in another instance; noise included. Those of another FMU are refused."""
    names = ("measurement.p2", "channels.force", "state.position", "state.oil_stored")
    with opened(files["plant3"]) as plant, opened(files["plant3"]) as other, opened(files["controller3"]) as law:
        stepped(plant, 0, 100, {3: 0.4})
        state = plant.slave.getFMUState()
        content = plant.slave.serializeFMUState(state)
        first = stepped(plant, 100, 200, {120: -0.2}, *names)
        plant.slave.setFMUState(state)
        again = stepped(plant, 100, 200, {120: -0.2}, *names)
        other.slave.setFMUState(other.slave.deserializeFMUState(content))
        assert first == again == stepped(other, 100, 200, {120: -0.2}, *names)
        with pytest.raises(FMICallException):
            law.slave.deserializeFMUState(content)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [("spool", 1.5, "stays"), ("rig.load.mass", -1.0, "range"), ("loop.delay", 0.0, "fixed"), ("loop.step", 1.0, "no")],
)
def test_what_cannot_be_set_is_refused_and_changes_nothing(
    name: str, value: float, reason: str, files: dict[str, Path]
):
    """An input only with a warning, as the plant refuses a command and goes on."""
    with opened(files["plant2"]) as plant:
        before = plant.get([name])
        if reason == "stays":
            plant.set(name, value)
        else:
            with pytest.raises(FMICallException):
                plant.set(name, value)
        assert plant.get([name]) == before


@pytest.mark.parametrize(("time", "step"), [(0.0, 1.02e-3), (0.0, 0.0), (0.5, 1e-3), (0.0, float("nan"))])
def test_a_step_off_the_grid_fails(time: float, step: float, files: dict[str, Path]):
    with opened(files["plant2"]) as plant, pytest.raises(FMICallException):
        plant.step(time, step)


def test_noise_is_numpy_s(tmp_path: Path):
    """Twenty beginnings of streams, some 100 000 numbers, the tail beyond the ziggurat among them; to the last bit."""
    (tmp_path / "ziggurat.h").write_text(tables())
    flat = "void fill(uint64_t seed, uint64_t block, double *to, int n) {\n"
    flat += "  stream s = stream_of(seed, 0, 0, block);\n  for (int i = 0; i < n; i++) to[i] = normal(&s);\n}\n"
    (tmp_path / "all.c").write_text(f'#include "noise.c"\n{flat}')
    flags = ["-O1", "-ffp-contract=off", "-fPIC", "-shared", "-I", str(OURS), "-I", str(tmp_path)]
    subprocess.run(["cc", *flags, "-o", str(tmp_path / "all.so"), str(tmp_path / "all.c"), "-lm"], check=True)
    library = ctypes.CDLL(str(tmp_path / "all.so"))
    greatest = 0.0
    for block in range(20):
        wanted = noise_block(7, block)
        found = np.zeros_like(wanted)
        address = found.ctypes.data_as(ctypes.c_void_p)
        library.fill(ctypes.c_uint64(7), ctypes.c_uint64(block), address, wanted.size)
        assert np.array_equal(found, wanted)
        greatest = max(greatest, float(np.abs(found).max()))
    assert greatest > 3.66  # the edge of the ziggurat


def sample_of(number: int, values: list[float]) -> Sample:
    """A sample every 10 ms."""
    position, velocity, p1, p2, p3 = values
    return Sample(10_000_000 * number, position, velocity, p1, p2, p3)


KINDS = {
    "pd": ("controller.derivative=0.02 V s/%", "controller.velocity=filtered", "controller.overlap_rest=0.02"),
    "pid": (*PID[1:2], "controller.velocity=backward", "controller.anti_windup=clamping", "controller.limit=0.7"),
    "relay": ("controller.derivative_time=0.05",),
    "state-space": (
        "controller.A=[[0.9,0.1],[-0.2,0.5]]",
        "controller.B=[[1,0,1e-8],[2,0.1,0]]",
        "controller.C=[[1,0.2]]",
        "controller.D=[[3,0.4,-2e-8]]",
        "controller.dt=0.01",
        "controller.inputs=['error','velocity','p2']",
    ),
    "open-loop": ("reference.start=0.1", "reference.end=0.2"),
}
JUMPS = ("controller.compensate_overlap=true",)


def test_every_law_of_ours_has_its_text_in_c():
    assert set(KINDS) == set(LAWS)


@pytest.mark.parametrize(
    "kind",
    [
        "state-space",
        *(
            pytest.param(k, marks=(pytest.mark.endurance, pytest.mark.timeout(60)))
            for k in ("pd", "pid", "relay", "open-loop")
        ),
    ],
)
def test_a_law_in_c_answers_as_in_python(kind: str, tmp_path: Path):
    """Random samples, from far beyond the limit to the noise of a piston that stands still; gains changed half way."""
    jumps = JUMPS if kind in ("pd", "pid", "state-space") else ()
    asked = load("step", [f"controller.kind={kind}", *KINDS[kind], *jumps])
    law, gains, memory = law_of(asked.controller), law_gains(asked), None
    draw = random.Random(3)
    with opened(exported("controller", asked, "2", tmp_path / "law.fmu")) as fmu:
        for k in range(300):
            if k == 150:
                gains = gains._replace(limit=0.5)
                fmu.set("controller.limit", 0.5)
            size = 10.0 ** draw.uniform(-6.0, 0.0)
            values = [draw.gauss(0.1, size), draw.gauss(0.0, size), *(draw.uniform(0.0, 1e7) for _ in range(3))]
            target = Target(draw.gauss(0.1, 0.1 * size), draw.gauss(0.0, 0.1))
            wanted, memory, *_ = law.answer(sample_of(k, values), target, memory, gains)
            for name, value in zip(("position", "velocity", "p1", "p2", "p3"), values, strict=True):
                fmu.set(f"measurement.{name}", value)
            fmu.set("reference.position", target.position)
            fmu.set("reference.velocity", target.velocity)
            fmu.step(k * 0.01, 0.01)
            assert fmu.get(["spool"]) == [wanted], k


@pytest.mark.parametrize("version", ["2", pytest.param("3", marks=(pytest.mark.endurance, pytest.mark.timeout(60)))])
def test_fmpy_couples_a_law_in_c_with_the_plant_as_run_does(
    version: str, files: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The user's law of docs/running.md, exported from its C file; FMPy is the master, the bits are those of `run`."""
    monkeypatch.chdir(tmp_path)
    Path("law.c").write_text(page("c"))
    Path("law.toml").write_text(page("toml"))
    asked = load("law.toml", [*(change for change in CHANGES if change not in PID), "duration=0.4"])
    run = run_in_memory(asked)
    wanted = run.columns("reference")
    targets = dict(zip(wanted["stamp"].tolist(), zip(wanted["position"], wanted["velocity"], strict=True), strict=True))
    law_file = exported("controller", asked, version, tmp_path / "law.fmu")
    with opened(files[f"plant{version}"]) as plant, opened(law_file) as law:
        columns, rows = watched(plant, run), []
        read = [name for name in law.at if name.startswith("measurement.")]
        for tick in range(400):
            told = dict(zip(read, plant.get(read), strict=True))
            if (target := targets.get(tick * 1_000_000)) is not None:
                told |= dict(zip(("reference.position", "reference.velocity"), target, strict=True))
            for name, value in told.items():
                law.set(name, value)
            law.step(tick * 1e-3, 1e-3)
            rows += stepped(plant, tick, tick + 1, {tick: law.get(["spool"])[0]}, *columns)
    assert np.ptp(run.columns("state")["position"]) > 0.03
    for column, (name, recorded) in zip(np.array(rows).T, columns.items(), strict=True):
        assert np.array_equal(column, recorded[1:], equal_nan=True), name


def test_units_are_taken_apart_into_those_of_the_si():
    assert dimensions("m^3/(s Pa)") == {"m": 4, "s": 1, "kg": -1}
    assert dimensions("N s^2/m^2") == {"kg": 1, "m": -1}
    assert dimensions("1/(m s)") == {"m": -1, "s": -1}
    without = {"", "byte", "bit", "LSB"}  # not numbers of a rig
    assert all(dimensions(unit) for unit in UNITS if unit not in without)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["plant", "step", "--platform", "arm"], "--platform 'arm' is not a platform"),
        (["controller", "step", "--set", "controller.law=mine:law"], "a law in Python cannot run without Python"),
        (["controller", "step", "--set", "controller.kind=fmu", "--set", "controller.fmu=a.fmu"], "is an FMU already"),
        (["plant", "step", "--set", "seed=4294967296"], "choose another seed"),
    ],
)
def test_what_cannot_be_exported_is_one_sentence(words: list[str], said: str, tmp_path: Path):
    done = hydrotwin_here("fmu", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


def test_without_a_c_compiler_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setattr("bridge.connect.fmu.platforms.zig", list)
    done = hydrotwin_here("fmu", "plant", "step", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "there is no 'no-such-compiler' on this machine: install gcc or clang" in done.stderr


DRIVES = (
    "step",
    "crane",
    "ehla",
    "motor",
    "press",
    "test-cylinder",
    "impingement",
    "load-change",
    "valve-slam",
    "start-up",
)


@pytest.mark.endurance
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", DRIVES)
def test_each_built_in_drive_as_an_fmu_runs_as_in_process(name: str, tmp_path: Path):
    """Its own controller, all of the run up to 5 s; bit for bit, in the host in C."""
    asked = load(name)
    if asked.duration > 5.0:
        asked = load(name, ["duration=5"])
    own = run_in_memory(asked)
    plant_file = exported("plant", asked, "2", tmp_path / "plant.fmu")
    law_file = exported("controller", asked, "2", tmp_path / "law.fmu")
    with opened(plant_file) as plant, opened(law_file) as law:
        found = coupled(plant, law, own, asked.loop.daq_period, asked.ticks, tmp_path)
        for column, (signal, recorded) in zip(found.T, watched(plant, own).items(), strict=False):
            assert np.array_equal(column, recorded, equal_nan=True), signal


@pytest.mark.endurance
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("name", EMULATORS)
def test_an_fmu_for_another_machine_runs_there(name: str, tmp_path: Path):
    """Linked by zig, in an emulator. The last bits of its exp, log and pow may be others, so to 1 um in 0.5 s."""
    if not zig() or not shutil.which(EMULATORS[name][0]):
        pytest.skip(f"needs ziglang and {EMULATORS[name][0]}")
    asked = load("step", ["duration=0.5", "reference.at=0.1"])
    own, machines = run_in_memory(asked), ("x86_64-linux", name)
    files = [exported(kind, asked, "2", tmp_path / f"{kind}.fmu", machines) for kind in ("plant", "controller")]
    with opened(files[0]) as plant, opened(files[1]) as law:
        found = coupled_elsewhere(name, plant, law, own, tmp_path)
        columns = watched(plant, own)
    seen = dict(zip(columns, found.T, strict=False))
    same = sum(np.array_equal(seen[signal], recorded, equal_nan=True) for signal, recorded in columns.items())
    print(f"{name}: {same} of {len(columns)} columns are those of the run, bit for bit")
    assert np.ptp(seen["state.position"]) > 0.03
    assert np.abs(seen["state.position"] - columns["state.position"]).max() < 1e-6
