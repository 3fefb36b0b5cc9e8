"""What a process says on its terminal while it runs: one line each, printed beside the loop and never in its way."""

import queue
import sys
import threading
from collections.abc import Callable, Mapping

CLOSING = 0.5  # seconds that the last lines get to be printed


def on_terminal(line: str) -> None:
    """Print a line for people."""
    print(f"hydrotwin: {line}", file=sys.stderr, flush=True)


class Narrator:
    """Lines in their order, printed by a thread of its own: a terminal that is held does not hold the loop."""

    def __init__(self, quiet: bool, write: Callable[[str], None] = on_terminal) -> None:
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._write = write
        self._present: dict[str, frozenset[str]] = {}
        self._thread = None if quiet else threading.Thread(target=self._print, daemon=True)
        if self._thread is not None:
            self._thread.start()

    def say(self, line: str) -> None:
        """Print a line soon."""
        if self._thread is not None:
            self._lines.put(line)

    def note_present(self, present: Mapping[str, set[str]], without: str) -> None:
        """Say who has joined and who has left; `without`: our own role."""
        for role in sorted(set(present) - {without}):
            before, now = self._present.get(role, frozenset()), frozenset(present.get(role, ()))
            for name in sorted(now - before):
                self.say(f"{role} {name} has joined")
            for name in sorted(before - now):
                self.say(f"{role} {name} has left")
            self._present[role] = now

    def close(self) -> None:
        """Print what is left, within CLOSING."""
        if self._thread is not None:
            self._lines.put(None)
            self._thread.join(CLOSING)

    def _print(self) -> None:
        while (line := self._lines.get()) is not None:
            self._write(line)
