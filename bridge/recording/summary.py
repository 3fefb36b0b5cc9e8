"""What a run came to: control metrics, timing, losses. Computed from the recording, so that anybody can again."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.recording.columns import signals
from bridge.recording.reader import Recording
from bridge.scenario import Scenario
from bridge.wire.messages import Ending, EventKind, ending_of, reason_of
from controller.metrics import measure

NEEDED = ("state", "timing", "event", "status")  # topics that a summary is made of
PERCENTILES = {"p50": 50.0, "p99": 99.0, "p99.9": 99.9, "max": 100.0}


def summarise(recording: Recording, scenario: Scenario, losses: dict[str, int]) -> dict[str, Any]:
    """Plain data, NaN-free: what is not defined for a run is None."""
    events = recording.messages("event")
    ended = [event.text for event in events if event.kind == EventKind.ENDED]
    ticks = recording.counts.get("state", 0)
    result = {
        "scenario": scenario.name,
        "ending": ended[0] if ended else Ending.CUT_OFF,
        "simulated": max(0, ticks - 1) * scenario.loop.daq_period,
        "metrics": _metrics(recording, scenario) if ticks > 1 else {},
        "timing": _timing(recording),
        "commands": _commands(recording, events),
        "safe_states": sum(event.kind == EventKind.SAFE for event in events),
        "lost": losses,
        "messages": dict(sorted(recording.counts.items())),
    }
    return _plain(result)


def verdict(summary: dict[str, Any], scenario: Scenario) -> list[str]:
    """What makes a run a failure, in words; empty for a good one."""
    faults = []
    if ending_of(summary["ending"]) != Ending.COMPLETE:
        faults.append(f"the run ended early: {summary['ending']}")
    if summary["safe_states"]:
        faults.append(f"the plant went to its safe state {summary['safe_states']} times")
    if sum(summary["lost"].values()):
        faults.append(f"messages were lost on the way to the recorder: {summary['lost']}")
    overruns, policy = summary["timing"].get("overruns"), scenario.real_time
    if overruns and (overruns["count"] > policy.overruns or overruns["worst"] > policy.length):
        faults.append(
            f"{overruns['count']} overruns, the longest {overruns['worst'] * 1e3:.1f} ms: real_time allows "
            f"{policy.overruns} of at most {policy.length * 1e3:g} ms"
        )
    return faults


def _metrics(recording: Recording, scenario: Scenario) -> dict[str, float]:
    with np.errstate(invalid="ignore"):
        return measure(signals(recording, scenario))._asdict()


def _timing(recording: Recording) -> dict[str, Any]:
    columns = recording.columns("timing")
    if not len(columns["tick"]):
        return {}
    trips = columns["round_trip"][columns["round_trip"] >= 0]
    return {
        "lateness": _spread(columns["lateness"]),
        "cost": _spread(columns["cost"]),
        "round_trip": _spread(trips) if len(trips) else {},
        "overruns": _last_overruns(recording),
    }


def _spread(values: NDArray[Any]) -> dict[str, float]:
    return {name: float(np.percentile(values, q)) * 1e-9 for name, q in PERCENTILES.items()}


def _last_overruns(recording: Recording) -> dict[str, float]:
    for status in reversed(recording.messages("status")):
        values = dict(zip(status.names, status.values, strict=True))
        if status.role == "plant" and "overruns" in values:
            return {
                "count": int(values["overruns"]),
                "worst": float(values["worst_overrun"]),
                "burst": int(values["longest_burst"]),
            }
    return {}


def _commands(recording: Recording, events: list[Any]) -> dict[str, Any]:
    refused: dict[str, int] = {}
    for status in recording.messages("status"):
        if status.role == "plant":
            values = dict(zip(status.names, status.values, strict=True))
            refused = {
                name.removeprefix("refused/"): int(v) for name, v in values.items() if name.startswith("refused/")
            }
    if not refused:
        for event in events:
            if event.kind == EventKind.REFUSED:
                reason = reason_of(event)
                refused[reason] = refused.get(reason, 0) + 1
    late = [event.applied_at - event.apply_at for event in events if event.kind == EventKind.LATE]
    return {
        "sent": recording.counts.get("command", 0),
        "late": len(late),
        "worst_lateness": max(late, default=0) * 1e-9,
        "refused": refused,
    }


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value
