"""Standard streams in any state: closed, full, of a narrow encoding, with a reader that has gone."""

import errno
import io
import logging
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

AFTER_A_WRITE = 0.02  # [s] until an interrupted write has ended


def prepare() -> None:
    """Give a closed stream its number back, so that no file of ours takes it, and let every character be written.

    What is written to a closed standard output is refused when it is flushed; a closed standard error stays silent.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_WRONLY if number == 2 else os.O_RDONLY)  # gets the lowest number that is free
    sys.stdin = sys.stdin or os.fdopen(0, encoding="utf-8", closefd=False)
    sys.stdout = sys.stdout or os.fdopen(1, "w", encoding="utf-8", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", encoding="utf-8", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def refusal() -> str | None:
    """Flush standard output; why that failed, if it did: no words where the reader has gone, as `head` goes."""
    try:
        sys.stdout.flush()
    except OSError as error:
        _drop()
        return "" if error.errno == errno.EPIPE else f"cannot write to standard output: {error.strerror}"
    return None


class _OnError(logging.Handler):
    """Our own warnings on standard error, whichever that is; the root logger is left to users' laws."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print one."""
        complain(record.getMessage())


def warn_on_error() -> None:
    """From now on our warnings reach standard error."""
    log = logging.getLogger("hydrotwin")
    if not any(isinstance(handler, _OnError) for handler in log.handlers):
        log.addHandler(_OnError())


def complain(text: str) -> None:
    """One line on standard error for each line of a text."""
    from bridge.errors import visible

    with suppress(OSError):
        for line in text.splitlines():
            print(f"hydrotwin: {visible(line)}", file=sys.stderr)


@contextmanager
def said_when_interrupted(words: Callable[[], str]) -> Iterator[None]:
    """Ctrl-C ends the process at once, as ever, but first says on standard error what can be done next."""

    def tell() -> None:
        shown = "\x1b[?25h\r\x1b[K" if os.isatty(2) else ""  # the cursor, which a bar hides
        os.write(2, f"{shown}hydrotwin: {words()}\n".encode())

    with done_when_interrupted(tell):
        yield


@contextmanager
def done_when_interrupted(act: Callable[[], object]) -> Iterator[None]:
    """Ctrl-C ends the process at once, as ever, but first does something short; a second one does not wait for it."""

    acts = [act]

    def end(*_: object) -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        try:
            for due in acts:
                due()
            sys.stdout.flush()
            acts.clear()
        except OSError:
            pass
        except RuntimeError:  # it came in the middle of a write, which has to end first; what was said is lost
            signal.signal(signal.SIGALRM, end)
            signal.setitimer(signal.ITIMER_REAL, AFTER_A_WRITE)
            return
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _drop() -> None:
    """Let go of what waits to be written; the interpreter would try again at its end."""
    with suppress(OSError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
        sys.stdout.flush()
