"""The controller as its partners see it: measurements in, commands out. No clock, no network."""

import math
from collections.abc import Mapping
from typing import Any

from bridge.loop.law import law_of
from bridge.scenario import Scenario
from bridge.scenario.gains import law_gains
from bridge.wire.codec import Reference, ValveCommand
from bridge.wire.messages import EventKind, Outgoing
from controller.grid import NS, is_sample
from controller.law import Sample
from controller.reference import Target, evaluate


class ControllerSide:
    """One run of a control law."""

    def __init__(self, scenario: Scenario, source: int) -> None:
        self.grid = scenario.loop.grid()
        self.source = source
        self.law = law_of(scenario.controller)
        self.gains = self.law.prepare(law_gains(scenario))
        self.reference = scenario.reference.reference()
        self.follows = scenario.controller.follows
        self.published: dict[str, int] = {"command": 0, "reference": 0}
        self._memory: Any = None

    def answer(self, measurement: Any) -> list[Outgoing]:
        """The command and the reference for a measurement at a sampling instant, nothing for others."""
        stamp = measurement.stamp
        if not is_sample(stamp, self.grid):
            return []
        spool, target = self.decide(sample_of(stamp, vars(measurement)))
        sequence = self.published["command"]
        self.published = {"command": sequence + 1, "reference": sequence + 1}
        position = target.position if self.follows else math.nan
        own = {"run_id": measurement.run_id, "source": self.source, "sequence": sequence}
        command = ValveCommand(**own, sample_stamp=stamp, apply_at=stamp + self.grid.delay, spool=spool)
        wanted = Reference(**own, stamp=stamp, position=position, velocity=target.velocity)
        return [Outgoing("command", stamp, sequence, command), Outgoing("reference", stamp, sequence, wanted)]

    def heed(self, event: Any) -> None:
        """Tell the law when its commands do not act any more, and when they act again."""
        if event.kind == EventKind.SAFE:
            self._memory = self.law.on_safe_state(self._memory)
        elif event.kind in (EventKind.RESET, EventKind.RESUMED):
            self._memory = self.law.on_resume(self._memory)

    def decide(self, sample: Sample) -> tuple[float, Target]:
        """The spool reference for the next sample, and the target it is after."""
        target = self.target(sample.stamp_ns)
        spool, self._memory = self.law.answer(sample, target, self._memory, self.gains)
        return float(spool), target

    def target(self, stamp: int) -> Target:
        """What the law is after at a stamp [ns]."""
        return evaluate(self.reference, stamp / NS)


def sample_of(stamp: int, readings: Mapping[str, Any]) -> Sample:
    """What a law is given of a scan at a stamp [ns]: the channels that it may read."""
    return Sample(stamp, **{name: readings[name] for name in Sample._fields[1:]})
