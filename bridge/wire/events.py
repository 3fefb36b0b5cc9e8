"""The texts of events: written by the plant, read again by those who judge, tell and replay a run."""

import re
from typing import Any, NamedTuple

from bridge.wire.messages import Ending, EventKind, Reason


def refusal(reason: Reason, text: str) -> str:
    """The text of a `refused` event."""
    return f"{reason}: {text}"


NO_MORE_TOLD = "; more of these are only counted"


def ends_telling(event: Any) -> bool:
    """Is a `refused` event the last that is written, though commands may be refused after it?"""
    return event.kind == EventKind.REFUSED and event.text.endswith(NO_MORE_TOLD)


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


def fault_turn(name: str, begins: bool, words: str) -> str:
    """The text of a `fault` event: a fault begins or ends; its number in the scenario stands in `command`, too."""
    return f"{name!r} {'begins' if begins else 'ends'}: {words}"


def injection(fault: str) -> str:
    """The text of a `fault` event of one that somebody has injected, by its table as JSON."""
    return f"injected {fault}"


def is_injection(event: Any) -> bool:
    """Does an event say that somebody has injected a fault?"""
    return event.kind == EventKind.FAULT and not event.command and event.text.startswith("injected ")


def injected(event: Any) -> str:
    """The table of such a fault, as JSON."""
    return event.text.removeprefix("injected ")


def withdrawal(name: str) -> str:
    """The text of a `fault` event of one that somebody has ended; that of its end follows, if it had begun."""
    return f"withdrawn '{name}'"


def withdrawn(event: Any) -> str:
    """The name of the fault in such an event; "" in another one."""
    told = event.kind == EventKind.FAULT and not event.command and event.text.startswith("withdrawn '")
    return event.text.removeprefix("withdrawn '").removesuffix("'") if told else ""


class FaultTurn(NamedTuple):
    """A fault begins or ends."""

    name: str
    begins: bool
    words: str


def turn_of(event: Any) -> FaultTurn | None:
    """What a `fault` event says of a fault; None for that of an injection, and for another event."""
    match = _TURN.fullmatch(event.text) if event.kind == EventKind.FAULT else None
    return None if match is None else FaultTurn(match[1], match[2] == "begins", match[3])


_TURN = re.compile(r"'(.*?)' (begins|ends): (.*)", re.DOTALL)
