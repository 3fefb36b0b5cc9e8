"""How many rigs at 1 kHz one machine carries, and how late the ticks of one are from 100 Hz to 5 kHz.

A rig is a plant, a controller at 100 Hz and a recorder, three processes; all rigs run at the same time, each on an
address of its own. A deadline is missed where a tick is a period or more late (`real_time.overruns`). The machine's own
load is in the figures: the first row says it.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

from bridge.machine.priority import Priority
from tests.benchmarks.plant import Row
from tests.support.processes import ENVIRONMENT, LOOSE, UNDRAWN

SECONDS = 8.0
PRIORITIES = (Priority.ORDINARY, Priority.FIFO)
MOST = 8  # rigs
MISSED = 0.01  # share of ticks a period or more late, from which on a machine counts as full
RATES = {100: 10.0, 500: 2.0, 1000: 1.0, 2000: 0.5, 5000: 0.2}  # [Hz] -> period [ms]


def rigs(folder: Path) -> Iterator[Row]:
    """More rigs each time until deadlines are missed: at ordinary priority, then with SCHED_FIFO where granted."""
    for priority in PRIORITIES:
        yield _load()
        yield from _more(folder, priority)


def _more(folder: Path, priority: Priority) -> Iterator[Row]:
    for count in (1, 2, 3, 4, 6, MOST):
        found = _together(folder, count, 1.0, priority)
        shares = [_missed(summary) for summary in found]
        late = ", ".join(f"{100 * share:.1f}" for share in shares)
        yield f"{count} rigs at 1 kHz, {priority}", f"{late} % of ticks missed", _worst(found), ""
        if max(shares) > MISSED * 10:
            break


def rates(folder: Path) -> Iterator[Row]:
    """One rig, faster and faster."""
    yield _load()
    for priority, (rate, period) in product(PRIORITIES, RATES.items()):
        (summary,) = _together(folder, 1, period, priority)
        yield (
            f"one rig at {rate} Hz, {priority}",
            f"{100 * _missed(summary):.2f} % of ticks missed",
            _worst([summary]),
            "",
        )


def _load() -> Row:
    return "load of the machine before", f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} processors", "", ""


def _worst(summaries: list[dict[str, Any]]) -> str:
    latenesses = [summary["timing"]["lateness"] for summary in summaries]
    p50, p99, most = (max(one[name] for one in latenesses) for name in ("p50", "p99", "max"))
    return f"late p50 {p50 * 1e3:.3f}, p99 {p99 * 1e3:.2f}, max {most * 1e3:.1f} ms"


def _missed(summary: dict[str, Any]) -> float:
    return summary["timing"]["overruns"]["ticks"] / summary["messages"]["state"]


def _together(folder: Path, count: int, period: float, priority: Priority) -> list[dict[str, Any]]:
    """Summaries of so many rigs that run at the same time."""
    own = Path(tempfile.mkdtemp(dir=folder))
    sample = ["--set", "loop.sample_period=10 ms", "--set", f"loop.daq_period={period} ms"]
    loose = [
        *LOOSE,
        "--priority",
        priority,
        "--set",
        "allowed.safe_states=1000",
        "--set",
        "loop.after_timeout=resume",
    ]
    command = [sys.executable, "-m", "bridge", "run", "step", "--duration", str(SECONDS), *sample, *loose, *UNDRAWN]
    running = [
        subprocess.Popen(
            [*command, "--record", str(own / f"{number}.mcap")],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=ENVIRONMENT,
        )
        for number in range(count)
    ]
    return [json.loads(process.communicate(timeout=300)[0]) for process in running]
