"""The changes of numbers, the faults and the plant's safety during a run, for pictures of it."""

import math
from typing import Any, NamedTuple

from bridge.recording.reader import Recording
from bridge.wire.events import turn_of
from bridge.wire.messages import EventKind, SafetyState
from controller.grid import NS

MOST = 40  # lines in a picture; more would hide what it shows


STATES = {  # after an event of the plant's safety; of the safe states pictures show one
    EventKind.SAFE: SafetyState.SAFE,
    EventKind.DEGRADED: SafetyState.DEGRADED,
    EventKind.RESTORED: SafetyState.RUNNING,
    EventKind.RESET: SafetyState.RUNNING,
    EventKind.RESUMED: SafetyState.RUNNING,
}
SHADES = {SafetyState.SAFE: "#d62728", SafetyState.DEGRADED: "#e8b400"}


class Change(NamedTuple):
    """A number changed, a fault began or ended, or the state of the plant's safety changed."""

    time: float  # [s]
    text: str


class Span(NamedTuple):
    """A time in which commands do not act as they should."""

    begin: float  # [s]
    end: float  # [s]; infinite: to the end of the run
    state: SafetyState  # SAFE, DEGRADED


def changes(recording: Recording) -> list[Change]:
    """The first of them, in their order."""
    if "event" not in recording.counts:
        return []
    events = recording.messages("event")
    told = [event for event in events if event.kind == EventKind.CHANGED or turn_of(event)]
    numbers = [Change(event.apply_at / NS, event.text) for event in told]
    states = [Change(_when(event), f"{event.kind}: {event.text}") for event in events if event.kind in STATES]
    return sorted(numbers + states)[:MOST]


def spans(recording: Recording) -> list[Span]:
    """When the plant was degraded, and when it was safe or latched."""
    events = [event for event in recording.messages("event") if event.kind in STATES]
    ends = [*(_when(event) for event in events[1:]), math.inf]
    found = (Span(_when(event), end, STATES[event.kind]) for event, end in zip(events, ends, strict=False))
    return [span for span in found if span.state in SHADES and span.end > span.begin]


def _when(event: Any) -> float:
    return (event.applied_at or event.stamp) / NS


def shade(axis: Any, found: list[Span], end: float) -> None:
    """Those times in a matplotlib axis that ends at a time [s]."""
    for span in found:
        colour = SHADES[span.state]
        axis.axvspan(span.begin, min(span.end, end), color=colour, alpha=0.13, linewidth=0.0, zorder=0)


def mark(axis: Any, found: list[Change]) -> None:
    """A thin line in a matplotlib axis at each change."""
    for change in found:
        axis.axvline(change.time, color="0.55", linewidth=0.8, linestyle=":", zorder=0)


def number(axis: Any, found: list[Change]) -> None:
    """Count the changes above an axis."""
    for count, change in enumerate(found, 1):
        place = (change.time, 1.0)
        axis.annotate(
            str(count), place, xycoords=("data", "axes fraction"), xytext=(0, 2), textcoords="offset points",
            ha="center", fontsize=7, color="0.35",
        )  # fmt: skip


def caption(found: list[Change], most: int = 8) -> str:
    """What the numbers stand for, a line each."""
    lines = [f"{count}  {change.time:.6g} s  {change.text}" for count, change in enumerate(found[:most], 1)]
    return "\n".join([*lines, *([f"... {len(found) - most} more"] if len(found) > most else [])])
