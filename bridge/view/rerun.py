"""A recording in Rerun's viewer: a window, a page for a browser, or a file."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import quote

from bridge.link import free_endpoint
from bridge.recording.reader import Recording, read
from bridge.scenario import ScenarioError
from bridge.view.content import APPLICATION, send, write

START_PATIENCE = 15.0  # [s] for the page's server to answer
LOOPBACK = "127.0.0.1"


def show(file: Path, web: bool, save: Path | None) -> None:
    """Show a recording in Rerun, serve it to a browser until Ctrl-C, or write it to `save` and open nothing."""
    if web and save:
        raise ScenarioError("--web serves a recording and --save writes it: choose one")
    _require_rerun()
    recording = read(file)
    if not any(True for _ in recording.of("state")):
        raise ScenarioError(f"{file}: the recording holds no state of a plant, so there is nothing to show")
    if save:
        write(recording, save)
    elif web:
        _serve(recording)
    else:
        _require_screen()
        _open(recording)


def _require_rerun() -> None:
    if find_spec("rerun") is None:
        raise ScenarioError("Rerun is not installed: pip install 'hydrotwin[view]'")


def _require_screen() -> None:
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise ScenarioError("there is no screen here: use --web for a browser, or --save FILE.rrd")


def _start(*arguments: str) -> subprocess.Popen[bytes]:
    """Start Rerun's own program, on loopback only and silent.

    `CI` is the one variable that keeps it from sending usage statistics. (Its server inside Python listens on all
    interfaces.)
    """
    import rerun_cli

    program = Path(rerun_cli.__file__).with_name("rerun")
    environment = {"RUST_LOG": "warn", **os.environ, "CI": "1"}
    return subprocess.Popen([program, "--bind", LOOPBACK, *arguments], env=environment)


def _open(recording: Recording) -> None:
    """A window of its own; returns when it is closed."""
    with tempfile.TemporaryDirectory(prefix="hydrotwin-") as folder:
        viewer = _start("--new", str(write(recording, Path(folder) / f"{recording.path.stem}.rrd")))
        try:
            failed = viewer.wait()
        except KeyboardInterrupt:
            return
        finally:
            _end(viewer)
    if failed:
        raise ScenarioError("Rerun's window did not open; use --web for a browser, or --save FILE.rrd")


def _serve(recording: Recording) -> None:
    """A page on free ports of loopback, until Ctrl-C or SIGTERM."""
    for ending in (signal.SIGINT, signal.SIGTERM):
        signal.signal(ending, signal.default_int_handler)
    data, page = (int(free_endpoint().rpartition(":")[2]) for _ in range(2))
    server = _start("--serve-web", "--port", str(data), "--web-viewer-port", str(page))
    try:
        _await_page(server, page)
        print(f"{_publish(recording, data, page)}\nCtrl-C ends it", flush=True)
        server.wait()
    except KeyboardInterrupt:
        return
    finally:
        _end(server)
    raise ScenarioError("Rerun's web server ended by itself")


def _publish(recording: Recording, data: int, page: int) -> str:
    """Send a recording to the server and return the page to open; as a notebook it sends no usage statistics.

    Given a file to load, the server would keep a core busy for as long as it runs.
    """
    import rerun as rr

    source = f"rerun+http://{LOOPBACK}:{data}/proxy"
    stream = rr.RecordingStream(APPLICATION)
    stream.connect_grpc(source)
    send(stream, recording)
    return f"http://{LOOPBACK}:{page}/?url={quote(source, safe='')}&notebook=1"


def _await_page(server: subprocess.Popen[bytes], port: int) -> None:
    until = time.monotonic() + START_PATIENCE
    while time.monotonic() < until and server.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return
        time.sleep(0.05)
    raise ScenarioError(f"Rerun's web server did not answer within {START_PATIENCE:g} s")


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(5.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
