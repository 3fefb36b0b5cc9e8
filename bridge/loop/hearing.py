"""What a law prints or logs: standard output and standard error while it answers, kept line by line.

While any law is heard both streams are stand-ins, which keep what a thread writes whose law answers, and pass on what
others write. A handler of `logging` that writes to one of them writes to its stand-in meanwhile.
"""

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import get_ident
from typing import Any, NamedTuple, Protocol

from bridge.errors import visible

MOST = 100  # lines of a run that are kept
LONGEST = 300  # characters of a line
CUT = " .."  # at the end of a line that is longer
ENOUGH = f"the law says more than {MOST} lines: the rest is left out"


class Line(NamedTuple):
    """One line and the sample that it belongs to."""

    stamp: int  # [ns]
    text: str


class Hearing:
    """What one law says in a run."""

    def __init__(self) -> None:
        self.aloud = False  # pass everything on as well
        self._lines: list[Line] = []
        self._count = 0
        self._begun: dict[str, str] = {}  # by stream, of a line
        self._stamp = 0

    def call(self, stamp: int, function: Callable[..., Any], *arguments: Any) -> Any:
        """What a function gives, heard meanwhile; a line that it does not end is ended when it returns."""
        self._stamp = stamp
        thread = get_ident()
        before = _begin(thread, self)
        try:
            return function(*arguments)
        finally:
            _end(thread, before)
            if self._begun:
                for line in self._begun.values():
                    self._keep(line)
                self._begun = {}

    def lines(self) -> list[Line]:
        """The lines since the last call."""
        if not self._lines:
            return []
        lines, self._lines = self._lines, []
        return lines

    def hear(self, stream: str, text: str) -> bool:
        """Take what is written; is it to be passed on?"""
        *whole, begun = (self._begun.get(stream, "") + text).split("\n")
        for line in whole:
            self._keep(line)
        self._begun[stream] = begun[: LONGEST + 1]
        return self.aloud

    def _keep(self, line: str) -> None:
        """Take a line; an empty one says nothing."""
        shown = visible(line.expandtabs(4)[: 2 * LONGEST].rstrip())
        if not shown or self._count > MOST:
            return
        self._count += 1
        text = shown if len(shown) <= LONGEST else shown[: LONGEST - len(CUT)] + CUT
        self._lines.append(Line(self._stamp, text if self._count <= MOST else ENOUGH))


class _Hearer(Protocol):
    def hear(self, stream: str, text: str) -> bool: ...


class _Aside:
    """Hears a module of a user's law that is being loaded: it may speak on standard error, since no run has begun."""

    def hear(self, stream: str, text: str) -> bool:
        _ERROR.write_through(text)
        return False


class _StandIn:
    """In place of a standard stream; threads that come and go do so without a lock."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._real: Any = getattr(sys, name)

    def take_place(self, current: Any) -> None:
        """From now on what is written to the stream comes here; `current`: what it is."""
        if current is not self:
            self._real = current
            setattr(sys, self._name, self)

    def leave(self) -> None:
        """Give the stream back, unless somebody has taken it meanwhile."""
        if getattr(sys, self._name) is self:
            setattr(sys, self._name, self._real)

    def write(self, text: str) -> int:
        """As a text stream does."""
        hearer = _HEARERS.get(get_ident())
        if hearer is None or hearer.hear(self._name, text):
            self.write_through(text)
        return len(text)

    def writelines(self, lines: Any) -> None:
        """As a text stream does."""
        for line in lines:
            self.write(line)

    def write_through(self, text: str) -> None:
        """Write to the stream itself; where there is none, nowhere."""
        stream = self.stream
        if stream is not None:
            stream.write(text)

    def flush(self) -> None:
        """As a text stream does."""
        if self.stream is not None:
            self.stream.flush()

    @property
    def stream(self) -> Any:
        """The stream itself: another one than at first where somebody has taken its place."""
        current = getattr(sys, self._name)
        return self._real if current is self else current

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


_HEARERS: dict[int, _Hearer] = {}  # by thread
_OUTPUT, _ERROR = _StandIn("stdout"), _StandIn("stderr")
_turned: list[Any] = []  # handlers of `logging` that write to a stand-in meanwhile, and their streams


@contextmanager
def aside() -> Iterator[None]:
    """Whatever is printed meanwhile goes to standard error, which carries no data."""
    thread = get_ident()
    before = _begin(thread, _Aside())
    try:
        yield
    finally:
        _end(thread, before)


def _begin(thread: int, hearer: _Hearer) -> _Hearer | None:
    """Hear a thread; who has heard it before."""
    before = _HEARERS.get(thread)
    _HEARERS[thread] = hearer
    _OUTPUT.take_place(sys.stdout)
    _ERROR.take_place(sys.stderr)
    if logging.root.handlers:
        _turn_handlers()
    return before


def _end(thread: int, before: _Hearer | None) -> None:
    if before is not None:
        _HEARERS[thread] = before
        return
    del _HEARERS[thread]
    if not _HEARERS:
        while _turned:
            handler, stream = _turned.pop()
            handler.stream = stream
        _OUTPUT.leave()
        _ERROR.leave()


def _turn_handlers() -> None:
    """A program's handlers that write to a standard stream were given that before."""
    for handler in logging.root.handlers:
        stream = getattr(handler, "stream", None)
        for stand_in in (_OUTPUT, _ERROR):
            if stream is not None and stream is stand_in.stream:
                _turned.append((handler, stream))
                handler.stream = stand_in  # pyright: ignore[reportAttributeAccessIssue]
