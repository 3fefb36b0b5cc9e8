"""Runs in which one process is killed: in which phase, what the run says, what is left on disk and of processes."""

import random
import secrets
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from bridge.errors import RunError, UsageError
from bridge.machine.guard import marked
from bridge.recording.reader import read
from bridge.recording.recover import recover
from tests.support.processes import (
    COARSE,
    ENVIRONMENT,
    HYDROTWIN,
    LOOSE,
    UNDRAWN,
    child,
    grown,
    wait_for,
    with_signal,
)

PHASES = ("starting", "running", "ending")
ROLES = ("plant", "controller", "record", "supervisor", "router")
DURATION = {"starting": 1.0, "running": 20.0, "ending": 1.0}  # [s] of a run; one that runs does not end before
ROUTED = '--set=fault=[{target="process.network", kind="freeze", at="0.9 s", lasts="1 ms", probability=0}]'
PATIENCE = 40.0  # [s] for the run to end, and for all to be gone
BEGUN = 3000  # [bytes] of a recording with its first chunk


class Killed(NamedTuple):
    """How it went."""

    code: int  # of the run
    words: str  # of the run
    readable: str  # "": nothing was written; "whole", "recovered", or what is wrong
    left: list[int]  # processes


def kill_one(role: str, phase: str, rng: random.Random, folder: Path, program: tuple[str, ...] = HYDROTWIN) -> Killed:
    """Kill one process of a run at a random moment of a phase."""
    path = folder / "run.mcap"
    with _run(path, DURATION[phase], program) as (run, mark):
        victim = run.pid if role == "supervisor" else child(run.pid, role, PATIENCE)
        _await(phase, path, run, rng)
        with_signal(victim, signal.SIGKILL)
        words, _ = run.communicate(timeout=PATIENCE)
        until = time.monotonic() + PATIENCE
        while (left := marked(mark)) and time.monotonic() < until:
            time.sleep(0.05)
        return Killed(run.returncode, words, _found(path), left)


def _await(phase: str, path: Path, run: subprocess.Popen[str], rng: random.Random) -> None:
    if phase == "starting":
        time.sleep(rng.uniform(0.0, 1.0))
        return
    wait_for(lambda: grown(path, BEGUN) or run.poll() is not None, PATIENCE)
    time.sleep(rng.uniform(0.0, 0.6) if phase == "running" else rng.uniform(0.8, 1.5) * DURATION["ending"])


def _found(path: Path) -> str:
    """What the recording is good for."""
    if not path.exists() or not path.stat().st_size:
        return ""
    try:
        if read(path).complete:
            return "whole"
    except (RunError, UsageError, ValueError):
        pass
    try:
        mended = path.with_stem("mended")
        recover([path], mended)
        read(mended)
    except (RunError, UsageError, ValueError) as error:
        return f"{type(error).__name__}: {error}"
    return "recovered"


@contextmanager
def _run(path: Path, duration: float, program: tuple[str, ...]) -> Iterator[tuple[subprocess.Popen[str], str]]:
    name, value = "HYDROTWIN_TEST", secrets.token_hex(16)
    words = ["run", "step", "--set", f"duration={duration}", *COARSE, *LOOSE, ROUTED, "--record", str(path), *UNDRAWN]
    process = subprocess.Popen(
        [sys.executable, *program, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**ENVIRONMENT, name: value},
        start_new_session=True,
    )
    mark = f"{name}={value}"
    try:
        yield process, mark
    finally:
        for pid in (process.pid, *marked(mark)):
            with_signal(pid, signal.SIGKILL)
        process.communicate()
