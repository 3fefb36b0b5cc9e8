"""What a law says of its own accord, as messages: the signals that it logs and the lines that it prints."""

from collections.abc import Callable
from typing import Any

import numpy as np

from bridge.loop.hearing import Hearing
from bridge.loop.logged import Logged
from bridge.wire.codec import Event, Signals
from bridge.wire.messages import EventKind, Outgoing


class LawMessages:
    """Those of one run of a law; they wait until they are taken."""

    def __init__(self, source: int, law: str) -> None:
        self.source = source
        self.run_id = 0
        self.published: dict[str, int] = {}  # messages per topic, of topics that have any
        self._hearing = Hearing()
        self._logged = Logged(law)
        self._signals: list[Outgoing] = []

    def speak_aloud(self) -> None:
        """Let standard output and standard error have what the law prints, too."""
        self._hearing.aloud = True

    def hear(self, stamp: int, function: Callable[..., Any], *arguments: Any) -> Any:
        """What a function of the law gives, at a stamp [ns]; what it prints is kept."""
        return self._hearing.call(stamp, function, *arguments)

    def log(self, stamp: int, given: Any = None) -> None:
        """Take the signals of a sample; None where the law gives none. Raises RunError for what does not fit."""
        values = self._logged.take(given, stamp)
        if not values:
            return
        message = Signals(
            **self._own("signals"),
            stamp=stamp,
            names=self._logged.names,
            units=self._logged.units,
            values=np.array(values),
        )
        self._signals.append(Outgoing("signals", stamp, message.sequence, message))

    def take(self) -> list[Outgoing]:
        """What has come since the last call."""
        lines = self._hearing.lines()
        if not lines and not self._signals:
            return []
        out = [self._said(line.stamp, line.text) for line in lines] + self._signals
        self._signals = []
        return out

    def _said(self, stamp: int, text: str) -> Outgoing:
        own = self._own("said")
        event = Event(**own, stamp=stamp, kind=EventKind.SAID, command=0, apply_at=0, applied_at=0, text=text)
        return Outgoing("said", stamp, event.sequence, event)

    def _own(self, topic: str) -> dict[str, int]:
        sequence = self.published.get(topic, 0)
        self.published[topic] = sequence + 1
        return {"run_id": self.run_id, "source": self.source, "sequence": sequence}
