"""The loop with and without a live view on it, in turns: what the plant can notice of being watched."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from bridge.processes.options import RunOptions
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.link import free_endpoint
from bridge.wire.messages import Mode
from tests.benchmarks.plant import Row

TURNS = 4
CHANGES = ["duration=8", "loop.sample_period=0.001", "real_time.overruns=1.0", "real_time.length=10"]
LOOKED_AT = (("lateness", "p99"), ("lateness", "p50"), ("round_trip", "p99"), ("round_trip", "p50"))


def rows(folder: Path) -> Iterator[Row]:
    """A controller at 1 kHz; the view serves a page. Medians of the turns, and how far those without it are apart."""
    for fifo, priority in ((False, ""), (True, ", --fifo")):
        yield from _rows(folder, fifo, priority)


def _rows(folder: Path, fifo: bool, priority: str) -> Iterator[Row]:
    alone, watched = [], []
    for _ in range(TURNS):
        alone.append(_run(folder, fifo, watch=False))
        watched.append(_run(folder, fifo, watch=True))
    for quantity, quantile in LOOKED_AT:
        without, beside = ([1e6 * run["timing"][quantity][quantile] for run in runs] for runs in (alone, watched))
        ratio = float(np.median(beside) / max(np.median(without), 1e-3))
        spread = f"{np.median(without):.1f} us alone ({min(without):.1f} .. {max(without):.1f})"
        words = f"{np.median(beside):.1f} us ({min(beside):.1f} .. {max(beside):.1f})"
        yield f"{quantity.replace('_', ' ')} {quantile}, live view on{priority}", words, spread, f"{ratio:.2f}"
    lost, beside = (sum(sum(run["lost"].values()) for run in runs) for runs in (watched, alone))
    yield f"messages lost at the recorder, live view on{priority}", str(lost), f"{beside} alone", ""


def _run(folder: Path, fifo: bool, watch: bool) -> dict[str, Any]:
    endpoint = free_endpoint()
    request = RunOptions(Mode.REALTIME, folder / "view.mcap", fifo=fifo, listen=endpoint)
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
