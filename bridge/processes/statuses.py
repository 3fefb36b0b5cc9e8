"""What each process at a rig says of itself now: the newest `status` of each, gathered for a moment.

A plant and a follower speak twice a second, others only when there is something to say: of these it is known that they
are there.
"""

import math
import os
import time
from collections.abc import Callable, Iterator, Mapping, Set
from typing import Any, NamedTuple

from bridge.wire.bus import Bus
from bridge.wire.codec import decode, ready
from bridge.wire.health import PLACES
from bridge.wire.status import Reading, numbers_of
from controller.grid import NS
from twin.estimation.hypotheses import HYPOTHESES, Verdict
from twin.estimation.quantities import Standing
from twin.topology import PRESSURES

STANDING, VERDICT, FIRST = "standing", "verdict", "first"  # of a follower's numbers
THERE = "there"  # phase of one that has said nothing
MOMENT = 1.2  # [s]


class Status(NamedTuple):
    """Of one process."""

    role: str
    pid: int
    phase: str
    time: float | None  # simulated [s]; None: not known
    words: str  # what it is about
    numbers: dict[str, float | None]  # None: not known


def statuses(bus: Bus, stopped: Callable[[], bool], seconds: float = MOMENT) -> list[Status]:
    """Of all that spoke within some seconds or are there, by role."""
    newest: dict[tuple[str, int], Any] = {}
    ready("status")

    def take(sample: Any) -> None:
        try:
            message = decode(sample.payload.to_bytes(), "status")
        except ValueError:
            return
        newest[message.role, message.pid] = message

    bus.subscribe("status", take)
    bus.watch()
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and not stopped():
        time.sleep(0.02)
    spoken = [_status(message) for message in newest.values()]
    return sorted([*spoken, *silent(bus.present, {str(each.pid) for each in spoken})], key=lambda each: each[:2])


def silent(present: Mapping[str, Set[str]], spoken: Set[str]) -> Iterator[Status]:
    """Those that have a sign of life and said nothing."""
    for role, pids in present.items():
        for pid in pids - spoken - {str(os.getpid())}:
            yield Status(role, int(pid) if pid.isdigit() else 0, THERE, None, "" if pid.isdigit() else pid, {})


def _status(message: Any) -> Status:
    numbers = numbers_of(message)
    words = message.text or _words(message.role, numbers)
    known = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
    return Status(message.role, message.pid, str(message.phase), message.stamp / NS, words, known)


def _words(role: str, numbers: dict[str, float]) -> str:
    if role == "plant" and (reading := Reading.from_plain(numbers)):
        bars = ", ".join(f"{name} {1e-5 * p:.1f}" for name, p in zip(PRESSURES, reading.pressures, strict=True))
        return f"{1e3 * reading.position:.1f} mm; {bars} bar; {numbers.get('late', 0):.0f} late commands"
    if STANDING in numbers:
        return followed_words(numbers)
    return ""


def followed_words(numbers: dict[str, float]) -> str:
    """How a follower stands, and what it says of the rig's health where it judges it."""
    said = [_name(Standing, numbers[STANDING]), f"{1e3 * numbers.get('lag', 0.0):.0f} ms behind"]
    if VERDICT in numbers:
        said.append(f"health: {_name(Verdict, numbers[VERDICT])}{_suspect(numbers.get(FIRST, -1.0))}")
    return "; ".join(said)


def _name(kind: Any, number: float) -> str:
    try:
        return kind(round(number)).name.lower().replace("_", " ")
    except ValueError:
        return "not known"


def _suspect(first: float) -> str:
    place = round(first)
    return f", {HYPOTHESES[PLACES[place]].words}" if 0 <= place < len(PLACES) else ""
