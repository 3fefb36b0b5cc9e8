"""The loop with and without a client that sets a number 50 times a second, in turns: what the plant notices of it."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bridge.processes.options import RunOptions
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.link import Link, free_endpoint, open_session
from bridge.wire.messages import Mode
from tests.benchmarks.plant import Row
from tests.benchmarks.turns import TURNS, compared, in_turns

PERIOD = 0.02  # seconds from query to query
CHANGES = ["duration=8", "real_time.overruns=1.0", "real_time.length=10"]


def rows(folder: Path) -> Iterator[Row]:
    """A load force and a gain in turn."""
    taken = [0]
    alone, tuned = in_turns(lambda: _run(folder, None, taken), lambda: _run(folder, free_endpoint(), taken))
    yield from compared(alone, tuned, ("p50", "p99"), "50 settings a second")
    yield "settings taken", f"{taken[0]} in {TURNS} runs of 8 s", "", ""


def _run(folder: Path, endpoint: str | None, taken: list[int]) -> dict[str, Any]:
    request = RunOptions(Mode.REALTIME, folder / "tuned.mcap", listen=endpoint)
    with _tuning(endpoint, taken):
        return run_scenario(load("square", CHANGES), request).plain()


@contextmanager
def _tuning(endpoint: str | None, taken: list[int]) -> Iterator[None]:
    """A client of the plant that will listen there; None: nobody sets anything."""
    ended = threading.Event()

    def tune() -> None:
        with open_session(Link(None, endpoint, None, 60.0)) as session:
            for count in range(1_000_000):
                name, value = (("rig.load.force", count % 50), ("controller.gain", 0.5 + 0.001 * (count % 50)))[
                    count % 2
                ]
                query = json.dumps({"set": {name: value}})
                for reply in session.get("rig/parameters/set", payload=query, timeout=1.0):
                    taken[0] += reply.ok is not None and b'"set"' in reply.ok.payload.to_bytes()
                if ended.wait(PERIOD):
                    return

    if endpoint is None:
        yield
        return
    hand = threading.Thread(target=tune)
    hand.start()
    try:
        yield
    finally:
        ended.set()
        hand.join()
