"""Commands that are ended: when, how, how long that takes, and who is left of all that they have started."""

import os
import pty
import secrets
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from bridge.machine.guard import marked
from tests.support.processes import ENVIRONMENT, with_signal

TERMINAL = "terminal"  # it is closed
ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL, TERMINAL)
DEAF = 8.0  # [s] after which Ctrl-C is pressed again
Ending = signal.Signals | str


class Ended(NamedTuple):
    """How it went."""

    code: int | None  # None: it did not end
    asked: int  # how many times; Python itself may lose a Ctrl-C while it starts
    latency: float  # [s] from the signal to the end of the command
    left: list[str]  # command lines of processes that are left `patience` seconds later
    all_gone: float  # [s] from the signal until nobody was left
    words: str  # of the command


@contextmanager
def on_a_terminal(command: list[str], folder: Path, environment: Mapping[str, str]) -> Iterator[tuple]:
    """A command in the foreground of a terminal of its own; gives it, its words, and the terminal."""
    master, slave = pty.openpty()
    with tempfile.TemporaryFile() as words:
        process = subprocess.Popen(
            ["setsid", "--ctty", *command], cwd=folder, env=environment, stdin=slave, stdout=words, stderr=words
        )
        os.close(slave)
        try:
            yield process, words, master
        finally:
            if process.poll() is None:
                process.kill()
            process.wait()


def end(
    words: list[str], ending: Ending, moment: float, folder: Path, children: int = 0, patience: float = 15.0
) -> Ended:
    """Run `hydrotwin` with these words, end it `moment` seconds after it has so many children, and see who is left."""
    mark = f"HYDROTWIN_TEST={secrets.token_hex(16)}"
    name, _, value = mark.partition("=")
    command = [sys.executable, "-m", "bridge", *words]
    try:
        with on_a_terminal(command, folder, {**ENVIRONMENT, name: value}) as (process, output, terminal):
            _await_children(mark, process, children)
            time.sleep(moment)
            begun = time.monotonic()
            _end(process, ending, terminal)
            code, asked = _waited(process, patience if ending != signal.SIGINT else DEAF), 1
            if code is None and ending == signal.SIGINT:
                _end(process, ending, terminal)
                code, asked = _waited(process, patience), 2
            latency = time.monotonic() - begun
            while (left := marked(mark)) and time.monotonic() < begun + patience:
                time.sleep(0.02)
            gone = time.monotonic() - begun
            if ending != TERMINAL:
                os.close(terminal)
            output.seek(0)
            return Ended(
                code, asked, latency, [_command(pid) for pid in left], gone, output.read().decode(errors="replace")
            )
    finally:
        for pid in marked(mark):
            with_signal(pid, signal.SIGKILL)


def _await_children(mark: str, process: subprocess.Popen[bytes], count: int) -> None:
    """On a busy machine nobody knows when that is; not for ever, since it may have failed."""
    until = time.monotonic() + 60.0
    while len(marked(mark)) < 1 + count and process.poll() is None and time.monotonic() < until:
        time.sleep(0.02)


def _end(process: subprocess.Popen[bytes], ending: Ending, terminal: int) -> None:
    if ending == TERMINAL:
        os.close(terminal)
    else:
        process.send_signal(signal.Signals(ending))


def _waited(process: subprocess.Popen[bytes], patience: float) -> int | None:
    try:
        return process.wait(patience)
    except subprocess.TimeoutExpired:
        return None


def _command(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""
