"""What came out of a replay less what was recorded: one message per instant, and one verdict per signal."""

import math
from pathlib import Path
from typing import Any, NamedTuple

from bridge.recording.compare import Difference
from bridge.recording.reader import Recording
from bridge.wire.codec import Residual
from bridge.wire.messages import EventKind, Outgoing
from twin.topology import CHANNELS

EVENTS = "event"
NOT_REPLAYED = (EventKind.REFUSED, EventKind.MISSED)


class ReplayResult(NamedTuple):
    """How a replay came out."""

    into: str
    differences: list[Difference]
    events_differ: str | None  # where the plant's events diverge; None where they do not
    output: Path
    missing: int  # messages that the recording lacks of what is fed: their effect is not a fault of what was fed

    @property
    def passed(self) -> bool:
        """Is every residual within its tolerance, and did the same things happen?"""
        return all(difference.passed for difference in self.differences) and self.events_differ is None


class Residuals:
    """Makes the residual of each message that has a recorded counterpart."""

    def __init__(self, recording: Recording, run_id: int) -> None:
        self._run_id = run_id
        self._count = 0
        self._recorded: dict[str, dict[int, Any]] = {
            "measurement": {m.stamp: m for m in recording.messages("measurement")},
            "command": {c.sample_stamp: c for c in recording.messages("command")},
        }

    def of(self, outgoing: Outgoing) -> Outgoing | None:
        """The residual of a message; None where nothing was recorded to compare it with."""
        kept = self._recorded.get(outgoing.topic)
        if kept is None:
            return None
        message = outgoing.message
        stamp = message.stamp if outgoing.topic == "measurement" else message.sample_stamp
        if (recorded := kept.get(stamp)) is None:
            return None
        apart = dict.fromkeys((*CHANNELS, "spool"), math.nan)
        names = CHANNELS if outgoing.topic == "measurement" else ("spool",)
        apart |= {name: getattr(outgoing.message, name) - getattr(recorded, name) for name in names}
        message = Residual(run_id=self._run_id, sequence=self._count, stamp=stamp, **apart)
        self._count += 1
        return Outgoing("residual", outgoing.log_time, message.sequence, message)


def events_apart(mine: Recording, recorded: Recording) -> str | None:
    """Where the events of two runs diverge, in one line. But for what was not taken.

    A refusal is told again, but its place among the other events of its tick is not known.
    """
    ours, theirs = _events(mine), _events(recorded)
    for one, other in zip(ours, theirs, strict=False):
        if one != other:
            return f"event {_words(one)}, recorded {_words(other)}"
    if len(ours) == len(theirs) or not recorded.complete:
        return None
    longer, whose = (ours, "only in the replay") if len(ours) > len(theirs) else (theirs, "only in the recording")
    return f"event {_words(longer[min(len(ours), len(theirs))])} {whose}"


def _events(recording: Recording) -> list[tuple[Any, ...]]:
    found = [event for event in recording.messages(EVENTS) if event.kind not in NOT_REPLAYED]
    return [(e.stamp, e.kind, e.source, e.command, e.apply_at, e.applied_at, e.text) for e in found]


def _words(event: tuple[Any, ...]) -> str:
    return f"at {event[0] / 1e9:g} s: {event[1]}: {event[-1]}"
