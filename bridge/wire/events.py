"""The texts of events: written by the plant, read again by those who judge, tell and replay a run."""

from typing import Any

from bridge.wire.messages import Ending, EventKind, Reason


def refusal(reason: Reason, text: str) -> str:
    """The text of a `refused` event."""
    return f"{reason}: {text}"


def reason_of(event: Any) -> str:
    """The reason in a `refused` event."""
    return event.text.partition(":")[0]


def absence(first: int, last: int) -> str:
    """The text of a `missed` event, by the first and the last sequence."""
    return f"commands {first} to {last} were not taken"


def missed_by(event: Any) -> range:
    """The sequences in a `missed` event of a source."""
    words = event.text.split()
    return range(int(words[1]), int(words[3]) + 1)


def silence(since: int) -> str:
    """The text of the `missed` event at the end of a run, which has no source, by an instant [ns]."""
    return f"no command was taken for samples from {since} ns on"


def silent_since(event: Any) -> int:
    """The instant in a `missed` event without a source [ns]."""
    return int(event.text.split()[-3])


def last_words(ending: Ending, ticks: int, reason: str = "") -> str:
    """The text of an `ended` event."""
    return f"{ending}{f': {reason}' if reason else ''} after {ticks} ticks"


def line_of_law(event: Any) -> str:
    """A `said` event as people read it on a terminal."""
    return f"t = {event.stamp / 1e9:g} s: law: {event.text}"


def ending_of(text: str) -> Ending:
    """How a run ended, by the text of its `ended` event or of its summary."""
    return next((ending for ending in Ending if text.startswith(ending)), Ending.CUT_OFF)


def setting(name: str, value: float, over: int = 0) -> str:
    """The text of a `changed` event of a number that somebody has set, in SI, and how long it takes to be so [ns]."""
    return f"{name} = {value!r}{f' over {over} ns' if over else ''}"


def is_setting(event: Any) -> bool:
    """Does an event say what somebody has set, and not what the timeline has changed?"""
    return event.kind == EventKind.CHANGED and not event.command


def setting_of(text: str) -> tuple[str, float, int]:
    """Name, number and time [ns] in the text of such an event."""
    name, _, words = text.partition(" = ")
    value, _, over = words.partition(" over ")
    return name, float(value), int(over.removesuffix(" ns") or 0)


def timeline_entry(number: int, words: str) -> str:
    """The text of a `changed` event of the timeline; the number stands in its field `command`, too."""
    return f"timeline {number}: {words}"
