"""Runs with impacts a second on one core: a chart of flow and damping, and one long run."""

import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from twin.chatter.basin import chart
from twin.chatter.impact import motion
from twin.chatter.system import SEATS, System

Row = tuple[str, str, str, str]
BETA = {"chamfered": 0.015132, "conical": 0.006538}
SIDE = 30  # of the 300 of a full chart, evenly spread


def rows(folder: Path) -> Iterator[Row]:
    """Both seats, without and with precompression; a full chart is 90 000 such runs."""
    flows, dampings = np.linspace(0.01, 0.5, SIDE), np.linspace(1e-4, 0.02, SIDE)
    for name, law in SEATS.items():
        for e in (0.0, 1.0):
            s = System(law, BETA[name], 0.1, e, 2.32e-4, 0.8)
            chart(s, flows[:1], dampings[-1:], False)
            start = time.perf_counter()
            chart(s, flows, dampings, False)
            rate = SIDE**2 / (time.perf_counter() - start)
            yield f"chart with impacts, {name}, e = {e:g}", f"{rate:.0f} runs/s", "", f"300 x 300: {9e4 / rate:.0f} s"
    s = System(SEATS["chamfered"], BETA["chamfered"], 0.1, 1.0, 2.32e-4, 0.8)
    motion(s, (0.0, 0.0, 1.0), 1, 1)
    start = time.perf_counter()
    motion(s, (0.0, 0.0, 1.0), 20_000, 1)
    yield "impacts at tolerance 1e-10", f"{2e4 / (time.perf_counter() - start):.0f} /s", "1.6 kHz in the valve", ""
