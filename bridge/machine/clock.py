"""Wall time: absolute deadlines, hybrid waiting, what real-time rights the system grants."""

import ctypes
import gc
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from itertools import count
from typing import NamedTuple

SPIN_NS = 150_000  # the last stretch before a deadline is spun through; sleep alone wakes some 70 us late
PR_SET_TIMERSLACK, PR_SET_PDEATHSIG = 29, 1
MCL_CURRENT_AND_FUTURE = 3
FIFO_PRIORITY = 30


class Tick(NamedTuple):
    """A deadline met: which one, when it was due and how late it is [ns of the monotonic clock]."""

    number: int
    due: int
    lateness: int


def ticks(
    period_ns: float,
    now: Callable[[], int] = time.monotonic_ns,
    sleep: Callable[[float], None] = time.sleep,
    spin_ns: int = SPIN_NS,
) -> Iterator[Tick]:
    """Wait for start + k * period, k = 1, 2, ...: delays never add up, missed ticks come back to back."""
    start = now()
    for k in count(1):
        due = start + round(k * period_ns)
        if (wait := due - now() - spin_ns) > 0:
            sleep(wait * 1e-9)
        while (lateness := now() - due) < 0:
            pass
        yield Tick(k, due, lateness)


class Overruns:
    """Ticks that came more than a period late: how many times, how long, how many ticks each cost."""

    def __init__(self, period_ns: float, grace_ns: float) -> None:
        self.period = period_ns
        self.grace = grace_ns
        self.count = 0
        self.worst = 0  # [ns]
        self.burst = 0  # most ticks that had to be caught up in a row
        self._running = 0

    def add(self, lateness: int, elapsed: float) -> None:
        """Take note of a tick's lateness; `elapsed`: wall time since the start [ns]."""
        if lateness < self.period or elapsed < self.grace:
            self._running = 0
            return
        self.count += self._running == 0
        self._running += 1
        self.worst = max(self.worst, lateness)
        self.burst = max(self.burst, self._running)


class Stop:
    """Ctrl-C and SIGTERM as a question: `stop()` is True once one has come. A second Ctrl-C does not ask."""

    def __init__(self) -> None:
        self.asked = False
        signal.signal(signal.SIGINT, self._ask)
        signal.signal(signal.SIGTERM, self._ask)

    def __call__(self) -> bool:
        return self.asked

    def _ask(self, number: int, *_: object) -> None:
        if self.asked and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.asked = True


def die_with_parent() -> None:
    """Let the system end this process when the one that started it is gone, however it went."""
    _prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


NOTE = "hydrotwin: note: "  # how a line on standard error begins that is no failure


def prepare(fifo: bool) -> None:
    """Make this process punctual; call before any thread starts. What cannot be had is noted on standard error."""
    gc.collect()
    gc.freeze()
    gc.disable()
    sys.setswitchinterval(1e-4)
    _prctl(PR_SET_TIMERSLACK, 1)
    for note in _take_fifo() if fifo else []:
        print(f"{NOTE}{note}", file=sys.stderr, flush=True)


def _take_fifo() -> list[str]:
    notes = []
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIFO_PRIORITY))
    except (OSError, AttributeError) as error:
        notes.append(
            f"SCHED_FIFO refused ({error}): running at ordinary priority; run as root or raise `ulimit -r` to get it"
        )
    if _libc().mlockall(MCL_CURRENT_AND_FUTURE) != 0:
        notes.append("mlockall refused: pages may be swapped; raise `ulimit -l` to get it")
    return notes


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        _libc().prctl(option, value, 0, 0, 0)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
