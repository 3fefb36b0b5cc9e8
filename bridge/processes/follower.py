"""A twin beside a rig as a process: commands, measurements and events off the bus, estimates on the bus.

Zenoh's thread only keeps what comes; the filter works in ours, at its own pace: the loop never waits for it.
"""

import queue
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from bridge.errors import RunError
from bridge.loop.follower import FollowerSide, Told, warm_up
from bridge.loop.health import watching
from bridge.machine.narrator import Narrator
from bridge.machine.priority import stand_back
from bridge.machine.process import Stop
from bridge.processes.contact import Contact
from bridge.scenario import changed
from bridge.scenario.untrusted import parsed_json
from bridge.wire.bus import Bus, stamp_of
from bridge.wire.codec import decode, ready
from bridge.wire.health import PLACES
from bridge.wire.limits import WAITING_RECORDS, Excess
from bridge.wire.link import Link
from bridge.wire.messages import ESTIMATE, GOING, HEALTH, INNOVATION, TOPICS, Mode, Outgoing, Phase
from bridge.wire.status import PUBLISHED, TURNED, Reading, counted, numbers_of
from controller.grid import NS
from twin.estimation.filter import Estimate
from twin.estimation.health import Health, Rules
from twin.estimation.quantities import Standing
from twin.estimation.settings import Settings

ROLE = "follower"
HEARD = ("command", "measurement", "event", "status")
STATUS_PERIOD = 0.5  # [s] of wall time


def told_by(status: Any) -> Told | None:
    """What a plant says of itself by a status; None for that of another process, or a last word."""
    reading = Reading.from_plain(numbers_of(status)) if status.role == "plant" and status.phase in GOING else None
    if reading is None:
        return None
    return Told(status.stamp, status.phase in (Phase.SAFE, Phase.LATCHED), reading.spool)


class FollowerReport(NamedTuple):
    """How a follower has done."""

    latest: Estimate | None
    health: Health | None
    estimates: int
    restarts: int
    processor_share: float  # of one core
    longest_lag: float  # [s] of simulated time that it was behind the newest scan


class FollowerProcess:
    """One follower of one rig, for as long as its plant runs."""

    def __init__(self, bus: Bus, side: FollowerSide, stop: Callable[[], bool], quiet: bool = False) -> None:
        self.bus, self.side, self.stop = bus, side, stop
        self._narrator = Narrator(quiet)
        self._inbox: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        self._newest, self._arrived, self._longest_lag = -1, -1, 0  # scan taken, scan that has come; [ns]
        self._standing = Standing.WAITING
        self._said = 0  # of the verdicts on its health
        self._status_due = 0.0
        self._tick = -1
        self._began = time.process_time(), time.monotonic()
        ready(*HEARD, ESTIMATE, INNOVATION, HEALTH)
        for topic in HEARD:
            bus.subscribe(topic, lambda sample, topic=topic: self._keep(topic, sample))
        bus.watch()
        self._contact = Contact(bus)
        bus.announce()

    def run(self) -> FollowerReport:
        """Follow until the plant has ended. Raises RunError when it is lost."""
        self._narrator.say(f"follower of rig {self.bus.rig_name!r}, {self.bus.place}: {self.side.scenario.name!r}")
        try:
            while not self.stop() and not self._finished():
                with suppress(queue.Empty):
                    self.take(*self._inbox.get(timeout=0.02))
                self._report_when_due()
        finally:
            self._publish(self.side.finish())
            counts = counted(PUBLISHED, self.side.published) | counted(TURNED, self.bus.turned.counts())
            self.bus.publish_status(self.side.run_id, max(0, self.side.now), Phase.ENDED, counts, final=True)
            self._narrator.close()
        return self._words()

    def _keep(self, topic: str, sample: Any) -> None:
        """In Zenoh's thread."""
        if topic == "measurement" and (stamp := stamp_of(sample)) is not None:
            self._arrived = stamp[0]
        if self._inbox.qsize() < WAITING_RECORDS:
            self._inbox.put((topic, sample.payload.to_bytes()))
        else:
            self.bus.turned.add(topic, Excess.WAITING)

    def take(self, topic: str, payload: bytes) -> None:
        """A message, in our thread."""
        try:
            message = decode(payload, topic)
        except ValueError:
            self.bus.turned.add(topic, Excess.UNREADABLE)  # somebody else's noise on our keys
            return
        if topic == "status":
            self._contact.heed(message)
            if told := told_by(message):
                self.side.learn(told)
        elif topic == "event":
            self.side.heed(message)
        elif topic == "command":
            self._publish(self.side.take(message))
        else:
            self._tick, self._newest = message.tick, message.stamp
            self._publish(self.side.hear(message))
            self._longest_lag = max(self._longest_lag, self.behind)

    def _publish(self, messages: list[Outgoing]) -> None:
        for message in messages:
            self.bus.publish(message)
        if self.side.latest is not None and self.side.latest.standing != self._standing:
            self._standing = self.side.latest.standing
            self._narrator.say(f"t = {self.side.latest.stamp:g} s: {self._standing.name.lower()}")
        if self.side.health is not None:
            for words in self.side.health.told[self._said :]:
                self._narrator.say(words)
            self._said = len(self.side.health.told)

    def _finished(self) -> bool:
        done = self._tick if self._inbox.empty() else -1
        return self._contact.over(done, f"t = {max(0, self._newest) / NS:g} s")

    def _report_when_due(self) -> None:
        if time.monotonic() < self._status_due:
            return
        self._status_due = time.monotonic() + STATUS_PERIOD
        own = {"standing": float(self._standing), "restarts": float(max(0, self.side.restarts))}
        own |= {"lag": self.behind / NS}
        own["processor_share"] = self._share()
        if self.side.health is not None:
            own |= {"verdict": float(self.side.health.latest.verdict), "first": float(self._suspect())}
        self.bus.publish_status(self.side.run_id, max(0, self.side.now), Phase.RUNNING, own)

    def _suspect(self) -> int:
        """The place of the likeliest fault in the health message's table; -1 none."""
        suspects = self.side.health.latest.suspects if self.side.health is not None else ()
        return PLACES.index(suspects[0]) if suspects else -1

    @property
    def behind(self) -> int:
        """How far the estimate is behind the newest scan that has come, those that wait for us included [ns]."""
        return max(0, max(self._newest, self._arrived) - self.side.now) if self.side.now >= 0 else 0

    def _share(self) -> float:
        worked, took = time.process_time() - self._began[0], time.monotonic() - self._began[1]
        return worked / took if took > 0.0 else 0.0

    def _words(self) -> FollowerReport:
        lag = self._longest_lag / NS
        estimates = self.side.published[ESTIMATE]
        health = None if self.side.health is None else self.side.health.latest
        return FollowerReport(self.side.latest, health, estimates, max(0, self.side.restarts), self._share(), lag)


def run_follower(
    rig: str,
    link: Link,
    mode: Mode,
    changes: list[str],
    settings: Settings,
    rules: Rules | None = None,
    quiet: bool = False,
) -> FollowerReport:
    """Follow a rig until its plant ends. Raises RunError, LinkError or UsageError with one line for people."""
    assert TOPICS[ESTIMATE].publisher == ROLE
    stop = Stop()
    stand_back()
    with Bus(link, rig, ROLE, blocking=mode == Mode.LOCKSTEP) as bus:
        told = bus.ask("scenario", link.patience, stop.listen())
        if told is None:
            raise RunError(f"no plant of rig {rig!r} answers: start one first, or name its address with --connect")
        try:
            scenario = changed(parsed_json(told)["scenario"], changes, f"the scenario of rig {rig!r}")
        except (KeyError, TypeError, ValueError) as error:
            raise RunError(f"the plant of rig {rig!r} answers with no scenario: {error}") from None
        known = settings if rules is None else watching(settings)
        warm_up(scenario, known, rules)
        side = FollowerSide(scenario, known, rules=rules)
        return FollowerProcess(bus, side, stop.listen(), quiet).run()
