"""A process of ours: its signals, its end with its parent, its scheduling rights."""

import ctypes
import gc
import os
import signal
import sys

PR_SET_TIMERSLACK, PR_SET_PDEATHSIG = 29, 1
MCL_CURRENT_AND_FUTURE = 3
FIFO_PRIORITY = 30


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
