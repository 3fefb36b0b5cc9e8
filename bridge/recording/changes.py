"""The changes of numbers during a run, for pictures of it."""

from typing import Any, NamedTuple

from bridge.recording.reader import Recording
from bridge.wire.messages import EventKind
from controller.grid import NS

MOST = 40  # lines in a picture; more would hide what it shows


class Change(NamedTuple):
    """A number changed."""

    time: float  # [s]
    text: str


def changes(recording: Recording) -> list[Change]:
    """The first of them, in their order."""
    if "event" not in recording.counts:
        return []
    events = [event for event in recording.messages("event") if event.kind == EventKind.CHANGED]
    return sorted(Change(event.apply_at / NS, event.text) for event in events)[:MOST]


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
