"""What each process at a rig says of itself now: the newest `status` of each, gathered for a moment."""

import math
import time
from collections.abc import Callable
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
MOMENT = 1.2  # [s]: everybody speaks twice a second


class Status(NamedTuple):
    """Of one process."""

    role: str
    pid: int
    phase: str
    time: float  # simulated [s]
    words: str  # what it is about
    numbers: dict[str, float | None]  # None: not known


def statuses(bus: Bus, stopped: Callable[[], bool], seconds: float = MOMENT) -> list[Status]:
    """Of all that spoke within some seconds, by role."""
    newest: dict[tuple[str, int], Any] = {}
    ready("status")

    def take(sample: Any) -> None:
        try:
            message = decode(sample.payload.to_bytes(), "status")
        except ValueError:
            return
        newest[message.role, message.pid] = message

    bus.subscribe("status", take)
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and not stopped():
        time.sleep(0.02)
    return [_status(message) for _, message in sorted(newest.items())]


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
