"""The loop of one process, driven from outside: whoever calls decides the command of each sample."""

from collections.abc import Iterator
from typing import Any

from bridge.loop.controller import sample_of
from bridge.loop.exchange import answered, sides
from bridge.scenario import Scenario
from bridge.wire.events import last_words
from bridge.wire.messages import Ending, Outgoing
from controller.grid import is_sample
from controller.law import NO_CHANNELS, Sample
from controller.laws import ControlLaw
from controller.reference import Target


class SteppedLoop:
    """One run: `start`, then `advance` from sample to sample until `over`; the messages are those of `exchange`."""

    def __init__(self, scenario: Scenario, lean: bool = True) -> None:
        self.plant, self.controller = sides(scenario, ControlLaw(self._answer))
        self.ticks = scenario.ticks
        self._lean = lean
        self._spool = 0.0
        self._out: list[Outgoing] = []  # of the newest tick, not answered yet
        self._target: tuple[int, Target] | None = None  # the last that was asked for, and its stamp [ns]

    @property
    def over(self) -> bool:
        """Has the run reached its end?"""
        return self.plant.tick_number >= self.ticks

    @property
    def sample(self) -> Sample:
        """The newest scan, as a law is given it."""
        heard = self.plant.heard[-1]
        named = NO_CHANNELS if heard.channels is None else self.controller.named(heard.channels.values)
        return sample_of(heard.measurement.stamp, vars(heard.measurement), named)

    @property
    def target(self) -> Target:
        """What the reference asks for now."""
        now = self.plant.now
        if self._target is None or self._target[0] != now:
            self._target = now, self.controller.target(now)
        return self._target[1]

    def start(self) -> Iterator[list[Outgoing]]:
        """The messages of each tick up to the first sample."""
        self._out = self.plant.start()
        yield self._out
        yield from self._onward()

    def advance(self, spool: float) -> Iterator[list[Outgoing]]:
        """Command a spool reference; the answers, then the messages of each tick up to the next sample or the end."""
        self._spool = spool
        yield answered(self.plant, self.controller, self._out)
        yield self._tick()
        yield from self._onward()

    def finish(self) -> list[Outgoing]:
        """The plant's last words."""
        ending = Ending.COMPLETE if self.over else Ending.INTERRUPTED
        return self.plant.finish(last_words(ending, self.plant.tick_number))

    def _onward(self) -> Iterator[list[Outgoing]]:
        """Ticks that nobody answers, whose events the controller heeds all the same."""
        while not (self.over or self._is_sample()):
            answered(self.plant, self.controller, self._out)
            yield self._tick()

    def _tick(self) -> list[Outgoing]:
        self._out = self.plant.tick(self._lean)
        return self._out

    def _is_sample(self) -> bool:
        """Has the controller been sent a sample that is newer than all before?"""
        stamps = (heard.measurement.stamp for heard in self.plant.heard)
        return any(is_sample(stamp, self.controller.grid) and stamp > self.controller.newest for stamp in stamps)

    def _answer(self, sample: Sample, target: Target, memory: Any, gains: Any) -> tuple[float, Any]:
        return self._spool, memory
