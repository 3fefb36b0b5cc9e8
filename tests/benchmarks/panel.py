"""The loop with and without the panel on it, in turns, and the panel's own share of a processor: with a page that is
read by a socket, and with one that headless Chromium draws by software.
"""

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any

from bridge.machine.priority import Priority
from bridge.processes.options import RunOptions
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.link import free_endpoint
from bridge.wire.messages import Mode
from tests.benchmarks.plant import Row
from tests.benchmarks.turns import compared, in_turns

CHANGES = ["duration=12", "reference.at=1", "real_time.overruns=1.0", "real_time.length=10", "loop.command_timeout=10"]
SETTLED = 3.0  # [s] after the first frame, from when the share counts: the picture is made by then
COUNTED = 6.0  # [s] of wall time
TICK = os.sysconf("SC_CLK_TCK")

Visit = Callable[[str], AbstractContextManager[None]]  # opens the page of an address


def rows(folder: Path) -> Iterator[Row]:
    """By a socket, then in Chromium where there is one."""
    visits = {"page read": _read}
    if shutil.which("chromium"):
        visits["page in Chromium"] = _drawn
    for words, visit in visits.items():
        for priority in (Priority.ORDINARY, Priority.FIFO):
            yield from _rows(folder, priority, words, visit)


def _rows(folder: Path, priority: Priority, words: str, visit: Visit) -> Iterator[Row]:
    shares: list[float] = []
    alone, watched = in_turns(
        lambda: _run(folder, priority, None, shares), lambda: _run(folder, priority, visit, shares)
    )
    yield from compared(alone, watched, ("p99", "p50"), f"{words}, priority {priority}")
    share = f"{100.0 * sum(shares) / max(1, len(shares)):.1f} % of a core"
    yield f"panel's own processor time, {words}, priority {priority}", share, "", ""


def _run(folder: Path, priority: Priority, visit: Visit | None, shares: list[float]) -> dict[str, Any]:
    endpoint = free_endpoint()
    request = RunOptions(Mode.REALTIME, folder / "panel.mcap", priority=priority, listen=endpoint)
    with nullcontext() if visit is None else _watching(endpoint, visit, shares):
        return run_scenario(load("square", CHANGES), request).plain()


@contextmanager
def _watching(endpoint: str, visit: Visit, shares: list[float]) -> Iterator[None]:
    """A panel of the plant that will listen there, and its page."""
    command = [sys.executable, "-m", "bridge", "panel", "rig", "--connect", endpoint, "--port", "0", "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as panel:
        assert panel.stdout is not None
        address = panel.stdout.readline().split()[-1]
        counting = threading.Thread(target=_count, args=(panel.pid, address, shares))
        try:
            with visit(address):
                counting.start()
                yield
                counting.join()
        finally:
            panel.terminate()


def _count(pid: int, address: str, shares: list[float]) -> None:
    """The share of a core that the panel takes, once its first frame has come and it has settled."""
    from websockets.sync.client import connect

    with connect(address.replace("http", "ws") + "socket", max_size=None) as socket:
        while json.loads(socket.recv(60))["type"] != "frame":
            pass
    time.sleep(SETTLED)
    before, begun = _spent(pid), time.monotonic()
    time.sleep(COUNTED)
    shares.append((_spent(pid) - before) / (time.monotonic() - begun))


def _spent(pid: int) -> float:
    """Processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


@contextmanager
def _read(address: str) -> Iterator[None]:
    """A page that takes all that comes and draws nothing."""
    from websockets.sync.client import connect

    def take() -> None:
        with suppress(Exception):
            while True:
                socket.recv()

    with connect(address.replace("http", "ws") + "socket", max_size=None) as socket:
        threading.Thread(target=take, daemon=True).start()
        yield


@contextmanager
def _drawn(address: str) -> Iterator[None]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        browser.new_page(viewport={"width": 1400, "height": 1000}).goto(address)
        yield
        browser.close()
