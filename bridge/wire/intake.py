"""The door of a process: what arrives is let in by size and rate, or counted.

The rate is that of the generic cell rate algorithm (ITU-T I.371): each message is due one interval after the
last, and may come so much earlier.
"""

import queue
import threading
import time
from collections import Counter
from collections.abc import Callable
from typing import Any

from bridge.wire.limits import IN_A_ROW, MESSAGE, QUERY, QUERY_RATE, WAITING_QUERIES, Excess

NS = 1_000_000_000


class Turned:
    """Counts of what was turned away, by what it was and why; written to by several threads."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()
        self._lock = threading.Lock()

    def add(self, what: str, why: Excess, number: int = 1) -> None:
        """Count."""
        with self._lock:
            self._counts[f"{what} {why}"] += number

    def counts(self) -> dict[str, int]:
        """The counts so far."""
        with self._lock:
            return dict(self._counts)


class Door:
    """Lets messages of one kind in, or counts why not."""

    def __init__(
        self, what: str, turned: Turned, rate: float | None, longest: int = MESSAGE, now=time.monotonic_ns
    ) -> None:
        self._what = what
        self._turned = turned
        self._longest = longest
        self._interval = 0 if rate is None else round(NS / rate)  # [ns]
        self._early = round(IN_A_ROW * NS)  # [ns]
        self._due = 0  # of the next message, at the rate [ns]
        self._now = now

    def admits(self, size: int) -> bool:
        """May a message of so many bytes come in? It is counted where not."""
        if size > self._longest:
            self._turned.add(self._what, Excess.LONG)
            return False
        if self._interval:
            now = self._now()
            due = max(self._due, now)
            if due - now > self._early:
                self._turned.add(self._what, Excess.OFTEN)
                return False
            self._due = due + self._interval
        return True


class Desk:
    """Answers queries of one kind one after the other in a thread of its own; few wait, others are told so."""

    def __init__(self, what: str, turned: Turned, key: str, reply: Callable[[bytes], bytes]) -> None:
        self._what = what
        self._turned = turned
        self._key = key
        self._reply = reply
        self._door = Door(what, turned, QUERY_RATE, QUERY)
        self._waiting: queue.Queue[Any] = queue.Queue(WAITING_QUERIES)
        threading.Thread(target=self._work, daemon=True, name=f"answers {what}").start()

    def take(self, query: Any) -> None:
        """In Zenoh's thread: let a query wait for its answer, or refuse it."""
        payload = query.payload
        if not self._door.admits(0 if payload is None else len(payload)):
            query.reply_err(b"refused: too long, or too many in a second")
            return
        try:
            self._waiting.put_nowait(query)
        except queue.Full:
            self._turned.add(self._what, Excess.WAITING)
            query.reply_err(b"refused: too many wait")

    def close(self) -> None:
        """Answer no more."""
        while True:
            try:
                self._waiting.put_nowait(None)
                return
            except queue.Full:
                try:
                    self._waiting.get_nowait()
                except queue.Empty:
                    continue

    def _work(self) -> None:
        while (query := self._waiting.get()) is not None:
            self._answer(query)
            del query  # Zenoh ends a query when nobody holds it any more

    def _answer(self, query: Any) -> None:
        try:
            answer = self._reply(b"" if query.payload is None else query.payload.to_bytes())
        except Exception as error:  # of one query: the next one may be better
            self._turned.add(self._what, Excess.UNREADABLE)
            query.reply_err(f"failed: {type(error).__name__}: {error}".encode())
        else:
            query.reply(self._key, answer)


class Waiting(queue.SimpleQueue[Any]):
    """A queue between Zenoh's threads and ours in which so many may wait; more are counted and dropped."""

    def __new__(cls, *_: Any) -> "Waiting":
        return super().__new__(cls)

    def __init__(self, what: str, turned: Turned, most: int) -> None:
        self._what = what
        self._turned = turned
        self._most = most

    def put(self, item: Any, block: bool = True, timeout: float | None = None) -> None:
        """Let something wait, if there is room."""
        if self.qsize() < self._most:
            super().put(item)
        else:
            self._turned.add(self._what, Excess.WAITING)
