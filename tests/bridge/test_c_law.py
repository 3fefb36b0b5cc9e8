"""A law in C: called with what the header says, as fresh in each run as its memory, and each mistake in one line."""

import hashlib
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from bridge.errors import RunError
from bridge.loop.c_compiler import HEADER
from bridge.loop.c_law import SAMPLE, TARGET
from bridge.loop.controller import ControllerSide
from bridge.loop.law import law_of
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import Scenario, load
from bridge.scenario.gains import law_gains
from controller.law import Sample
from controller.reference import Target
from tests.support.c_law import page, scenario, written
from tests.support.command import hydrotwin_here
from tests.support.processes import UNDRAWN, hydrotwin

CC = shutil.which("cc")
pytestmark = pytest.mark.skipif(CC is None, reason="there is no C compiler `cc` on this machine")
REST = Sample(0, 0.1, 0.0, 0.0, 0.0, 0.0), Target(0.1, 0.0)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache"


def answers(asked: Scenario, count: int, sample: Sample = REST[0], target: Target = REST[1]) -> list[float]:
    """Of a fresh run."""
    law, memory, found = law_of(asked.controller), None, []
    gains = law.prepare(law_gains(asked))
    for _ in range(count):
        spool, memory, *_ = law.answer(sample, target, memory, gains)
        found.append(spool)
    return found


def pages_law() -> None:
    Path("law.c").write_text(page("c"))
    Path("law.toml").write_text(page("toml"))


def test_the_page_s_law_commands_what_our_pid_commands():
    """To the last bit: the same operations in the same order; the true positions are then the same too."""
    pages_law()
    theirs = record_in_process(load("law.toml"), Path("a.mcap"))
    gains = ["gain=1 V/%", "derivative=0.01 V s/%", "integral=0.2 V/(% s)", "anti_windup=clamping"]
    pid = load("step", ["controller.kind=pid", "duration=3", *(f"controller.{gain}" for gain in gains)])
    ours = record_in_process(pid, Path("b.mcap"))
    for topic, name in (("command", "spool"), ("state", "position")):
        found = [run.columns(topic)[name] for run in (theirs, ours)]
        assert np.ptp(found[0]) > 0.01
        assert found[0].tolist() == found[1].tolist()


CHANGE = '\n[[timeline]]\nset = "{}"\nat = "0.4 s"\nto = "2 V/%"\n'


def test_a_parameter_that_changes_on_the_way_is_a_gain_that_does():
    """From the same sample on, to the last bit."""
    pages_law()
    gains = 'kind = "pid"\ngain = "1 V/%"\nderivative = "0.01 V s/%"\nintegral = "0.2 V/(% s)"\n'
    pid = f'extends = "step"\n[controller]\n{gains}anti_windup = "clamping"\n'
    texts = page("toml") + CHANGE.format("controller.parameters.kp"), pid + CHANGE.format("controller.gain")
    found = []
    for name, text in zip(("a", "b"), texts, strict=True):
        Path(f"{name}.toml").write_text(text)
        recorded = record_in_process(load(f"{name}.toml", ["duration=1", "reference.at=0.3"]), Path(f"{name}.mcap"))
        found.append(recorded.columns("command")["spool"].tolist())
    assert found[0] == found[1]
    pages = record_in_process(load("law.toml", ["duration=1", "reference.at=0.3"]), Path("c.mcap"))
    plain = pages.columns("command")["spool"].tolist()
    assert plain[:40] == found[0][:40]
    assert plain[41:] != found[0][41:]


def test_the_recording_keeps_the_law_and_its_numbers():
    pages_law()
    record_in_process(load("law.toml", ["duration=0.02"]), Path("a.mcap"))
    run, text = read(Path("a.mcap")).metadata["run"], page("c")
    assert run["law"] == {"name": "law.c", "sha256": hashlib.sha256(text.encode()).hexdigest(), "text": text}
    assert run["scenario"]["controller"]["parameters"]["ki"] == "0.2 V/(% s)"
    said = hydrotwin_here("info", "a.mcap", cwd=Path.cwd()).stdout
    assert f"law.c, sha256 {run['law']['sha256'][:12]}" in said
    assert "under the law law.c" in said or "law.c" in said


def test_the_law_gets_what_the_header_says():
    """A weight for each number: a sum of all of them tells every mistake in a place, a unit or an order."""
    fields = [f"sample->{name}" for name in ("position", "velocity", "p1", "p2", "p3")]
    fields += ["target->position", "target->velocity", "facts->sample_period", "facts->limit", "facts->overlap"]
    fields += ["parameters[0]", "parameters[1]", "1e-9 * (double)sample->stamp"]
    total = " + ".join(f"{2.0**-k} * {field}" for k, field in enumerate(fields))
    written(f"*spool = {total}; return 0;", 'const char *const hydrotwin_law_parameters[] = {"a", "b", 0};\n')
    asked = scenario("controller.parameters.b=5 bar", "controller.parameters.a=2 mm", "controller.limit=0.5")
    overlap = asked.rig.valve.overlap
    sample, target = Sample(3_000_000_000, 1.5, -2.5, 3.5, 4.5, 5.5), Target(6.5, 7.5)
    numbers = [1.5, -2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 0.01, 0.5, overlap, 2e-3, 5e5, 3.0]
    wanted = sum(2.0**-k * number for k, number in enumerate(numbers))
    assert answers(asked, 1, sample, target) == [pytest.approx(wanted, rel=1e-14)]


def test_the_header_has_every_number_of_a_sample_and_a_target():
    assert Sample._fields[: len(SAMPLE)] == SAMPLE
    assert Target._fields == TARGET
    assert hydrotwin_here("messages", "--c", cwd=Path.cwd()).stdout == HEADER.read_text()


COUNTING = "static double calls; memory[0] += 1.0; calls += 1.0; *spool = 0.1 * calls + 0.01 * memory[0]; return 0;"
MEMORY = "const int32_t hydrotwin_law_memory = 1;\n"


def test_memory_and_static_variables_are_fresh_in_each_run():
    """Two runs that take turns in one process, and one after them."""
    written(COUNTING, MEMORY)
    asked = scenario()
    sides = [ControllerSide(asked, source) for source in (1, 2)]
    for count in (1, 2, 3):
        for side in sides:
            assert side.decide(REST[0])[0] == pytest.approx(0.11 * count)
    assert answers(asked, 2) == pytest.approx([0.11, 0.22])


@pytest.mark.parametrize("kept", [False, True])
def test_the_memory_is_forgotten_at_a_safe_state_unless_the_law_has_hooks(kept: bool):
    hooks = "void hydrotwin_law_on_safe_state(double *m) { m[0] += 10; }\n"
    hooks += "void hydrotwin_law_on_resume(double *m) { m[0] += 20; }\n"
    written("memory[0] += 1.0; *spool = memory[0] / 100; return 0;", MEMORY + hooks * kept)
    asked = scenario()
    law = law_of(asked.controller)
    gains = law.prepare(law_gains(asked))
    assert law.on_safe_state(None) is None
    _, memory, *_ = law.answer(*REST, None, gains)
    _, memory, *_ = law.answer(*REST, law.on_resume(law.on_safe_state(memory)), gains)
    assert law.answer(*REST, memory, gains)[0] == pytest.approx(0.33 if kept else 0.02)


def test_init_fills_the_memory():
    init = "int hydrotwin_law_init(const hydrotwin_facts *f, const double *p, double *m)"
    written("*spool = memory[0]; return 0;", MEMORY + init + " { m[0] = f->sample_period; return 0; }\n")
    assert answers(scenario(), 2) == [0.01, 0.01]


def test_what_a_law_logs_is_recorded_in_si():
    """In mm and bar in the law, and without a unit; a law without signals has no such topic."""
    signals = (
        'const hydrotwin_signal hydrotwin_law_signals[] = {{"gap", "mm"}, {"load", "bar"}, {"calls", ""}, {0, 0}};\n'
    )
    body = "signals[0] = 1e3 * (target->position - sample->position); signals[1] = 1e-5 * sample->p2; "
    written(body + "signals[2] = memory[0] += 1.0; *spool = 0.0; return 0;", MEMORY + signals)
    found = record_in_process(scenario("duration=0.05"), Path("a.mcap"))
    first, *_, last = found.messages("signals")
    assert (first.names, first.units) == (["gap", "load", "calls"], ["m", "Pa", ""])
    read_p2 = dict(zip(*(found.columns("measurement")[name].tolist() for name in ("stamp", "p2")), strict=True))
    assert last.values[1] == pytest.approx(read_p2[last.stamp])
    assert [message.values[2] for message in found.messages("signals")] == list(range(1, last.sequence + 2))
    written("*spool = 0.0; return 0;")
    assert "signals" not in record_in_process(scenario("duration=0.05"), Path("b.mcap")).counts


@pytest.mark.parametrize(
    ("body", "more", "said"),
    [
        ("*spool = 0; return sample->stamp > 15000000 ? 3 : 0;", "", "law.c' returned 3 at t = 0.02 s"),
        ("*spool = NAN; return 0;", "", "law.c' set spool to nan, or not at all, at t = 0 s"),
        ("return 0;", "", "law.c' set spool to nan, or not at all, at t = 0 s"),
        ("*spool = 1 / facts->limit / 0.0; return 0;", "", "law.c' set spool to inf"),
        (
            "*spool = 0; return 0;",
            "int hydrotwin_law_init(const hydrotwin_facts *f, const double *p, double *m) { return 7; }\n",
            "law.c': hydrotwin_law_init returned 7",
        ),
    ],
)
def test_a_law_that_fails_ends_the_run_in_one_line(body: str, more: str, said: str):
    """The recording of the run ends where the law did, and is whole."""
    written(body, more)
    with pytest.raises(RunError) as raised:
        record_in_process(scenario(), Path("a.mcap"))
    assert said in str(raised.value)
    assert "\n" not in str(raised.value)
    assert read(Path("a.mcap")).complete


def test_it_is_compiled_again_when_what_it_includes_changes(cache: Path, monkeypatch: pytest.MonkeyPatch):
    """And only then: the second time the compiler may not make anything."""
    written("*spool = SPOOL; return 0;", '#include "spool.h"\n')
    for spool in (0.25, 0.5):
        Path("spool.h").write_text(f"#define SPOOL {spool}\n")
        assert answers(scenario(), 1) == [spool]
    kept = list(cache.rglob("*.so"))
    assert len(kept) == 2
    assert answers(scenario(), 1) == [0.5]
    assert {file.stat().st_mtime_ns for file in kept} == {file.stat().st_mtime_ns for file in cache.rglob("*.so")}


def shared(name: str, *more: str) -> None:
    command = [CC or "", "-O2", "-fPIC", "-shared", "-I", str(HEADER.parent), name, "-o", Path(name).stem + ".so"]
    subprocess.run([*command, *more], check=True)


def test_a_library_beside_a_scenario_is_found_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """By its full path; the recording keeps its name and hash, and no text."""
    written("*spool = 0.25; return 0;")
    shared("law.c")
    Path("own.toml").write_text('extends = "step"\nduration = 0.02\n[controller]\nkind = "c"\nlibrary = "law.so"\n')
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    recorded = record_in_process(load("../own.toml"), Path("a.mcap"))
    assert set(recorded.columns("command")["spool"]) == {0.25}
    law = recorded.metadata["run"]["law"]
    assert law == {"name": "law.so", "sha256": hashlib.sha256((tmp_path / "law.so").read_bytes()).hexdigest()}


def test_a_library_that_needs_its_neighbour_is_opened_where_it_stands():
    Path("other.c").write_text("double other(void) { return 0.125; }\n")
    shared("other.c")
    written("*spool = other(); return 0;", "double other(void);\n")
    shared("law.c", "-L.", "-l:other.so", "-Wl,-rpath,$ORIGIN")
    assert answers(scenario("controller.source=", "controller.library=law.so"), 1) == [0.125]


def test_a_crash_ends_the_controller_s_process_and_no_other():
    """The run ends, says who was killed, and its recording is whole; until then it is that of one process."""
    crash = "*spool = 1e-3 * memory[0]; memory[0] += 1.0; if (sample->stamp > 100000000) *nowhere = 1.0; return 0;"
    written(crash, MEMORY + "static double *volatile nowhere;\n")
    own = ("--set", "controller.kind=c", "--set", "controller.source=law.c", "--mode", "lockstep")
    done = hydrotwin("run", *UNDRAWN, "step", "--duration", "0.3", *own, "--record", "a.mcap", cwd=Path.cwd())
    assert done.returncode == 1
    assert "was killed by SIGSEGV" in done.stdout + done.stderr
    cut, whole = read(Path("a.mcap")), record_in_process(scenario("duration=0.1"), Path("b.mcap"))
    assert cut.complete
    assert cut.columns("command")["spool"].tolist() == whole.columns("command")["spool"].tolist()
    positions = whole.columns("state")["position"].tolist()
    assert cut.columns("state")["position"][: len(positions)].tolist() == positions
