"""The middleware alone: how long a small message takes to another process and back."""

import queue
import subprocess
import sys
import time
from typing import Any

import zenoh

from bridge.machine.children import guarded, python
from bridge.wire.link import (
    Link,
    LinkError,
    free_endpoint,
    open_session,
)

PING, PONG = "hydrotwin/ping", "hydrotwin/pong"
PATIENCE = 5.0  # [s] for the other process to appear
LOST = 0.25  # [s] after which a trip counts as lost


def round_trips(count: int, size: int = 64) -> list[int]:
    """Times [ns] of so many trips, one after another, over loopback. Raises LinkError when messages do not come."""
    endpoint = free_endpoint()
    with open_session(Link(endpoint, None, None, PATIENCE)) as session:
        command, silent = python("-m", "bridge.machine.echo", endpoint), subprocess.DEVNULL
        with (
            guarded() as environment,
            subprocess.Popen(command, stdin=subprocess.PIPE, stderr=silent, env=environment) as other,
        ):
            try:
                return _trips(session, bytes(size), count)
            finally:
                other.kill()


def _trips(session: Any, payload: bytes, count: int) -> list[int]:
    answers: queue.SimpleQueue[int] = queue.SimpleQueue()
    _listen(session, PONG, lambda _: answers.put(time.perf_counter_ns()))
    publisher = _publisher(session, PING)
    deadline = time.monotonic() + PATIENCE
    while _trip(publisher, payload, answers) is None:
        if time.monotonic() > deadline:
            raise LinkError(f"no message came back over loopback within {PATIENCE:g} s")
    times = [_trip(publisher, payload, answers) for _ in range(count)]
    if None in times:
        raise LinkError(f"{times.count(None)} of {count} messages did not come back over loopback")
    return [trip for trip in times if trip is not None]


def _trip(publisher: Any, payload: bytes, answers: "queue.SimpleQueue[int]") -> int | None:
    start = time.perf_counter_ns()
    publisher.put(payload)
    try:
        return answers.get(timeout=LOST) - start
    except queue.Empty:
        return None


def _publisher(session: Any, key: str) -> Any:
    return session.declare_publisher(key, priority=zenoh.Priority.REAL_TIME, express=True)


def _listen(session: Any, key: str, receiver: Any) -> None:
    session.declare_subscriber(key, zenoh.handlers.Callback(receiver, indirect=False))


def answer(endpoint: str) -> None:
    """Send every ping back until standard input ends."""
    with open_session(Link(None, endpoint, None, PATIENCE)) as session:
        publisher = _publisher(session, PONG)
        _listen(session, PING, lambda sample: publisher.put(sample.payload))
        sys.stdin.read()


if __name__ == "__main__":
    answer(sys.argv[1])
