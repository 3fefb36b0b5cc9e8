"""Rerun's own program: a window, a server for browsers, or a picture without a screen. On loopback only, and silent."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from bridge.errors import UsageError
from bridge.machine.children import guarded
from bridge.machine.process import Stop
from bridge.wire.link import free_endpoint

START_PATIENCE = 15.0  # [s] for a server to answer
LOOPBACK = "127.0.0.1"
MEMORY = ("--memory-limit", "2GB")  # of a window: then the oldest data go
KEPT = {
    True: "512MB",
    False: "0B",
}  # for those who come later: pages, but not a window, which is there from the beginning


class Program(NamedTuple):
    """Rerun, running."""

    process: subprocess.Popen[bytes]
    data: int  # port that takes and hands on what is logged
    page: int  # port of the page for browsers; 0 without one

    @property
    def source(self) -> str:
        """Where to log to."""
        return f"rerun+http://{LOOPBACK}:{self.data}/proxy"

    @property
    def address(self) -> str:
        """The page to open in a browser: dark, as its colours want it; as a notebook it sends no usage statistics."""
        return f"http://{LOOPBACK}:{self.page}/?url={quote(self.source, safe='')}&theme=dark&notebook=1"


def require_rerun() -> None:
    """Raise UsageError when Rerun is not installed."""
    if find_spec("rerun") is None:
        raise UsageError("Rerun is not installed: pip install 'hydrotwin[view]'")


def require_screen() -> None:
    """Raise UsageError when there is no screen for a window."""
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise UsageError(
            "there is no screen here: use --web for a browser, --screenshot FILE.png, or of a file --save FILE.rrd"
        )


@contextmanager
def window() -> Iterator[Program]:
    """A window."""
    require_screen()
    with _running("--hide-welcome-screen", "--expect-data-soon") as program:
        yield program


@contextmanager
def server() -> Iterator[Program]:
    """A server with a page for browsers."""
    page = _free_port()
    with _running("--serve-web", "--web-viewer-port", str(page), page=page) as program:
        _await(program.process, page, "Rerun's web server")
        yield program


@contextmanager
def headless(width: int, height: int) -> Iterator[Program]:
    """A window that is nowhere, to take pictures of."""
    with _running("--headless", "--hide-welcome-screen", "--window-size", f"{width}x{height}", quiet=True) as program:
        yield program


@contextmanager
def _running(*arguments: str, page: int = 0, quiet: bool = False) -> Iterator[Program]:
    """Rerun with these arguments, ended in the end.

    `CI` is the one variable that keeps it from sending usage statistics. (Its server inside Python listens on all
    interfaces.)
    """
    import rerun_cli

    path, data = Path(rerun_cli.__file__).with_name("rerun"), _free_port()
    own = {"RUST_LOG": "error", "XDG_RUNTIME_DIR": "/tmp"}
    command = [
        path,
        "--bind",
        LOOPBACK,
        "--port",
        str(data),
        *MEMORY,
        "--server-memory-limit",
        KEPT[page > 0],
        *arguments,
    ]
    words = subprocess.DEVNULL if quiet else None
    with guarded() as environment:
        environment = {**own, **environment, "CI": "1"}
        process = subprocess.Popen(command, env=environment, stdout=words, stderr=words, start_new_session=True)
        _last_in_line(process.pid)
        try:
            _await(process, data, "Rerun")
            yield Program(process, data, page)
        finally:
            _end(process)


def _last_in_line(pid: int) -> None:
    """Have the whole session of a process wait for all others: Linux shares processors by session first."""
    with suppress(OSError):  # a system that does not share like that
        Path(f"/proc/{pid}/autogroup").write_text("10", encoding="ascii")


def _free_port() -> int:
    return int(free_endpoint().rpartition(":")[2])


def _await(process: subprocess.Popen[bytes], port: int, who: str) -> None:
    """Wait until a port answers."""
    until = time.monotonic() + START_PATIENCE
    while time.monotonic() < until and process.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(0.05)
    raise UsageError(f"{who} did not start within {START_PATIENCE:g} s" if process.poll() is None else f"{who} ended")


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(5.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def until_closed(program: Program, stop: Stop) -> int | None:
    """Wait until Rerun has ended, and give its exit code; None when we have been asked to end."""
    while (code := program.process.poll()) is None and not stop():
        time.sleep(0.05)
    return code


def connected(program: Program, application: str, name: Any = None) -> Any:
    """A stream that logs to a running Rerun."""
    import rerun as rr

    stream = rr.RecordingStream(application, recording_id=name)
    stream.connect_grpc(program.source)
    return stream
