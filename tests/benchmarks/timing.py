"""Real time: lateness beside the bare timer, round trip beside a bare ping-pong, in the same minute."""

import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import zenoh
from numpy.typing import NDArray

from bridge.machine.clock import ticks
from bridge.machine.process import prepare
from bridge.processes.options import RunOptions
from bridge.runs.run import run_scenario
from bridge.scenario import load
from bridge.wire.link import free_endpoint
from bridge.wire.messages import Mode
from tests.benchmarks.plant import Row

SECONDS = 20
PINGS = 3000
QUANTILES = {"p50": 50.0, "p99": 99.0, "p99.9": 99.9, "max": 100.0}


def timer(period_ns: int, seconds: float) -> NDArray[np.int64]:
    """Lateness [ns] of bare ticks: the same waiting, nothing done."""
    prepare()
    return np.array([tick.lateness for tick in islice(ticks(period_ns), round(seconds * 1e9 / period_ns))])


def rows(folder: Path) -> Iterator[Row]:
    """Each beside what the system itself can do: ticks with a controller at 100 Hz, round trips with one at 1 kHz."""
    command = [sys.executable, "-m", "tests.benchmarks.timing", "timer", str(folder / "timer.npy")]
    test = subprocess.Popen(command)
    summary = _run(folder, f"duration={SECONDS}")
    test.wait()
    bare = np.load(folder / "timer.npy") * 1e-9
    for name, q in QUANTILES.items():
        ours, beside = summary["timing"]["lateness"][name], float(np.percentile(bare, q))
        yield f"lateness of the ticks, {name}", *_compare(ours, beside, "timer test beside it")
    yield "overruns; late commands of a delay of 5 ms", _counts(summary), "", ""
    fast = _run(folder, "duration=10", "loop.sample_period=0.001")
    pings = ping_pong()
    for name, q in QUANTILES.items():
        ours, beside = fast["timing"]["round_trip"][name], float(np.percentile(pings, q))
        yield f"measurement to command at 1 kHz, {name}", *_compare(ours, beside, "bare ping-pong, 76 bytes")


def _counts(summary: dict[str, Any]) -> str:
    overruns, commands = summary["timing"]["overruns"], summary["commands"]
    return f"{overruns['count']} of {SECONDS}000; {commands['late']} of {commands['sent']}"


def _run(folder: Path, *changes: str) -> dict[str, Any]:
    request = RunOptions(Mode.REALTIME, folder / "rt.mcap")
    return run_scenario(load("step", [*changes, "real_time.overruns=1.0"]), request).plain()


def ping_pong() -> NDArray[np.float64]:
    """Round trips [s] of a bare message between two processes at 1 kHz, same links and qualities of service."""
    endpoint = free_endpoint()
    session, echo = _open("peer", "listen", endpoint), None
    try:
        echo = subprocess.Popen([sys.executable, "-m", "tests.benchmarks.timing", "pong", endpoint])
        back: list[int] = []
        ear = zenoh.handlers.Callback(lambda sample: back.append(time.monotonic_ns()), indirect=False)
        subscriber = session.declare_subscriber("pong", ear)
        publisher = session.declare_publisher("ping", express=True, priority=zenoh.Priority.REAL_TIME)
        status: Any = publisher.matching_status
        while not status.matching:
            time.sleep(0.05)
            status = publisher.matching_status
        trips = list(_trips(publisher, back))
        subscriber.undeclare()
        return np.array(trips)
    finally:
        if echo:
            echo.kill()
            echo.wait()
        session.close()


def _trips(publisher, back: list[int]) -> Iterator[float]:
    for _ in islice(ticks(1_000_000), PINGS):
        back.clear()
        sent = time.monotonic_ns()
        publisher.put(b"x" * 76)
        deadline = time.monotonic() + 0.1
        while not back and time.monotonic() < deadline:
            time.sleep(50e-6)
        if back:
            yield (back[0] - sent) * 1e-9


def _open(mode: str, side: str, endpoint: str):
    config = zenoh.Config()
    config.insert_json5("mode", f'"{mode}"')
    config.insert_json5(f"{side}/endpoints", f'["{endpoint}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    return zenoh.open(config)


def _echo(endpoint: str) -> None:
    session = _open("client", "connect", endpoint)
    publisher = session.declare_publisher("pong", express=True, priority=zenoh.Priority.REAL_TIME)

    def on_ping(sample: Any) -> None:
        publisher.put(sample.payload)

    answer = zenoh.handlers.Callback(on_ping, indirect=False)
    subscriber = session.declare_subscriber("ping", answer)
    time.sleep(60.0)
    subscriber.undeclare()


def _compare(ours: float, beside: float, words: str) -> tuple[str, str, str]:
    return f"{ours * 1e6:.1f} us", f"{beside * 1e6:.1f} us {words}", f"{ours / beside:.2f}" if beside > 0 else "-"


if __name__ == "__main__":
    if sys.argv[1] == "timer":
        np.save(sys.argv[2], timer(1_000_000, SECONDS))
    else:
        _echo(sys.argv[2])
