"""From `hydrotwin plant` to its first measurement, with an empty and with a filled compile cache."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from bridge.wire.bus import Bus
from bridge.wire.link import Link, LinkError, free_endpoint
from tests.benchmarks.plant import Row


def first_measurement(cache: Path) -> float:
    """Seconds from the start of the process to the first measurement at a subscriber."""
    endpoint = free_endpoint()
    environment = os.environ | {"XDG_CACHE_HOME": str(cache)}
    start = time.perf_counter()
    plant = subprocess.Popen(
        [sys.executable, "-m", "bridge", "plant", "step", "--listen", endpoint],
        env=environment,
        stdout=subprocess.DEVNULL,
    )
    try:
        return _listen(endpoint) - start
    finally:
        plant.terminate()
        plant.wait()


def _listen(endpoint: str) -> float:
    came = threading.Event()
    while True:
        try:
            bus = Bus(Link(None, endpoint, None, 5.0), "rig", "bench", blocking=False)
        except LinkError:
            continue
        with bus:
            bus.subscribe("measurement", lambda *_: came.set())
            assert came.wait(60.0), "no measurement within a minute"
            return time.perf_counter()


def rows(folder: Path) -> Iterator[Row]:
    """Cold, then warm."""
    cold = first_measurement(folder)
    warm = min(first_measurement(folder) for _ in range(3))
    yield "plant to first measurement, cold", f"{cold:.2f} s", "", ""
    yield "plant to first measurement, warm", f"{warm:.2f} s", "goal 3 s", f"{warm / 3.0:.2f}"
