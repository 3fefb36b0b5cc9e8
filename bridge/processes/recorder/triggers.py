"""What opens the ring of a recorder: kinds of events, and signals that go past a limit."""

import re
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from bridge.errors import UsageError, nearest
from bridge.scenario.conditions import MEASURED, Crossing, crosses, crossing
from bridge.wire.channels import Layout
from bridge.wire.messages import CHANNELS_TOPIC, TOLD, EventKind
from twin.topology import OBSERVED

FURTHER = f"{CHANNELS_TOPIC}."
KINDS = [kind.value for kind in EventKind]
REMEMBERED = 100  # triggers whose cause a file names


class Cause(NamedTuple):
    """What has opened the ring."""

    by: str
    time: int  # [ns]


class Watched(NamedTuple):
    """A condition, and where its signal is found."""

    text: str
    condition: Crossing
    topic: str
    place: str | int  # name of a field; of a further channel its number


def split(text: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Kinds of events and conditions of a list such as "safe,p2 > 60 bar". Raises UsageError naming what fits."""
    words = [] if text == "none" else [word.strip() for word in text.split(",")]
    conditions = tuple(word for word in words if "<" in word or ">" in word)
    kinds = tuple(word for word in words if word not in conditions)
    for kind in kinds:
        if kind not in KINDS:
            raise UsageError(f"--triggers {kind!r}: neither a kind of event nor a condition{nearest(kind, KINDS)}")
    for condition in conditions:
        if not condition.startswith(FURTHER):  # which there are, the plant says
            _condition(condition, {})
    return kinds, conditions


def topics_of(conditions: tuple[str, ...]) -> set[str]:
    """The topics that conditions are about."""
    return {_topic(condition) for condition in conditions}


class Triggers:
    """Those of one run. Raises UsageError for a condition about a channel that its card does not read."""

    def __init__(self, kinds: tuple[str, ...], conditions: tuple[str, ...], layout: Layout) -> None:
        self._kinds = kinds
        units = {f"{FURTHER}{field.name}": field.unit for field in layout}
        places = {f"{FURTHER}{field.name}": place for place, field in enumerate(layout)}
        parsed = ((text, _condition(text, units)) for text in conditions)
        self._watched = [
            Watched(text, found, _topic(text), places.get(found.signal, found.signal.rpartition(".")[2]))
            for text, found in parsed
        ]
        self._past = [True] * len(self._watched)  # a signal that is past its limit at the start has not crossed it
        self.causes: deque[Cause] = deque(maxlen=REMEMBERED)

    def heed(self, topic: str, message: Any) -> bool:
        """Does a message open the ring?"""
        found = list(self._crossed(topic, message))
        if topic in TOLD and message.kind in self._kinds:
            found.append(message.kind)
        self.causes.extend(Cause(by, message.stamp) for by in found)
        return bool(found)

    def _crossed(self, topic: str, message: Any) -> Iterator[str]:
        for number, watched in enumerate(self._watched):
            if watched.topic == topic:
                place = watched.place
                value = message.values[place] if isinstance(place, int) else getattr(message, place)
                was, self._past[number] = self._past[number], crosses(watched.condition, value)
                if self._past[number] and not was:
                    yield watched.text


def _condition(text: str, units: Mapping[str, str]) -> Crossing:
    try:
        return crossing(text, further=units, strict=True)
    except ValueError as error:
        raise UsageError(f"--triggers: {error}") from None


def _topic(condition: str) -> str:
    signal = re.split("[<>]", condition)[0].strip()
    if signal.startswith(FURTHER):
        return CHANNELS_TOPIC
    return "state" if signal in OBSERVED else MEASURED
