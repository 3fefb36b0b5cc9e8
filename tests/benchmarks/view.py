"""The loop with and without a live view on it, in turns: what the plant can notice of being watched."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
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

CHANGES = ["duration=8", "loop.sample_period=0.001", "real_time.overruns=1.0", "real_time.length=10"]


def rows(folder: Path) -> Iterator[Row]:
    """A controller at 1 kHz; the view serves a page."""
    for priority in (Priority.ORDINARY, Priority.FIFO):
        yield from _rows(folder, priority)


def _rows(folder: Path, priority: Priority) -> Iterator[Row]:
    alone, watched = in_turns(lambda: _run(folder, priority, watch=False), lambda: _run(folder, priority, watch=True))
    yield from compared(alone, watched, ("p99", "p50"), f"live view on, priority {priority}")
    lost, beside = (sum(sum(run["lost"].values()) for run in runs) for runs in (watched, alone))
    yield f"messages lost at the recorder, live view on, priority {priority}", str(lost), f"{beside} alone", ""


def _run(folder: Path, priority: Priority, watch: bool) -> dict[str, Any]:
    endpoint = free_endpoint()
    request = RunOptions(Mode.REALTIME, folder / "view.mcap", priority=priority, listen=endpoint)
    with _watching(endpoint if watch else None):
        return run_scenario(load("step", CHANGES), request).plain()


@contextmanager
def _watching(endpoint: str | None) -> Iterator[None]:
    """A view of the plant that will listen there; None: nobody watches."""
    if endpoint is None:
        yield
        return
    command = [sys.executable, "-m", "bridge", "view", "--web", "--connect", endpoint, "--patience", "60"]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as view:
        threading.Thread(target=view.communicate, daemon=True).start()
        try:
            yield
        finally:
            view.terminate()
            view.wait()
