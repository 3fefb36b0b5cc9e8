"""The controller as its partners see it: measurements in, commands out. No clock, no network."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from bridge.errors import RunError, ScenarioError, nearest
from bridge.loop.controller_tuning import ControllerTuning
from bridge.loop.law import law_of
from bridge.loop.law_messages import LawMessages
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.scenario.gains import law_gains
from bridge.wire.codec import Reference, ValveCommand
from bridge.wire.messages import EventKind, Outgoing
from controller.grid import NS, is_sample
from controller.law import NO_CHANNELS, Readings, Sample, TrueSample
from controller.laws import ControlLaw
from controller.reference import Target, evaluate
from twin.topology import CHANNELS

READ = tuple(name for name in Sample._fields if name in CHANNELS)  # of each measurement


class ControllerSide:
    """One run of a control law: the scenario's, or another one in its place, which gets the same gains."""

    def __init__(self, scenario: Scenario, source: int, law: ControlLaw | None = None) -> None:
        self.grid = scenario.loop.grid()
        self.source = source
        scenarios = law_of(scenario.controller)
        self.law = scenarios if law is None else law._replace(prepare=scenarios.prepare)
        given = law is not None or scenario.controller.reads_channels
        self._names = tuple(chosen(scenario)) if given else ()  # of the further channels that the law gets
        _refuse_lack(self.law, self._names)
        self.gains = self.law.prepare(law_gains(scenario))
        self.reference = scenario.reference.reference()
        self.follows = scenario.controller.follows
        self.own = LawMessages(source, self.law.name)  # what the law has logged and printed
        self._sent = 0
        self._newest = 0, -1  # run and stamp of the newest sample that was answered
        self._tuning = ControllerTuning(scenario)
        for changed in self._tuning.foreseen():
            self.law.prepare(law_gains(changed))
        self.sees_truth = scenario.controller.sees_truth
        self._true: Any = None
        self._channels: Any = None
        self._memory: Any = None

    @property
    def reads_channels(self) -> bool:
        """Is the law given further channels of the card?"""
        return bool(self._names)

    def see(self, state: Any) -> None:
        """Take the true state of a tick, before its measurement, for a law that asks for it."""
        self._true = state

    def hear(self, channels: Any) -> None:
        """Take the further channels of a tick, before its measurement. Raises RunError for those of another layout."""
        if self._names and len(channels.values) != len(self._names):
            raise RunError(
                f"the plant publishes {len(channels.values)} further channels, this controller's scenario has "
                f"{len(self._names)}: give both the same daq.channels"
            )
        self._channels = channels

    def named(self, values: Iterable[float]) -> Mapping[str, float]:
        """A scan of the further channels, as the law is given it."""
        return Readings(zip(self._names, values, strict=True))

    @property
    def newest(self) -> int:
        """Stamp of the newest sample that was answered [ns]; -1 before the first."""
        return self._newest[1]

    def waits(self, stamp: int) -> bool:
        """Does the law need more of a sample than its measurement, and has not got it yet?"""
        lacks = (self.sees_truth and _other(self._true, stamp)) or (self._names and _other(self._channels, stamp))
        return bool(lacks) and is_sample(stamp, self.grid)

    @property
    def published(self) -> dict[str, int]:
        """Messages per topic so far."""
        return {"command": self._sent, "reference": self._sent, **self.own.published}

    def answer(self, measurement: Any) -> list[Outgoing]:
        """What there is to say to a measurement at a sampling instant, nothing to others.

        First the command, which the plant waits for, last the reference, and between them what the law has said.
        """
        stamp = measurement.stamp
        if not is_sample(stamp, self.grid) or self._is_old(measurement):
            return []
        self.own.run_id = measurement.run_id
        sample = sample_of(stamp, vars(measurement), self._further())
        spool, target = self.decide(TrueSample(*sample, self._true) if self.sees_truth else sample)
        sequence, self._sent = self._sent, self._sent + 1
        position = target.position if self.follows else math.nan
        own = {"run_id": measurement.run_id, "source": self.source, "sequence": sequence}
        command = ValveCommand(**own, sample_stamp=stamp, apply_at=stamp + self.grid.delay, spool=spool)
        wanted = Reference(**own, stamp=stamp, position=position, velocity=target.velocity)
        return [
            Outgoing("command", stamp, sequence, command),
            *self.own.take(),
            Outgoing("reference", stamp, sequence, wanted),
        ]

    def heed(self, event: Any) -> list[Outgoing]:
        """Tell the law when its commands do not act any more, and when they act again; what it prints at that.

        And take changes of its numbers.
        """
        if event.kind == EventKind.CHANGED:
            self._tuning.heed(event.text, event.command, event.apply_at)
        hooks = {EventKind.SAFE: self.law.on_safe_state}
        hooks |= dict.fromkeys((EventKind.RESET, EventKind.RESUMED), self.law.on_resume)
        if event.kind not in hooks:
            return []
        self.own.run_id = event.run_id
        self._memory = self.own.hear(event.stamp, hooks[event.kind], self._memory)
        return self.own.take()

    def learn(self, text: str, entry: int, apply_at: int) -> None:
        """Take a change that the plant told before this controller came."""
        self._tuning.heed(text, entry, apply_at)

    def decide(self, sample: Sample | TrueSample) -> tuple[float, Target]:
        """The spool reference for the next sample, and the target it is after."""
        stamp = sample.stamp_ns
        if (changed := self._tuning.changed(stamp)) is not None:
            self._retune(changed, stamp)
        target = self.target(stamp)
        spool, self._memory, *signals = self.own.hear(stamp, self.law.answer, sample, target, self._memory, self.gains)
        self.own.log(stamp, *signals)
        return float(spool), target

    def _is_old(self, measurement: Any) -> bool:
        """Has a sample as new been answered? A link may double messages, or let them overtake one another."""
        newest = measurement.run_id, measurement.stamp
        old = newest[0] == self._newest[0] and newest[1] <= self._newest[1]
        self._newest = self._newest if old else newest
        return old

    def _further(self) -> Mapping[str, float]:
        return self.named(self._channels.values) if self._names else NO_CHANNELS

    def _retune(self, changed: Scenario, stamp: int) -> None:
        """Take other numbers; where the law's own declaration refuses them, those before stay, and it is told."""
        try:
            self.gains = self.law.prepare(law_gains(changed))
        except ScenarioError as error:
            self.own.hear(stamp, print, f"refused, the numbers before stay: {error}")

    def target(self, stamp: int) -> Target:
        """What the law is after at a stamp [ns]."""
        return self._tuning.target(evaluate(self.reference, stamp / NS), stamp)


def sample_of(stamp: int, readings: Mapping[str, Any], channels: Mapping[str, float] = NO_CHANNELS) -> Sample:
    """What a law is given of a scan at a stamp [ns]: the channels that it may read."""
    return Sample(stamp, **{name: readings[name] for name in READ}, channels=channels)


def _refuse_lack(law: ControlLaw, chosen: tuple[str, ...]) -> None:
    """Raises ScenarioError for a law that reads a channel which the scenario has not chosen."""
    for name in law.channels:
        if name not in chosen:
            raise ScenarioError(
                f"the law {law.name} reads the channel {name!r}, which daq.channels does not name"
                f"{nearest(name, chosen) if chosen else ''}: add it there"
            )


def _other(message: Any, stamp: int) -> bool:
    """Is the newest message of a topic not that of a stamp [ns]?"""
    return message is None or message.stamp != stamp
