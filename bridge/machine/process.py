"""A process of ours: its signals, its end with its parent, its scheduling rights."""

import ctypes
import gc
import os
import signal
import sys
from typing import Any

PR_SET_TIMERSLACK = 29
MCL_CURRENT_AND_FUTURE = 3
FIFO_PRIORITY = 30


ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # Ctrl-C, a polite kill, a closed terminal


class Stop:
    """The signals that end a process as a question: `stop()` is True once one has come. A Ctrl-C after that ends it.

    That begins with `listen`, when there is something to end in order. Before it a signal ends the process at once:
    nothing can be deaf to it then, no connection that waits and no compiler. `leave` puts things back.
    """

    def __init__(self) -> None:
        self.asked = False
        self._before: dict[signal.Signals, Any] = {}

    def __call__(self) -> bool:
        return self.asked

    def listen(self) -> "Stop":
        """Take the signals from here on, those excepted that whoever started us has switched off."""
        if self._before:
            return self
        before = {number: signal.getsignal(number) for number in ENDINGS}
        self._before = {number: handler for number, handler in before.items() if handler is not signal.SIG_IGN}
        for number in self._before:
            signal.signal(number, self._ask)
        return self

    def leave(self) -> None:
        """Give the signals back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before = {}

    def _ask(self, *_: object) -> None:
        self.asked = True
        signal.signal(signal.SIGINT, signal.SIG_DFL)


NOTE = "hydrotwin: note: "  # how a line on standard error begins that is not a failure


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
