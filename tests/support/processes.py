"""Real processes for tests: started, bounded in time, always gone afterwards."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bridge.recording.reader import Recording, read

ROOT = Path(__file__).parents[2]
COARSE = ("--set", "loop.daq_period=10 ms")  # a loop that a busy machine keeps up with: 100 ticks a second
UNDRAWN = ("--json", "-")  # of `run`: neither picture nor linear theory, which take longer than a short run
LOOSE = tuple(  # where the machine's punctuality is not the claim
    word for change in ("overruns=1.0", "length=100", "late_commands=1.0") for word in ("--set", f"real_time.{change}")
)
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "200", "NO_COLOR": "1"}


def hydrotwin(*arguments: str, cwd: Path = ROOT, timeout: float = 120.0) -> subprocess.CompletedProcess[str]:
    """Run the command to its end."""
    return subprocess.run(
        [sys.executable, "-m", "bridge", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=ENVIRONMENT,
        timeout=timeout,
    )


HYDROTWIN = ("-m", "bridge")


def supervised(farewell: float) -> tuple[str, ...]:
    """The command with a supervisor that gives its processes so many seconds to end, instead of 8."""
    code = f"from bridge.processes import supervisor; supervisor.FAREWELL = {farewell}; "
    return ("-c", code + "from bridge.cli import main; main()")


IMPATIENT = supervised(2.0)
PATIENT = supervised(60.0)  # however busy the machine is


@contextmanager
def started(
    *arguments: str, cwd: Path = ROOT, program: tuple[str, ...] = HYDROTWIN, inside: tuple[str, ...] = ()
) -> Iterator[subprocess.Popen[str]]:
    """The command in the background, in a group of its own that is ended in the end; inside: words that run it."""
    process = subprocess.Popen(
        [*inside, sys.executable, *program, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=cwd,
        env=ENVIRONMENT,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        for pid in [process.pid, *children(process.pid)]:
            with_signal(pid, signal.SIGCONT)
            with_signal(pid, signal.SIGKILL)
        process.communicate()


def with_signal(pid: int, number: signal.Signals) -> None:
    """Send a signal to a process that may be gone."""
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return


def children(pid: int) -> dict[int, str]:
    """Child processes of a process and their command lines, by /proc."""
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == pid:
                found[int(entry.name)] = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except (OSError, ValueError, IndexError):
            continue
    return found


def child(pid: int, role: str, patience: float = 20.0) -> int:
    """The child process of `hydrotwin run` that plays a role."""
    return wait_for(lambda: next((p for p, c in children(pid).items() if f"bridge {role} " in c), None), patience)


def wait_for(condition: Any, patience: float) -> Any:
    """The first true answer."""
    deadline = time.monotonic() + patience
    while time.monotonic() < deadline:
        if answer := condition():
            return answer
        time.sleep(0.02)
    raise AssertionError(f"not within {patience} s")


def listening(endpoint: str) -> bool:
    """Does somebody accept connections at a Zenoh endpoint `tcp/host:port`?"""
    host, port = endpoint.removeprefix("tcp/").rsplit(":", 1)
    with socket.socket() as probe:
        return probe.connect_ex((host, int(port))) == 0


def grown(path: Path, size: int) -> bool:
    """Has a file reached a size?"""
    return path.is_file() and path.stat().st_size >= size


def run_recorded(path: Path, *arguments: str) -> Recording:
    """`hydrotwin run ... --record path`, which must go well; without a picture."""
    done = hydrotwin("run", *arguments, "--record", str(path), *UNDRAWN)
    assert done.returncode == 0, done.stdout + done.stderr
    path.with_suffix(".json").write_text(done.stdout)
    return read(path)


def summary(path: Path) -> dict[str, Any]:
    """The summary that `run_recorded` left beside a recording."""
    return json.loads(path.with_suffix(".json").read_text())
