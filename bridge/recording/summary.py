"""What a run came to, as values with types, and as the plain data that recordings and JSON carry.

Times are in seconds, metrics in the units of `controller.bands.Metrics`. What an old recording does not say is None
(NaN of a metric), so that it can still be read.
"""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.wire.messages import Ending
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

    number: int  # rows of late ticks
    worst: float  # [s]
    burst: int  # most ticks caught up in a row
    ticks: int | None = None  # late ones; None in recordings that do not say
    skipped: int = 0  # periods that the run was behind the clock at its end

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata."""
        known = {} if self.ticks is None else {"ticks": self.ticks}
        known |= {"skipped": self.skipped} if self.skipped else {}
        return {"count": self.number, "worst": self.worst, "burst": self.burst} | known

    @classmethod
    def from_plain(cls, values: Any) -> "OverrunTotals | None":
        """Back again; None for nothing."""
        if not _mapping(values):
            return None
        worst, burst = _number(values, "worst", 0.0), _count(values, "burst")
        return cls(_count(values, "count"), worst, burst, _known_count(values, "ticks"), _count(values, "skipped"))


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
    due: int | None = None  # by the grid; None where the plant does not say how far it came
    taken: int | None = None  # by the plant; None where it does not say
    faulted: Mapping[str, int] = {}  # what faults of the link did; `missing`, `refused`: commands, because of a fault

    def plain(self) -> dict[str, Any]:
        """For JSON and metadata."""
        known = {name: value for name, value in self._asdict().items() if value is not None and name != "faulted"}
        return known | {"refused": dict(self.refused)} | ({"faulted": dict(self.faulted)} if self.faulted else {})

    @classmethod
    def from_plain(cls, values: Any) -> "CommandSummary | None":
        """Back again; None for nothing."""
        if not _mapping(values):
            return None
        worst = _number(values, "worst_lateness", 0.0)
        due, taken = _known_count(values, "due"), _known_count(values, "taken")
        return cls(
            _count(values, "sent"),
            _count(values, "late"),
            worst,
            _counts(values, "refused"),
            due,
            taken,
            _counts(values, "faulted"),
        )


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
    first: Mapping[str, str] = {}  # text of the first event of each kind that a run should not have
    degraded: int = 0  # how often an alarm degraded the plant
    alarms: Mapping[str, int] = {}  # how often each has come, by its id
    turned: Mapping[str, int] = {}  # what arrived at a process and was not let in, by process, kind and reason

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
        rejected = {} if self.rejected is None else {"rejected": self.rejected}
        alarms = {"degraded": self.degraded, "alarms": dict(self.alarms)} if self.alarms else {}
        turned = {"turned_away": dict(self.turned)} if self.turned else {}
        return values | rejected | ({"first": dict(self.first)} if self.first else {}) | alarms | turned

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
            first=_texts(values, "first"),
            degraded=_count(values, "degraded"),
            alarms=_counts(values, "alarms"),
            turned=_counts(values, "turned_away"),
        )


def summary_of(recording: "Recording") -> Summary | None:
    """The summary that a recording carries; None where it carries none."""
    known = recording.metadata.get("summary")
    return Summary.from_plain(known) if known else None


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


def _known_count(values: Mapping[str, Any], name: str) -> int | None:
    return _count(values, name) if name in values else None


def _texts(values: Mapping[str, Any], name: str) -> dict[str, str]:
    found = values.get(name)
    return {str(key): str(text) for key, text in found.items()} if isinstance(found, Mapping) else {}


def _counts(values: Mapping[str, Any], name: str) -> dict[str, int]:
    found = values.get(name)
    return {str(key): _count(found, key) for key in found} if isinstance(found, Mapping) else {}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
