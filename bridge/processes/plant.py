"""The plant as a process: connect, pace, and let the plant side do the rest."""

import json
import os
import queue
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, NamedTuple

from bridge.errors import RunError, ScenarioError
from bridge.loop.plant import PlantSide
from bridge.loop.plant_tuning import refuse_impossible
from bridge.machine.clock import Overruns, ticks
from bridge.machine.host import host, versions
from bridge.machine.narrator import Narrator
from bridge.machine.priority import Priority, take
from bridge.machine.process import Stop, prepare
from bridge.machine.refusals import count_refusals
from bridge.processes.failing import faults_of_processes, refuse_processes
from bridge.processes.injection import injected_by
from bridge.processes.late_ticks import stop_where_late
from bridge.processes.orders import Act, Order, answer_to
from bridge.processes.parameters import listed, set_by, target_of
from bridge.processes.starting import EAR
from bridge.processes.strangers import Strangers, second_plant
from bridge.processes.telling import Telling
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.law_file import law_facts
from bridge.scenario.references import Live
from bridge.scenario.sameness import digest_of
from bridge.wire.bus import Bus, claimed_type
from bridge.wire.codec import LoopTiming, ready
from bridge.wire.events import last_words
from bridge.wire.intake import Turned, Waiting
from bridge.wire.limits import WAITING_COMMANDS, WAITING_TARGETS, command_rate
from bridge.wire.link import Link, is_guarded
from bridge.wire.messages import Ending, EventKind, Mode, OnOverrun, Outgoing, Phase
from bridge.wire.status import Pace, PlantReport, PlantStatus
from controller.grid import NS, is_sample

STATUS_PERIOD = 100_000_000  # [ns] of wall time
SETTLING = 2.0  # seconds in which a plant that started at the same instant may still be found
UNANSWERED = 1000  # samples whose way out is remembered while no command answers them
FIRST_ANSWER = 2.0  # seconds for the first command of a controller that was waited for, before the clock starts
FIRST_LOOK = 0.0005  # seconds from look to look for it
LAST_ANSWER = 1.0  # seconds for an answer that nothing depends on
LINGER = 5.0  # seconds that partners get to finish
FOLLOWING = 60.0  # seconds that a follower gets: in lockstep it may be behind
LAST_PHASE = {
    Ending.COMPLETE: Phase.ENDED,
    Ending.INTERRUPTED: Phase.INTERRUPTED,
    Ending.FAILED: Phase.FAILED,
}


class PlantOptions(NamedTuple):
    """How a plant is run."""

    mode: Mode  # lockstep, realtime
    speed: float  # simulated over wall time
    priority: Priority
    run_id: int
    partners: tuple[str, ...]  # roles to wait for before the clock starts
    patience: float  # seconds to wait for them, and in lockstep for each command
    quiet: bool = False  # say nothing on the terminal


class Command(NamedTuple):
    """A sample off the wire and when it came [ns, monotonic]."""

    sample: Any
    came: int


class PlantProcess:
    """One run of a plant on a bus."""

    def __init__(self, bus: Bus, scenario: Scenario, options: PlantOptions) -> None:
        self.bus = bus
        self.scenario = scenario
        self.options = options
        self.stop = Stop()
        self.side = PlantSide(scenario, options.run_id)
        self.pace: Pace | None = None  # None before the first tick, and in lockstep
        self._commands = Waiting("command", bus.turned, WAITING_COMMANDS)
        self._sent: dict[int, int] = {}  # stamp of a sample -> when its measurement went out
        self._status_due = 0
        self._timings = 0
        granted = {"priority": take(options.priority, options.mode == Mode.REALTIME)}
        self._facts = {"versions": versions(), "host": host() | granted, **law_facts(scenario.controller)}
        self._narrator = Narrator(options.quiet)
        self._telling = Telling(self._narrator, is_live=isinstance(scenario.reference, Live))
        self._settled = 0.0
        self._strangers = Strangers(digest_of(scenario), bus.turned)
        ready("status")
        self.stop.listen()  # from here on somebody may know of this plant, and waits for its last word
        bus.subscribe("status", lambda sample: self._strangers.hear(sample.payload.to_bytes()))
        bus.answer("scenario", self._manifest)
        bus.serve("parameters", lambda payload: listed(self.side, payload))
        for name, asked in (("parameters/set", set_by), ("fault", injected_by)):
            bus.serve(name, lambda payload, asked=asked: self._answer(payload, asked))
        ready("command")
        rate = command_rate(scenario.loop.sample_period, options.speed)
        bus.subscribe("command", self._on_command, rate)
        self._targets = Waiting("target", bus.turned, WAITING_TARGETS)
        if isinstance(scenario.reference, Live):
            bus.subscribe("target", lambda sample: self._targets.put(sample.payload.to_bytes()))
        bus.subscribe("reset", lambda *_: self._commands.put(None))
        bus.watch()
        bus.announce()

    def run(self) -> Ending:
        """Run to the end; returns what ended it. Raises RunError when a partner does not come or does not answer."""
        who = f"plant of rig {self.bus.rig_name!r}, {self.bus.place}: scenario {self.scenario.name!r}"
        self._narrator.say(f"{who}, priority {self._facts['host']['priority']}")
        missing = self.bus.await_roles(self.options.partners, self.options.patience, self.stop)
        if missing and not self.stop():
            raise RunError(f"no {' and no '.join(missing)} within {self.options.patience:g} s of the start")
        self._settled = time.monotonic() + SETTLING
        self._leave_to_another()
        if self.options.mode == Mode.LOCKSTEP:
            self._lockstep()
        else:
            self._real_time()
        return Ending.INTERRUPTED if self.side.tick_number < self.scenario.ticks else Ending.COMPLETE

    def close(
        self, ending: Ending, reason: str = "", partners: tuple[str, ...] = ("controller", "recorder")
    ) -> PlantReport:
        """Say the last words and stay until the partners have left: their messages pass through here."""
        for message in self.side.finish(last_words(ending, self.side.tick_number, reason)):
            self.bus.publish(message)
        phase = LAST_PHASE[ending]
        status = self._report(phase, reason, final=True)
        self.bus.await_leaving(("follower",), FOLLOWING)
        self.bus.await_leaving(partners, LINGER)
        self._narrator.close()
        return PlantReport(status, phase, reason)

    def _lockstep(self) -> None:
        self._publish(self.side.start())
        while self.side.tick_number < self.scenario.ticks and not self.stop():
            if self._await_command():
                self._aim()
                self._publish(self.side.tick())
            self._report_when_due(time.monotonic_ns())
        self._take_last()

    def _take_last(self) -> None:
        """Hear the answer to the last sample, too: it acts no more, but it may be one to refuse."""
        deadline = time.monotonic() + LAST_ANSWER
        while self.side.unanswered() and time.monotonic() < deadline and not self.stop():
            with suppress(queue.Empty):
                self._handle(self._commands.get(timeout=0.1))

    def _await_command(self) -> bool:
        """Before it integrates past an `apply_at` the plant has that command, or says whose fault it is.

        False when somebody has stopped the run meanwhile.
        """
        deadline = time.monotonic() + self.options.patience
        while (stamp := self.side.awaited()) is not None:
            if self.stop():
                return False
            if time.monotonic() > deadline:
                raise RunError(self._silence(stamp))
            with suppress(queue.Empty):
                self._handle(self._commands.get(timeout=0.1))
        return True

    def _silence(self, stamp: int) -> str:
        refused = sum(self.side.inlet.refused.values())
        reasons = ", ".join(f"{count} {reason}" for reason, count in self.side.inlet.refused.items())
        also = f"; {refused} commands were refused: {reasons}" if refused else ""
        return (
            f"the controller has not answered the measurement of tick {stamp // self.side.grid.daq} "
            f"(t = {stamp / NS:g} s) within {self.options.patience:g} s{also}"
        )

    def _real_time(self) -> None:
        period = self.side.grid.daq / self.options.speed
        policy = self.scenario.real_time
        overruns = Overruns(period, policy.grace * NS)
        self._publish(self.side.start(), time.monotonic_ns())
        self._await_first_answer()
        latest = 0
        for tick in ticks(period, skip=policy.on_overrun == OnOverrun.SKIP):
            trip, slack = self._take_commands(tick.due, period)
            self._aim()
            self._publish(self.side.tick(), time.monotonic_ns())
            overruns.add(tick.lateness, tick.number * period)
            latest = max(latest, tick.lateness)
            now = time.monotonic_ns()
            self._time(tick.lateness, now - tick.due - tick.lateness, trip, slack)
            worst, burst = overruns.worst / NS, overruns.burst
            self.pace = Pace(overruns.count, worst, burst, latest / NS, trip / NS, overruns.ticks, tick.skipped)
            stop_where_late(overruns, self.scenario)
            if self._report_when_due(now):
                latest = 0
            if tick.number >= self.scenario.ticks or self.stop():
                return

    def _await_first_answer(self) -> None:
        """Start the clock once the loop is closed: a controller's first answer takes longest, it compiles or loads."""
        deadline = time.monotonic() + FIRST_ANSWER
        if "controller" in self.options.partners and is_sample(0, self.side.grid):
            while self._commands.empty() and time.monotonic() < deadline and not self.stop():
                time.sleep(FIRST_LOOK)

    def _take_commands(self, due: int, period: float) -> tuple[int, int]:
        """Take all that has come; the newest round trip and how early it was [ns], -1 and 0 without one."""
        trip, slack = -1, 0
        for command in self._arrived():
            taken = self._handle(command)
            if taken is not None and isinstance(command, Command) and taken.sample_stamp in self._sent:
                trip = command.came - self._sent.pop(taken.sample_stamp)
                blocks_ahead = (taken.apply_at - self.side.now) // self.side.grid.daq
                slack = due + round(blocks_ahead * period) - command.came
        return trip, slack

    def _arrived(self) -> Iterator[Command | Order | None]:
        while True:
            try:
                yield self._commands.get_nowait()
            except queue.Empty:
                return

    def _answer(self, payload: bytes, asked: Callable[[bytes, Scenario], Act]) -> bytes:
        """In Zenoh's thread: the answer to what somebody asks of the loop."""
        return answer_to(payload, lambda payload: asked(payload, self.scenario), self._commands.put)

    def _handle(self, command: Command | Order | None) -> Any:
        if isinstance(command, Order):
            command.take(self.side)
            return None
        if command is None:
            self.side.reset()
            return None
        return self.side.receive(command.sample.payload.to_bytes(), claimed_type(command.sample))

    def _aim(self) -> None:
        """Hand the newest target of a live reference in."""
        target = None
        while not self._targets.empty():
            try:
                target = target_of(self._targets.get())
            except ValueError as error:
                self._narrator.say(f"target refused: {error}")
        self.side.aim(target)

    def _leave_to_another(self) -> None:
        """Of plants that started at the same instant, and did not see each other, only that of the lowest id stays."""
        if time.monotonic() > self._settled:
            return
        lower = [pid for pid in self.bus.present.get("plant", ()) if pid.isdigit() and int(pid) < os.getpid()]
        if lower:
            raise second_plant(self.scenario.rig_name, lower)

    def _on_command(self, sample: Any) -> None:
        self._commands.put(Command(sample, time.monotonic_ns()))

    def _publish(self, messages: list[Outgoing], sent: int = 0) -> None:
        for message in messages:
            self.bus.publish(message)
            if message.topic == "event":
                self._telling.tell(message.message, self.side.inlet)
        if sent and is_sample(self.side.now, self.side.grid):
            self._sent[self.side.now] = sent
            if len(self._sent) > UNANSWERED:
                del self._sent[next(iter(self._sent))]

    def _time(self, lateness: int, cost: int, trip: int, slack: int) -> None:
        side = self.side
        timing = LoopTiming(
            run_id=side.run_id,
            sequence=self._timings,
            tick=side.tick_number,
            stamp=side.now,
            lateness=lateness,
            cost=cost,
            round_trip=trip,
            slack=slack,
        )
        self.bus.publish(Outgoing("timing", side.now, self._timings, timing))
        self._timings += 1

    def _report_when_due(self, now: int) -> bool:
        if now < self._status_due:
            return False
        self._status_due = now + STATUS_PERIOD
        self._leave_to_another()
        for words in self._strangers.new():
            self.side.inlet.note(EventKind.DIFFERS, words)
        self._narrator.note_present(self.bus.present, "plant")
        self._report(Phase(self.side.inlet.state), "")
        return True

    def _report(self, phase: Phase, text: str, final: bool = False) -> PlantStatus:
        status = self._status()
        if final:
            status = status._replace(published=self.side.published | {"timing": self._timings})
        self.bus.publish_status(self.side.run_id, self.side.now, phase, status.plain(), text, final)
        return status

    def _status(self) -> PlantStatus:
        return self.side.status()._replace(pace=self.pace, turned=self.bus.turned.counts())

    def _manifest(self) -> bytes:
        """What a recorder puts at the head of its file."""
        facts = {
            "run_id": str(self.side.run_id),
            "mode": self.options.mode,
            "speed": self.options.speed,
            "scenario": self.scenario.model_dump(mode="json"),
            "tick": self.side.tick_number,
            "changed": self.side.said,
            **self._facts,
        }
        return json.dumps(facts).encode()


def run_plant(scenario: Scenario, link: Link, options: PlantOptions) -> PlantReport:
    """Run a plant to its end; returns its last words. Raises RunError or LinkError with one line for people."""
    circuit_of(scenario)  # refused before anybody is told of it
    refuse_impossible(scenario)
    refuse_processes(scenario, options.mode)
    if options.mode == Mode.REALTIME and EAR not in options.partners and (alone := [*faults_of_processes(scenario)]):
        raise ScenarioError(f"fault {alone[0]!r}: only `hydrotwin run` starts the processes that are to fail")
    prepare()
    turned = Turned()
    if link.listen and link.config and is_guarded(link.config):
        count_refusals(turned)
    blocking = options.mode == Mode.LOCKSTEP
    with Bus(link, scenario.rig_name, "plant", blocking, turned=turned) as bus:
        if others := bus.others("plant"):
            raise second_plant(scenario.rig_name, others)
        process = PlantProcess(bus, scenario, options)
        try:
            ending = process.run()
        except RunError as failure:
            process.close(Ending.FAILED, str(failure), partners=("recorder",))
            raise
        return process.close(ending)
