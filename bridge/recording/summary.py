"""What a run came to, as values with types, and as the plain data that recordings and JSON carry.

Times are in seconds, metrics in the units of `controller.bands.Metrics`. What an old recording does not say is None
(NaN of a metric), so that it can still be read.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.scenario import Scenario
from bridge.wire.messages import Ending, ending_of
from controller.bands import Metrics

if TYPE_CHECKING:
    from bridge.recording.reader import Recording

PERCENTILES = {"p50": 50.0, "p99": 99.0, "p99.9": 99.9, "max": 100.0}  # in the order of Spread


class Spread(NamedTuple):
    """Percentiles of a wall time [s]; NaN where the recording does not say."""

    p50: float
    p99: float
    p999: float
    greatest: float

    def plain(self) -> dict[str, float | None]:
        """For JSON and metadata."""
        return {name: _finite(value) for name, value in zip(PERCENTILES, self, strict=True)}

    @classmethod
    def from_plain(cls, values: Any) -> "Spread | None":
        """Back again; None for nothing."""
        return cls(*(_number(values, name) for name in PERCENTILES)) if _mapping(values) else None


class OverrunTotals(NamedTuple):
    """Ticks of a run in real time that were later than allowed."""

    number: int
    worst: float  # [s]
    burst: int  # most ticks caught up in a row

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata."""
        return {"count": self.number, "worst": self.worst, "burst": self.burst}

    @classmethod
    def from_plain(cls, values: Any) -> "OverrunTotals | None":
        """Back again; None for nothing."""
        if not _mapping(values):
            return None
        return cls(_count(values, "count"), _number(values, "worst", 0.0), _count(values, "burst"))


class TimingSummary(NamedTuple):
    """Wall times of a run in real time."""

    lateness: Spread | None  # of the wake-up of the ticks
    cost: Spread | None  # of a tick
    round_trip: Spread | None  # from a measurement to its command; None without any
    overruns: OverrunTotals | None

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata."""
        return {name: value.plain() if value else {} for name, value in self._asdict().items()}

    def shown(self) -> list[tuple[str, Spread]]:
        """What people look at, with its words."""
        rows = (("lateness of the ticks", self.lateness), ("measurement to command", self.round_trip))
        return [(words, spread) for words, spread in rows if spread]

    @classmethod
    def from_plain(cls, values: Any) -> "TimingSummary | None":
        """Back again; None for a run that had no clock."""
        if not _mapping(values):
            return None
        lateness, cost, trip = (Spread.from_plain(values.get(name)) for name in ("lateness", "cost", "round_trip"))
        return cls(lateness, cost, trip, OverrunTotals.from_plain(values.get("overruns")))


class CommandSummary(NamedTuple):
    """What became of the commands."""

    sent: int
    late: int
    worst_lateness: float  # [s]
    refused: Mapping[str, int]  # by reason

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata."""
        return self._asdict() | {"refused": dict(self.refused)}

    @classmethod
    def from_plain(cls, values: Any) -> "CommandSummary | None":
        """Back again; None for nothing."""
        if not _mapping(values):
            return None
        worst = _number(values, "worst_lateness", 0.0)
        return cls(_count(values, "sent"), _count(values, "late"), worst, _counts(values, "refused"))


class Summary(NamedTuple):
    """What a run came to."""

    scenario: str
    ending: str  # the plant's own words
    simulated: float | None  # [s]
    metrics: Metrics | None  # NaN: not defined for this run; None: the run is too short for any
    timing: TimingSummary | None  # None: a run without a clock
    commands: CommandSummary | None
    safe_states: int  # how often the plant went to its safe state
    lost: Mapping[str, int]  # messages on their way to the recorder, per topic
    messages: Mapping[str, int]  # recorded ones, per topic
    rejected: int | None = None  # what came to the recorder and is not a message of the run; None without a recorder

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata: what is not defined is None."""
        values = {
            "scenario": self.scenario,
            "ending": self.ending,
            "simulated": self.simulated,
            "metrics": plain_metrics(self.metrics),
            "timing": self.timing.plain() if self.timing else {},
            "commands": self.commands.plain() if self.commands else {},
            "safe_states": self.safe_states,
            "lost": dict(self.lost),
            "messages": dict(self.messages),
        }
        return values if self.rejected is None else values | {"rejected": self.rejected}

    @classmethod
    def from_plain(cls, values: Mapping[str, Any]) -> "Summary":
        """Back again, from what any version has written."""
        return cls(
            scenario=str(values.get("scenario", "")),
            ending=str(values.get("ending", Ending.CUT_OFF)),
            simulated=_finite(_number(values, "simulated")),
            metrics=_metrics(values.get("metrics")),
            timing=TimingSummary.from_plain(values.get("timing")),
            commands=CommandSummary.from_plain(values.get("commands")),
            safe_states=_count(values, "safe_states"),
            lost=_counts(values, "lost"),
            messages=_counts(values, "messages"),
            rejected=_count(values, "rejected") if "rejected" in values else None,
        )


def summary_of(recording: "Recording") -> Summary | None:
    """The summary that a recording carries; None where it carries none."""
    known = recording.metadata.get("summary")
    return Summary.from_plain(known) if known else None


def verdict(summary: Summary, scenario: Scenario) -> list[str]:
    """What makes a run a failure, in words; empty for a good one."""
    faults = []
    if ending_of(summary.ending) != Ending.COMPLETE:
        faults.append(f"the run ended early: {summary.ending}")
    if summary.safe_states:
        faults.append(f"the plant went to its safe state {summary.safe_states} times")
    if sum(summary.lost.values()):
        faults.append(f"messages were lost on the way to the recorder: {dict(summary.lost)}")
    overruns, policy = summary.timing and summary.timing.overruns, scenario.real_time
    if overruns and (overruns.number > policy.overruns or overruns.worst > policy.length):
        faults.append(
            f"{overruns.number} overruns, the longest {overruns.worst * 1e3:.1f} ms: real_time allows "
            f"{policy.overruns} of at most {policy.length * 1e3:g} ms"
        )
    return faults


def plain_metrics(metrics: Metrics | None) -> dict[str, float | None]:
    """Metrics for JSON and tables: what is not defined is None."""
    return {} if metrics is None else {name: _finite(value) for name, value in metrics._asdict().items()}


def _metrics(values: Any) -> Metrics | None:
    return Metrics(*(_number(values, name) for name in Metrics._fields)) if _mapping(values) else None


def _mapping(values: Any) -> bool:
    return isinstance(values, Mapping) and bool(values)


def _number(values: Mapping[str, Any], name: str, default: float = math.nan) -> float:
    """A number of a recording, whose metadata have no checksum."""
    value = values.get(name)
    return float(value) if isinstance(value, int | float) else default


def _count(values: Mapping[str, Any], name: str) -> int:
    value = _number(values, name, 0.0)
    return round(value) if math.isfinite(value) else 0


def _counts(values: Mapping[str, Any], name: str) -> dict[str, int]:
    found = values.get(name)
    return {str(key): _count(found, key) for key in found} if isinstance(found, Mapping) else {}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
