"""How long commands take to start and to end, compared with the import of three packages in the same series.

And from `hydrotwin plant` to its first measurement, with an empty and with a filled compile cache.
"""

import math
import os
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from bridge.wire.bus import Bus
from bridge.wire.link import Link, LinkError, free_endpoint
from tests.benchmarks.plant import Row

ROUNDS = 5
IMPORTS, NUMBA = "import pydantic, rich, typer", "import numba"
RUN_OF_CHECK = "run step --mode inprocess --json -"
GOALS = {  # command: times the imports
    **dict.fromkeys(("--help", "scenarios", "messages", "figures", "run nonsense"), 2.0),
    "run step --mode inprocess --duration 1": 5.0,
    "run step --mode inprocess --duration 1 --json -": 2.5,
    "run step --mode inprocess --duration 10 --json -": math.inf,
    RUN_OF_CHECK: math.inf,
    "check step": math.inf,
}


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


def series(folder: Path, commands: dict[str, list[str]]) -> dict[str, float]:
    """The median time [s] of each command over some rounds, one after another in each round."""
    times: dict[str, list[float]] = {name: [] for name in commands}
    for round_ in range(ROUNDS + 1):
        for name, command in commands.items():
            start = time.perf_counter()
            subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
            if round_:  # the first fills caches
                times[name].append(time.perf_counter() - start)
    return {name: statistics.median(taken) for name, taken in times.items()}


def commands_beside_imports(folder: Path) -> Iterator[Row]:
    """Each command's time over that of the imports; `check` over the run that it judges."""
    ours = {words: [sys.executable, "-m", "bridge", *words.split()] for words in GOALS}
    found = series(folder, {IMPORTS: [sys.executable, "-c", IMPORTS], NUMBA: [sys.executable, "-c", NUMBA]} | ours)
    beside = found[IMPORTS]
    yield NUMBA, f"{found[NUMBA]:.2f} s", f"{beside:.2f} s {IMPORTS}", f"{found[NUMBA] / beside:.2f}"
    for words, goal in GOALS.items():
        ratio = f"{found[words] / beside:.2f}"
        yield f"hydrotwin {words}", f"{found[words]:.2f} s", f"{beside:.2f} s, goal {goal:g} times", ratio
    run, check = found[RUN_OF_CHECK], found["check step"]
    yield "check step, beside its run", f"{check:.2f} s", f"{run:.2f} s, goal 1.1 times", f"{check / run:.2f}"


def rows(folder: Path) -> Iterator[Row]:
    """Commands, then a plant: cold, then warm."""
    yield from commands_beside_imports(folder)
    cold = first_measurement(folder)
    warm = min(first_measurement(folder) for _ in range(3))
    yield "plant to first measurement, cold", f"{cold:.2f} s", "", ""
    yield "plant to first measurement, warm", f"{warm:.2f} s", "goal 3 s", f"{warm / 3.0:.2f}"
