"""A process of ours: its signals, its end with its parent, its scheduling rights."""

import ctypes
import gc
import signal
import sys
from typing import Any

PR_SET_TIMERSLACK = 29

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


def prepare() -> None:
    """Make this process punctual; call before any thread starts."""
    gc.collect()
    gc.freeze()
    gc.disable()
    sys.setswitchinterval(1e-4)
    _prctl(PR_SET_TIMERSLACK, 1)


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)
