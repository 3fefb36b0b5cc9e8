"""Make the summary of a run: control metrics, timing, losses. From the recording, so that anybody can again."""

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.columns import signals, sine_of
from bridge.recording.reader import Recording
from bridge.recording.seen import instants
from bridge.recording.summary import (
    PERCENTILES,
    CommandSummary,
    OverrunTotals,
    Spread,
    Summary,
    TimingSummary,
    summary_of,
)
from bridge.scenario import Scenario
from bridge.wire.events import reason_of
from bridge.wire.messages import COMING, Ending, EventKind
from bridge.wire.status import PlantStatus, plant_status
from controller.bands import Metrics
from controller.grid import NS, number_due
from controller.metrics import measure

WRONG = (EventKind.REFUSED, EventKind.SAFE, EventKind.LATE, EventKind.DEGRADED)  # events that a run should not have
NEEDED = ("state", "timing", "event", "status", "reference")  # topics that a summary is made of


def summarise(
    recording: Recording, scenario: Scenario, losses: dict[str, int], status: PlantStatus | None = None
) -> Summary:
    """What the messages of a recording say; `losses` are messages per topic that are not in it.

    status: the plant's last one, where it is not recorded.
    """
    events = recording.messages("event")
    status = status or _last_status(recording)
    ended = [event.text for event in events if event.kind == EventKind.ENDED]
    ticks = instants(recording)
    return Summary(
        scenario=scenario.name,
        ending=ended[0] if ended else Ending.CUT_OFF,
        simulated=max(0, ticks - 1) * scenario.loop.daq_period,
        metrics=_metrics(recording, scenario) if ticks > 1 else None,
        timing=_timing(recording),
        commands=_commands(recording, scenario, events, status),
        safe_states=sum(event.kind == EventKind.SAFE for event in events),
        lost=losses,
        messages=dict(sorted(recording.counts.items())),
        first=_first(events),
        degraded=sum(event.kind == EventKind.DEGRADED and event.command > 0 for event in events),
        alarms=_alarms(events, scenario),
    )


def known_or_made(recording: Recording, scenario: Scenario) -> Summary:
    """The summary that a recording carries, or else one made of its messages."""
    return summary_of(recording) or summarise(recording, scenario, {})


def _metrics(recording: Recording, scenario: Scenario) -> Metrics:
    with np.errstate(invalid="ignore"):
        return measure(signals(recording, scenario), frequency=sine_of(scenario))


def _timing(recording: Recording) -> TimingSummary | None:
    columns = recording.columns("timing")
    if not len(columns["tick"]):
        return None
    trips = columns["round_trip"][columns["round_trip"] >= 0]
    return TimingSummary(
        lateness=_spread(columns["lateness"]),
        cost=_spread(columns["cost"]),
        round_trip=_spread(trips) if len(trips) else None,
        overruns=_last_overruns(recording),
    )


def _spread(values: NDArray[Any]) -> Spread:
    return Spread(*(float(np.percentile(values, q)) * 1e-9 for q in PERCENTILES.values()))


def _last_overruns(recording: Recording) -> OverrunTotals | None:
    pace = _last(recording, lambda status: status.pace is not None)
    if pace is None or pace.pace is None:
        return None
    _, worst, burst = pace.pace[:3]
    return OverrunTotals(pace.pace.overruns, worst, burst, pace.pace.late_ticks, pace.pace.skipped)


def _last_status(recording: Recording) -> PlantStatus | None:
    return _last(recording, lambda status: True)


def _last(recording: Recording, suits: Callable[[PlantStatus], bool]) -> PlantStatus | None:
    found = (plant_status(message) for message in reversed(recording.messages("status")))
    return next((status for status in found if status is not None and suits(status)), None)


def _commands(
    recording: Recording, scenario: Scenario, events: list[Any], status: PlantStatus | None
) -> CommandSummary:
    late = [event.applied_at - event.apply_at for event in events if event.kind == EventKind.LATE]
    grid = scenario.loop.grid()
    return CommandSummary(
        sent=recording.counts.get("command", 0),
        late=len(late),
        worst_lateness=max(late, default=0) * 1e-9,
        refused=dict(status.refused) if status and status.refused else _refused(events),
        due=None if status is None else number_due(status.tick * grid.daq, grid),
        taken=None if status is None else status.commands,
        faulted={} if status is None else dict(status.faulted),
    )


def _refused(events: list[Any]) -> dict[str, int]:
    """Refused commands by reason, as far as events go: after a hundred of a kind the plant only counts them."""
    return dict(Counter(reason_of(event) for event in events if event.kind == EventKind.REFUSED))


def _alarms(events: list[Any], scenario: Scenario) -> dict[str, int]:
    """How often each alarm has come, by its id."""
    numbers = [event.command for event in events if event.kind in COMING and event.command]
    ids = [alarm.id or str(number) for number, alarm in enumerate(scenario.alarm, 1)]
    return {own: numbers.count(number) for number, own in enumerate(ids, 1) if number in numbers}


def _first(events: list[Any]) -> dict[str, str]:
    """When and how it began to go wrong, for each kind of event that a run should not have."""
    wrong = [event for event in reversed(events) if event.kind in WRONG]
    return {str(event.kind): f"at {event.stamp / NS:g} s: {event.text}" for event in wrong}
