"""However a command ends, and whenever: nobody is left of those that it has started, and Ctrl-C ends it soon."""

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from bridge.errors import RunError
from bridge.machine.children import guarded, python
from bridge.machine.guard import VARIABLE, marked
from bridge.machine.process import Stop
from bridge.recording.reader import read
from bridge.runs.in_process import record_in_process
from bridge.scenario import load
from bridge.studies.sweep.crew import local
from bridge.wire.link import free_endpoint
from tests.support.command import hydrotwin_here
from tests.support.endings import ENDINGS, TERMINAL, Ended, Ending, end
from tests.support.processes import ENVIRONMENT, UNDRAWN, wait_for

STARTED = 1.0  # [s] in which Python itself starts, whatever the machine is doing
DEAF = "import signal, time; [signal.signal(n, signal.SIG_IGN) for n in (1, 2, 15)]; time.sleep(60)"
FAMILY = f"""
import subprocess, sys, time
from bridge.machine.children import guarded, python
child = "import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', {DEAF!r}], start_new_session=True)"
child += "; time.sleep(60)"
with guarded(grace=0.5) as environment:
    subprocess.Popen(python("-c", child), env=environment, start_new_session=True)
    print(environment[{VARIABLE!r}].rpartition(":")[2], flush=True)
    time.sleep(float(sys.argv[1]))
    raise ValueError("as foreseen")
"""


@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGHUP, signal.SIGINT, None])
@pytest.mark.parametrize("moment", [0.0, 0.3])
def test_a_grandchild_deaf_to_signals_ends_with_its_grandparent(ending: signal.Signals | None, moment: float):
    """In a session of its own, killed or by an exception, at once or when all are up."""
    command = [sys.executable, "-c", FAMILY, "60" if ending else str(moment)]
    with subprocess.Popen(
        command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as family:
        assert family.stdout is not None
        token = family.stdout.readline().strip()
        assert len(token) == 32
        time.sleep(moment)
        if ending:
            family.send_signal(ending)
        family.wait(10)
    wait_for(lambda: not marked(token), 10)


def test_a_stopped_child_ends_too():
    with guarded(grace=0.5) as environment:
        child = subprocess.Popen(python("-c", DEAF), env=environment)
        child.send_signal(signal.SIGSTOP)
    assert child.wait(5) < 0


def test_who_ends_in_order_is_not_kept_waiting():
    begun = time.monotonic()
    with guarded():
        pass
    assert time.monotonic() - begun < 1.0


def test_a_worker_that_is_killed_is_said_in_one_line():
    with pytest.raises(RunError, match="a worker process was killed"), local(_killed, 2) as ask:
        list(ask([{"a": 1}, {"a": 2}]))


def _killed(point: object) -> dict:
    import os

    os.kill(os.getpid(), signal.SIGKILL)
    return {}


def test_the_first_ctrl_c_asks_and_the_next_one_ends():
    code = (
        "import signal, time; from bridge.machine.process import Stop\n"
        "stop = Stop().listen(); print('on', flush=True)\n"
        "while True:\n    time.sleep(0.01)\n    print(stop(), flush=True) if stop() else None"
    )
    with subprocess.Popen([sys.executable, "-c", code], env=ENVIRONMENT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "True\n"
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGHUP)
        assert process.stdout.readline() == "True\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(5) == -signal.SIGINT


def test_signals_are_given_back():
    before = signal.getsignal(signal.SIGINT)
    stop = Stop().listen()
    stop.leave()
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_ends_a_recorder_that_waits_for_its_plant(tmp_path: Path):
    found = end(["record", "--connect", free_endpoint(), "--patience", "60"], signal.SIGINT, 4.0, tmp_path)
    assert_ended(found)


def test_files_in_the_working_folder_get_in_nobodys_way(tmp_path: Path):
    """Whatever they are called: children look for modules where we do."""
    for name in ("controller.py", "twin.py", "bridge.py", "json.py", "controller/__init__.py", "bridge/__init__.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("raise SystemExit('imported by mistake')\n")
    command = Path(sys.executable).with_name("hydrotwin")
    words = ["run", "step", "--mode", "lockstep", "--duration", "0.05", "--record", "a.mcap", *UNDRAWN]
    done = subprocess.run([command, *words], cwd=tmp_path, capture_output=True, text=True, timeout=110)
    assert done.returncode == 0, done.stdout + done.stderr
    assert read(tmp_path / "a.mcap").complete


def test_a_run_that_leaves_no_recording_is_never_good(tmp_path: Path):
    """Not either where an earlier one lies there."""
    path = tmp_path / "a.mcap"
    record_in_process(load("step", ["duration=0.05"]), path)
    before = path.read_bytes()
    code = (
        "import sys; import bridge.processes.child as c; c.python = lambda *a: [sys.executable, '-c', '']\n"
        f"sys.argv[1:] = ['run', 'step', '--mode', 'lockstep', '--record', {str(path)!r}]\n"
        "from bridge.cli import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert "the run has left no recording" in done.stdout
    assert "Traceback" not in done.stderr
    assert path.read_bytes() == before


@pytest.mark.timeout(60)
def test_a_check_with_a_long_delay_takes_seconds(tmp_path: Path):
    long = ("--set", "duration=1", "--set", "loop.delay=4")
    done = hydrotwin_here("check", "step", *long, "-o", "c", cwd=tmp_path)
    assert "limit cycle" in done.stdout
    done = hydrotwin_here("run", "step", "--mode", "inprocess", *long, "--record", "a.mcap", cwd=tmp_path)
    assert "if its unit is missing" in done.stdout.replace("\n", " ")


def commands(recording: Path, folder: Path) -> dict[str, tuple[list[str], int]]:
    """What is ended: words of the command, and how many processes it starts, the guard among them."""
    run = ["run", "step", "--duration", "60", "--record", str(folder / "run.mcap")]
    sweep = ["map", "period", "gain", "--rig", "slow-sampling", "--cells", "4", "--runs", "6", "--workers", "2"]
    return {
        "run": ([*run, "--set", "real_time.overruns=1.0"], 4),
        "run --mode lockstep": ([*run, "--mode", "lockstep"], 4),
        "run --mode inprocess": ([*run, "--mode", "inprocess"], 0),
        "check --mode lockstep": (["check", "step", "--mode", "lockstep", "-o", str(folder)], 4),
        "view FILE --web": (["view", str(recording), "--web"], 2),
        "view FILE --save": (["view", str(recording), "--save", str(folder / "a.rrd")], 0),
        "view --web": (["view", "--web", "--connect", free_endpoint(), "--patience", "60"], 1),
        "replay FILE": (["replay", str(recording), "--loop", "--listen", free_endpoint()], 0),
        "replay --into controller": (["replay", str(recording), "--into", "controller"], 2),
        "record": (["record", "--connect", free_endpoint(), "--patience", "60"], 0),
        "map": ([*sweep, "-o", str(folder / "map")], 4),
        "doctor": (["doctor"], 2),
    }


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("endings") / "a.mcap"
    record_in_process(load("step", ["duration=2"]), path)
    return path


def assert_ended(found: Ended) -> None:
    assert found.code is not None
    assert found.asked == 1
    assert not found.left
    assert "Traceback" not in found.words


@pytest.mark.parametrize(
    ("name", "ending", "moment"),
    [
        ("run --mode lockstep", signal.SIGKILL, 1.0),
        ("run", TERMINAL, 1.0),
        ("run", signal.SIGTERM, 0.0),
        ("view FILE --web", signal.SIGHUP, 0.0),
        ("replay FILE", signal.SIGINT, 3.0),
        ("map", signal.SIGINT, 0.5),
    ],
)
def test_nobody_is_left(recording: Path, tmp_path: Path, name: str, ending: Ending, moment: float):
    """A few ends of commands that have started all their processes; random moments are an endurance test."""
    if name.startswith("view"):
        pytest.importorskip("rerun")
    words, children = commands(recording, tmp_path)[name]
    assert_ended(end(words, ending, moment, tmp_path, children))


@pytest.mark.endurance
@pytest.mark.timeout(7200)
def test_nobody_is_left_after_a_hundred_random_ends(recording: Path, tmp_path: Path):
    """Of each command, by each signal and a closed terminal: while it starts, and with any number of children."""
    pytest.importorskip("rerun")
    rng = random.Random(12)
    left, traces, deaf = [], [], []
    for turn in range(120):
        name, (words, most) = list(commands(recording, tmp_path).items())[turn % 12]
        ending, children = ENDINGS[turn // 12 % len(ENDINGS)], rng.choice([most, rng.randint(0, most)])
        moment = rng.uniform(0.0, 4.0 if children else 6.0)
        found = end(words, ending, moment, tmp_path, children)
        print(
            f"{name:26} {ending!s:9} {moment:5.2f} s after {children} children: code {found.code}, asked {found.asked},"
            f" ended after {found.latency:5.2f} s, all gone after {found.all_gone:5.2f} s, left {len(found.left)}",
            flush=True,
        )
        left += found.left if found.code is not None else [name]
        deaf += [name] if found.asked > 1 and (children or moment > STARTED) else []
        traces += [found.words] if "Traceback" in found.words else []
    assert not left
    assert not traces
    assert not deaf
