"""Which of the recorded commands the plant never took."""

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any

from bridge.wire.events import missed_by, silent_since
from bridge.wire.messages import EventKind

Name = tuple[int, int]  # source and sequence of a command


def refused(events: Sequence[Any]) -> set[Name]:
    """Those that it has said it refused; after one that `ends_telling` it may have refused others."""
    return {(event.source, event.command) for event in events if event.kind == EventKind.REFUSED}


def unheard(events: Sequence[Any], commands: Sequence[Any]) -> set[Name]:
    """Those that never came to it."""
    found: set[Name] = set()
    missed = [event for event in events if event.kind == EventKind.MISSED]
    for event in (event for event in missed if event.source):
        sent = sorted(command.sequence for command in commands if command.source == event.source)
        gap = missed_by(event)
        found |= {(event.source, n) for n in sent[bisect_left(sent, gap.start) : bisect_left(sent, gap.stop)]}
    ends = [silent_since(event) for event in missed if not event.source]
    return found | {(c.source, c.sequence) for c in commands if any(c.sample_stamp >= end for end in ends)}
