"""The controller as a process: measurements off the bus, through the law, commands on the bus."""

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from bridge.errors import RunError
from bridge.loop.controller import ControllerSide
from bridge.machine.narrator import Narrator
from bridge.machine.priority import Priority, take
from bridge.machine.process import Stop, prepare
from bridge.processes.contact import Contact
from bridge.scenario import Scenario
from bridge.scenario.sameness import DIGEST, difference, digest_of
from bridge.scenario.untrusted import parsed_json
from bridge.wire.bus import Bus, Receiver
from bridge.wire.codec import decode, ready
from bridge.wire.events import line_of_law, reason_of
from bridge.wire.limits import Excess
from bridge.wire.link import Link
from bridge.wire.messages import ALARMING, CHANNELS_TOPIC, EventKind, Mode, Outgoing, Phase, Reason
from bridge.wire.status import PUBLISHED, TURNED, counted
from controller.grid import NS

TOLD_OF_PLANT = (EventKind.SAFE, EventKind.RESET, EventKind.RESUMED, EventKind.CHANGED, EventKind.FAULT, *ALARMING)
ASKING = 2.0  # seconds for the plant to say what it runs


class ControllerProcess:
    """One controller of one rig, for as long as its plant runs.

    Commands are computed in Zenoh's own thread, as measurements come in: waking another one first would cost as much
    as all the rest.
    """

    def __init__(self, bus: Bus, side: ControllerSide, stop: Stop, scenario: Scenario, quiet: bool = False) -> None:
        self.bus = bus
        self._scenario = scenario
        self._narrator = Narrator(quiet)
        self._introduced: int | None = None  # the run whose plant knows what we run
        self._told: set[str] = set()  # reasons of refusals that were said on the terminal
        self.side = side
        self.stop = stop
        self._tick, self._stamp, self._run_id = -1, 0, 0
        self._fault: Exception | None = None
        self._waiting: Any = None  # the measurement of which the law needs more that has not come yet
        self._contact = Contact(bus)
        heeded = [("measurement", self._answer), ("event", self._heed), ("status", self._contact.heed)]
        heeded += [("state", self._before(side.see))] if side.sees_truth else []
        heeded += [(CHANNELS_TOPIC, self._before(side.hear))] if side.reads_channels else []
        for topic, heed in heeded:
            ready(topic)
            bus.subscribe(topic, self._guarded(topic, heed))
        bus.watch()
        bus.announce()

    def run(self, priority: str) -> None:
        """Answer until the plant has ended. Raises what the law raised, RunError when refused or the plant is lost.

        priority: in words, what the process was granted.
        """
        who = f"controller of rig {self.bus.rig_name!r}, {self.bus.place}"
        self._narrator.say(f"{who}: {self._scenario.name!r}, priority {priority}")
        while not self.stop() and not self._finished():
            time.sleep(0.02)
            if self._fault is not None:
                raise self._fault
            self._narrator.note_present(self.bus.present, "controller")
            if self._tick >= 0 and self._introduced != self._run_id:
                self._introduce(self._run_id)
        counts = counted(PUBLISHED, self.side.published) | counted(TURNED, self.bus.turned.counts())
        self.bus.publish_status(self._run_id, self._stamp, Phase.ENDED, counts, final=True)
        self._narrator.say("the plant has ended" if not self.stop() else "interrupted")
        self._narrator.close()

    def _introduce(self, run_id: int) -> None:
        """Tell the plant of a new run what we run, and people where that is not what the plant runs."""
        self._introduced = run_id
        told = self.bus.ask("scenario", ASKING, self.stop)
        with suppress(ValueError, KeyError, TypeError):  # a foreign plant's answer may be anything
            answer = parsed_json(told or b"{}")
            words = difference(self._scenario, answer["scenario"])
            for change in answer.get("changed", []):
                self.side.learn(change["text"], int(change["command"]), int(change["apply_at"]))
            if words:
                self._narrator.say(f"this controller runs {words}")
            digest = {DIGEST: float(digest_of(self._scenario))}
            self.bus.publish_status(run_id, self._stamp, Phase.RUNNING, digest, words)

    def _guarded(self, topic: str, heed: Callable[[Any], None]) -> Receiver:
        """Decode and heed; what goes wrong in Zenoh's thread is raised in ours."""

        def receive(sample: Any) -> None:
            try:
                message = decode(sample.payload.to_bytes(), topic)
            except ValueError:
                self.bus.turned.add(topic, Excess.UNREADABLE)  # somebody else's noise on our keys
                return
            try:
                heed(message)
            except Exception as error:
                self._publish(self.side.own.take())  # what the law has said before it failed
                self._fault = self._fault or error

        return receive

    def _before(self, take: Callable[[Any], None]) -> Callable[[Any], None]:
        """Take what the law needs of a tick, and answer where it has only waited for that."""

        def heed(message: Any) -> None:
            take(message)
            if self._waiting is not None and self._waiting.stamp == message.stamp:
                self._answer(self._waiting)

        return heed

    def _answer(self, measurement: Any) -> None:
        self._waiting = measurement if self.side.waits(measurement.stamp) else None
        if self._waiting is None:
            self._publish(self.side.answer(measurement))
        self._run_id, self._stamp, self._tick = measurement.run_id, measurement.stamp, measurement.tick

    def _publish(self, messages: list[Outgoing]) -> None:
        for message in messages:
            self.bus.publish(message)
            if message.topic == "said":
                self._narrator.say(line_of_law(message.message))

    def _heed(self, event: Any) -> None:
        self._publish(self.side.heed(event))
        if self._is_refused(event):
            self._fault = RunError(f"the plant refuses this controller: {event.text}")
        when = f"t = {event.stamp / NS:g} s: "
        if event.kind == EventKind.REFUSED and event.source == self.side.source:
            if (reason := reason_of(event)) not in self._told:
                self._told.add(reason)
                way_out = "; leave the safe state with `hydrotwin reset`" if reason == Reason.LATCHED else ""
                self._narrator.say(f"{when}the plant refuses our command: {event.text}{way_out}")
        elif event.kind in TOLD_OF_PLANT:
            self._narrator.say(f"{when}plant: {event.text}")

    def _is_refused(self, event: Any) -> bool:
        """Does the plant belong to another controller?"""
        ours = event.kind == EventKind.REFUSED and event.source == self.side.source
        return ours and reason_of(event) == Reason.SECOND_CONTROLLER

    def _finished(self) -> bool:
        return self._contact.over(self._tick, f"t = {self._stamp / NS:g} s")


def run_controller(
    scenario: Scenario, link: Link, mode: Mode, source: int, priority: Priority, quiet: bool = False
) -> None:
    """Run a controller until its plant ends. Raises RunError, LinkError or UsageError with one line for people."""
    side = ControllerSide(scenario, source)
    prepare()
    with Bus(link, scenario.rig_name, "controller", blocking=mode == Mode.LOCKSTEP) as bus:
        process = ControllerProcess(bus, side, Stop().listen(), scenario, quiet)
        process.run(take(priority, mode == Mode.REALTIME))
