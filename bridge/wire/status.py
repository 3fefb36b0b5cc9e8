"""What processes say of themselves, as values with types and as the names and numbers of a `status` message."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from bridge.wire.messages import Phase
from twin.topology import PRESSURES

REFUSED, PUBLISHED, FAULTED = "refused/", "published/", "faulted/"  # a count per reason, topic, word
TURNED = "turned away/"  # a count per kind of message and reason: what did not come in at all


class Reading(NamedTuple):
    """What the card and the valve show."""

    position: float  # [m]
    pressures: tuple[float, ...]  # [Pa] gauge, in the order of PRESSURES
    spool: float  # spool reference in force, -1 .. 1

    def plain(self) -> dict[str, float]:
        """Names and numbers of the message."""
        return {"position": self.position, **dict(zip(PRESSURES, self.pressures, strict=True)), "spool": self.spool}

    @classmethod
    def from_plain(cls, values: Mapping[str, float]) -> "Reading | None":
        """Back again; None where one of its numbers is missing."""
        if not all(name in values for name in ("position", *PRESSURES, "spool")):
            return None
        return cls(values["position"], tuple(values[name] for name in PRESSURES), values["spool"])


class Pace(NamedTuple):
    """How a plant keeps up with the clock."""

    overruns: int
    worst_overrun: float  # [s] wall
    longest_burst: int  # most ticks caught up in a row
    lateness: float  # [s] wall, the greatest since the last status
    round_trip: float  # [s] wall, of the newest command; below zero without a new one
    late_ticks: int = 0  # a period or more late; a row of them is one overrun
    skipped: int = 0  # periods that the run is behind the clock, since it skips

    def plain(self) -> dict[str, float]:
        """Names and numbers of the message; a run that skips nothing says nothing of it."""
        return {name: value for name, value in self._asdict().items() if name != "skipped" or value}


class PlantStatus(NamedTuple):
    """What a plant says of itself."""

    tick: int
    ticks: int  # of the whole run
    commands: int | None = 0  # taken; None where a foreign plant does not say
    late: int = 0  # of those
    worst_late: float = 0.0  # [s] of simulated time
    safe_states: int = 0
    reading: Reading | None = None  # None before the first measurement
    refused: Mapping[str, int] = {}  # commands by reason
    pace: Pace | None = None  # None without a clock
    published: Mapping[str, int] = {}  # messages per topic, with the last words
    faulted: Mapping[str, int] = {}  # what faults of the link have done, by what
    turned: Mapping[str, int] = {}  # away at the door, by what and why

    def plain(self) -> dict[str, float]:
        """Names and numbers of the message."""
        own = {name: value for name, value in zip(self._fields[:6], self[:6], strict=True) if value is not None}
        reading = self.reading.plain() if self.reading else {}
        pace = self.pace.plain() if self.pace else {}
        sent = counted(PUBLISHED, self.published) | counted(FAULTED, self.faulted) | counted(TURNED, self.turned)
        return own | reading | counted(REFUSED, self.refused) | pace | sent

    @classmethod
    def from_plain(cls, values: Mapping[str, float]) -> "PlantStatus":
        """Back again; what a foreign plant does not say is 0, and a group that is not whole is left out."""
        return cls(
            tick=_whole(values, "tick"),
            ticks=_whole(values, "ticks"),
            commands=_whole(values, "commands") if "commands" in values else None,
            late=_whole(values, "late"),
            worst_late=values.get("worst_late", 0.0),
            safe_states=_whole(values, "safe_states"),
            reading=Reading.from_plain(values),
            refused=counts(REFUSED, values),
            pace=_pace(values),
            published=counts(PUBLISHED, values),
            faulted=counts(FAULTED, values),
            turned=counts(TURNED, values),
        )


class PlantReport(NamedTuple):
    """The last words of a plant."""

    status: PlantStatus
    phase: Phase
    reason: str  # of a failure

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return self.status.plain() | {"phase": self.phase, "reason": self.reason}


def numbers_of(message: Any) -> dict[str, float]:
    """The numbers of a `status` message by name."""
    return dict(zip(message.names, (float(value) for value in message.values), strict=True))


def plant_status(message: Any) -> PlantStatus | None:
    """What a `status` message of a plant says; None for one of somebody else."""
    return PlantStatus.from_plain(numbers_of(message)) if message.role == "plant" else None


def counted(prefix: str, numbers: Mapping[str, int]) -> dict[str, float]:
    """Counts as numbers of a message."""
    return {f"{prefix}{name}": number for name, number in numbers.items()}


def counts(prefix: str, values: Mapping[str, float]) -> dict[str, int]:
    """Counts by the names after a prefix."""
    return {name.removeprefix(prefix): _whole(values, name) for name in values if name.startswith(prefix)}


def _pace(values: Mapping[str, float]) -> Pace | None:
    if "overruns" not in values:
        return None
    return Pace(
        overruns=_whole(values, "overruns"),
        worst_overrun=values.get("worst_overrun", 0.0),
        longest_burst=_whole(values, "longest_burst"),
        lateness=values.get("lateness", 0.0),
        round_trip=values.get("round_trip", -1.0),
        late_ticks=_whole(values, "late_ticks"),
        skipped=_whole(values, "skipped"),
    )


def _whole(values: Mapping[str, float], name: str) -> int:
    value = values.get(name, 0.0)
    return round(value) if math.isfinite(value) else 0
