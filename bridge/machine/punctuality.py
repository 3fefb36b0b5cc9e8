"""How punctual this machine is: the loop's clock, sleep alone, and the middleware's round trip, each judged."""

from itertools import islice

import numpy as np

from bridge.machine.clock import SPIN_NS, ticks
from bridge.machine.echo import round_trips
from bridge.wire.link import LinkError

PERIOD_NS = 1_000_000  # the loop's usual DAQ period
TICKS = 1000
MOST_LATE = 0.05  # share of the ticks that a run allows to be late by a period or more
LONGEST_NS = 100_000_000  # by which one may be late
TRIPS = 200
Assessment = tuple[str, str, str]  # state, what was found, advice


def pacing() -> Assessment:
    """The loop's own clock, judged as a run in real time is. A tick late by a period is an overrun."""
    lateness = _lateness(SPIN_NS)
    allowed = np.mean(lateness >= PERIOD_NS) <= MOST_LATE and lateness.max() <= LONGEST_NS
    state = "good" if lateness.max() < PERIOD_NS else "fair" if allowed else "bad"
    return (
        state,
        _spread(lateness),
        "end other programs, allow SCHED_FIFO (below), or run slower: --speed 0.5; lockstep needs no clock",
    )


def sleeping() -> Assessment:
    """Sleep alone. The loop spins through the last stretch before a tick: sleep must, as a rule, wake within it."""
    lateness = _lateness(0)
    median = np.median(lateness)
    state = "bad" if median > PERIOD_NS else "fair" if median > SPIN_NS else "good"
    return (
        state,
        _spread(lateness),
        f"sleep overshoots the {SPIN_NS / 1e3:.0f} us that are spun: allow SCHED_FIFO, or a kernel"
        " with high-resolution timers",
    )


def _lateness(spin_ns: int) -> np.ndarray:
    return np.array([tick.lateness for tick in islice(ticks(PERIOD_NS, spin_ns=spin_ns), TICKS)])


def _spread(times_ns: np.ndarray) -> str:
    p50, p99, p999 = np.quantile(times_ns, [0.5, 0.99, 0.999]) / 1e3
    return f"p50 {p50:.1f} us, p99 {p99:.0f} us, p99.9 {p999:.0f} us, max {times_ns.max() / 1e3:.0f} us"


def loopback() -> Assessment:
    """Zenoh between two processes. Without a delay a command is in time when it comes within one DAQ period."""
    try:
        times = np.array(round_trips(TRIPS))
    except LinkError as error:
        return (
            "bad",
            str(error),
            "let programs talk over 127.0.0.1: look at firewall and container; in process runs work",
        )
    late = np.quantile(times, 0.99) > PERIOD_NS
    return (
        "fair" if late else "good",
        _spread(times),
        "commands will come late: end other programs, or allow a loop.delay",
    )
