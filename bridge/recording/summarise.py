"""Make the summary of a run: control metrics, timing, losses. From the recording, so that anybody can again."""

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.columns import signals, sine_of
from bridge.recording.reader import Recording
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
from bridge.wire.messages import Ending, EventKind, reason_of
from bridge.wire.status import PlantStatus, plant_status
from controller.bands import Metrics
from controller.metrics import measure

NEEDED = ("state", "timing", "event", "status")  # topics that a summary is made of


def summarise(recording: Recording, scenario: Scenario, losses: dict[str, int]) -> Summary:
    """What the messages of a recording say; `losses` are messages per topic that are not in it."""
    events = recording.messages("event")
    ended = [event.text for event in events if event.kind == EventKind.ENDED]
    ticks = recording.counts.get("state", 0)
    return Summary(
        scenario=scenario.name,
        ending=ended[0] if ended else Ending.CUT_OFF,
        simulated=max(0, ticks - 1) * scenario.loop.daq_period,
        metrics=_metrics(recording, scenario) if ticks > 1 else None,
        timing=_timing(recording),
        commands=_commands(recording, events),
        safe_states=sum(event.kind == EventKind.SAFE for event in events),
        lost=losses,
        messages=dict(sorted(recording.counts.items())),
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
    paces = [status.pace for status in _plant_statuses(recording) if status.pace]
    return OverrunTotals(paces[-1].overruns, paces[-1].worst_overrun, paces[-1].longest_burst) if paces else None


def _plant_statuses(recording: Recording) -> list[PlantStatus]:
    found = (plant_status(message) for message in recording.messages("status"))
    return [status for status in found if status is not None]


def _commands(recording: Recording, events: list[Any]) -> CommandSummary:
    late = [event.applied_at - event.apply_at for event in events if event.kind == EventKind.LATE]
    return CommandSummary(
        sent=recording.counts.get("command", 0),
        late=len(late),
        worst_lateness=max(late, default=0) * 1e-9,
        refused=_refused(recording, events),
    )


def _refused(recording: Recording, events: list[Any]) -> dict[str, int]:
    """Refused commands by reason: the plant counts them all, its events stop at a hundred of a kind."""
    statuses = _plant_statuses(recording)
    if statuses and statuses[-1].refused:
        return dict(statuses[-1].refused)
    return dict(Counter(reason_of(event) for event in events if event.kind == EventKind.REFUSED))
