"""The command line inside the test's own process: arguments, streams and exit code as a shell sees them."""

import io
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest import mock

from bridge.cli import answer

TERMINAL = {"COLUMNS": "200", "NO_COLOR": "1"}
TAKEN = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # what a verb may take into its own hands


def hydrotwin_here(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a verb to its end without another process; `processes.hydrotwin` starts one."""
    command = ["hydrotwin", *arguments]
    with _handlers_kept(), chdir(cwd), mock.patch.dict(os.environ, TERMINAL), mock.patch.object(sys, "argv", command):
        out, err = _stream(), _stream()
        with redirect_stdout(out), redirect_stderr(err):
            code = answer()
    return subprocess.CompletedProcess(command, code, *(_text(stream) for stream in (out, err)))


def _stream() -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)


def _text(stream: io.TextIOWrapper) -> str:
    return bytes(stream.buffer.getbuffer()).decode()  # pyright: ignore[reportAttributeAccessIssue]


@contextmanager
def _handlers_kept() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in TAKEN}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
