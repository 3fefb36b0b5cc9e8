"""Where commands enter the plant: taken or refused, held until the next one acts, the safe state when none comes.

Nothing here knows clocks or networks: times are simulated nanoseconds that the plant hands in.
"""

import copy
import math
from collections.abc import Callable
from typing import Any, NamedTuple

from bridge.loop.alarm_watch import AlarmWatch, Turn
from bridge.loop.refuge import CENTRED, Refuge
from bridge.loop.safety import Gaps, Gate, Objection, Watchdog
from bridge.loop.safety_states import SafetyStates
from bridge.scenario import Scenario
from bridge.scenario.safety import planned, value_in_words
from bridge.wire.events import NO_MORE_TOLD, absence, reason_of, refusal
from bridge.wire.messages import EventKind, Reason, SafetyState
from controller.grid import NS, next_sample, to_ns
from controller.hold import Hold, Segment

POSITION = "measurement.position"  # what a retreat looks at
EVENTS_PER_REASON = 100  # refusals of one kind that are recorded one by one; all are counted


class Note(NamedTuple):
    """What an event says in addition to its run and stamp."""

    kind: EventKind
    text: str
    source: int = 0  # of the command it is about
    command: int = 0  # its sequence
    apply_at: int = 0  # [ns]
    applied_at: int = 0  # [ns]


class Inlet:
    """Gate, watchdog, alarms and zero-order hold of one run of a plant."""

    def __init__(self, scenario: Scenario, run_id: int) -> None:
        loop = scenario.loop
        self._grid = grid = loop.grid()
        self.late = 0
        self.worst_lateness = 0
        self._gate = Gate(run_id, grid)
        self._watchdog = Watchdog(to_ns(loop.command_timeout), grid, loop.after_timeout == "latch")
        self._hold = Hold(CENTRED)
        self._states = SafetyStates()
        self._refuge = Refuge(scenario, self._hold)
        self._alarms = {alarm.number: alarm for alarm in planned(scenario)}
        self._alarm_watch = AlarmWatch(list(self._alarms.values()))
        self._limit = scenario.safety.degraded_limit
        self._kept_out = False  # it is told that an alarm keeps commands out
        self._awaited = False  # no alarm keeps the plant safe any more: commands are due again
        self._believed = False  # the plant itself said that it is safe
        self._first_due = next_sample(0, grid) + grid.delay  # of a controller that has not spoken yet [ns]
        self._gaps = Gaps()
        self._notes: list[Note] = []

    @property
    def value(self) -> float:
        """The spool reference in force."""
        return self._limited(self._hold.value)

    @property
    def state(self) -> SafetyState:
        """How far the plant trusts its loop."""
        return self._states.state

    @property
    def safe(self) -> bool:
        """Do commands not act, since the plant is in its safe state?"""
        return self._states.safe

    @property
    def believed(self) -> bool:
        """Is it safe because the plant itself said so?"""
        return self._believed

    @property
    def limit(self) -> float:
        """How far commands act, of the spool's travel; 1 and more: as they are."""
        return self._limit if self.state == SafetyState.DEGRADED else 1.0

    @property
    def latched(self) -> bool:
        """Does it take a reset to leave it?"""
        return self.state == SafetyState.LATCHED

    @property
    def shut(self) -> bool:
        """Are valid commands refused, until a reset or until an alarm is gone?"""
        return self._states.shut

    @property
    def in_force(self) -> bool:
        """Does a command act, or has one acted?"""
        return self._hold.since >= 0

    @property
    def prompt(self) -> bool:
        """Must a command be heard at its sample, since it may be refused for what has happened by then?"""
        return bool(self._alarms)

    @property
    def safe_states(self) -> int:
        """How often the plant went to its safe state."""
        return self._states.trips

    @property
    def accepted(self) -> int:
        """Commands that were taken."""
        return self._gate.accepted

    @property
    def refused(self) -> dict[Reason, int]:
        """Commands that were refused, by reason."""
        return self._gate.refused

    @property
    def answered(self) -> int:
        """Stamp of the last sample that was answered, by a command that was taken or by a bad one [ns]; -1 before."""
        return self._gate.answered

    def offer(self, command: Any, now: int) -> bool:
        """Take a command; False when it is refused."""
        refused = self._gate.check(command, now, self._objection(command, now))
        if refused is not None:
            if self._note_refusal(*refused, command.source, command.sequence, command.apply_at):
                self._gaps.refuse(command.source, command.sequence, refused[0])
            return False
        if gap := self._gaps.accept(command):
            self.note(EventKind.MISSED, absence(*gap), command.source, command.sequence, command.apply_at)
        if self.safe:
            self.note(EventKind.RESUMED, "commands have resumed", command.source, command.sequence)
            self._leave()
        self._refuge.give_way(command.apply_at)
        if command.apply_at < now:
            self._note_late(command, now)
        self._hold.put(command.apply_at, command.spool)
        return True

    def note_answer(self, command: Any, now: int) -> None:
        """A command has come, whatever becomes of it: its sample has its answer."""
        self._gate.note_answer(command, now)

    def lose(self, command: Any) -> None:
        """A fault of the link has kept a command away, which everybody knows."""
        self._gaps.lose(command.source, command.sequence)

    def refuse(self, reason: Reason, text: str) -> None:
        """Count and note what is not a command at all."""
        self._note_refusal(*self._gate.refuse(reason, text))

    def retell(self, refusal: Any) -> None:
        """Count and note a refusal that has been told before, by its event."""
        reason, told = Reason(reason_of(refusal)), refusal.text
        self._gate.refuse(reason, told)
        self._gaps.refuse(refusal.source, refusal.command, reason)
        self.note(EventKind.REFUSED, told, refusal.source, refusal.command, refusal.apply_at)

    def reset(self, now: int) -> None:
        """Leave the safe state because somebody says so."""
        if self.safe:
            self._gate.release(now)
            self._first_due = next_sample(now, self._grid) + self._grid.delay
            self.note(EventKind.RESET, "safe state left by reset")
            self._leave()

    def believe(self, is_safe: bool, spool: float, now: int) -> bool:
        """Take over from the plant itself that commands do not act [ns], and what does; is it news?

        For one that has joined in the middle and has not heard what led there. It ends as the plant says.
        """
        if not is_safe:
            if self._believed:
                self.reset(now)
            return False
        news = not self.safe
        if news:
            self._gate.release(now)
            self._states.trip(latched=True)
            self._believed = True
        if self._believed and self._hold.value != spool:
            self._hold.put(now, spool)
        return news

    def segments(self, begin: int, end: int) -> list[Segment]:
        """The values in force over [begin, end), the block that is integrated now."""
        self._watch(begin, end)
        segments = list(self._hold.segments(begin, end))
        if not self.safe:  # a stair of a ramp is not a command
            self._gate.in_force = max(self._gate.in_force, self._hold.since)
        return [segment._replace(value=self._limited(segment.value)) for segment in segments]

    def held(self) -> Hold:
        """A copy of what is in force and what is to follow."""
        return copy.deepcopy(self._hold)

    def look(self, now: int, signal: Callable[[str], float]) -> None:
        """After a scan [ns]: take note of alarms that come and go, and end a retreat."""
        for turn in self._alarm_watch.look(now, signal):
            (self._come if turn.there else self._go)(turn, now)
        if self._refuge.retreating:
            self.watch_position(now, signal(POSITION))

    def turn(self, number: int, there: bool, now: int) -> None:
        """Somebody else has looked: an alarm has come [ns], or is gone."""
        alarm = self._alarms.get(number)
        if alarm is not None and self._states.knows(number) != there:
            (self._come if there else self._go)(Turn(alarm, there, math.nan), now)

    def watch_position(self, now: int, position: float) -> None:
        """After a scan [ns, m]: end a retreat."""
        if self._refuge.retreating:
            self._refuge.look(now, position)

    def notes(self) -> list[Note]:
        """What has happened since the last call."""
        notes, self._notes = self._notes, []
        return notes

    def _come(self, turn: Turn, now: int) -> None:
        """An alarm has come."""
        alarm, owned, was_shut = turn.alarm, self._gate.owner is not None, self.shut
        kind = self._states.come(alarm.number, alarm.then)
        goes = ""
        if kind == EventKind.SAFE:
            self._refuge.take(now)
            self._gate.in_force = now
            goes = f": {self._refuge.words(owned)}"
        if self.shut and not was_shut:
            self._awaited = self._kept_out = False
        until = ", until reset" if kind in (EventKind.SAFE, EventKind.LATCHED) and self.latched else ""
        text = f"alarm {alarm.id}: {alarm.words}, {value_in_words(turn.value, alarm.unit)}{goes}{until}"
        self.note(kind, text, command=alarm.number, applied_at=now)

    def _go(self, turn: Turn, now: int) -> None:
        """An alarm is gone."""
        alarm, was_shut = turn.alarm, self.shut
        kind = self._states.go(alarm.number)
        follows = ""
        if was_shut and not self.shut:
            self._awaited, self._first_due = True, next_sample(now, self._grid) + self._grid.delay
            follows = "; the next valid command acts"
        text = f"alarm {alarm.id} is gone: {value_in_words(turn.value, alarm.unit)}{follows}"
        self.note(kind, text, command=alarm.number, applied_at=now)

    def _leave(self) -> None:
        """Leave the safe state; alarms that are still there degrade the plant."""
        self._awaited = self._believed = False
        if still := self._states.leave():
            names = ", ".join(self._alarms[number].id for number in still)
            self.note(EventKind.DEGRADED, f"still there: alarm {names}")

    def _objection(self, command: Any, now: int) -> Objection | None:
        """Why a command is not taken now, whatever it says; None where one can be."""
        if not self.shut:
            return self._too_old(command, now)
        if self.latched:
            return Reason.LATCHED, "the plant is in its safe state until reset"
        names = ", ".join(self._alarms[number].id for number in self._states.keeping)
        return Reason.ALARM, f"the plant is in its safe state until alarm {names} is gone"

    def _too_old(self, command: Any, now: int) -> Objection | None:
        """What a safe plant gets from a link that was cut: an answer that tells nothing of a controller that is back.

        It is too old where silence since then would make the plant safe. Whoever speaks first of all is heard.
        """
        due = command.sample_stamp + self._grid.delay + self._grid.sample
        if not self.safe or not self._gate.accepted or now < self._watchdog.trip_at(due):
            return None
        behind, timeout = (now - command.sample_stamp) / NS, self._watchdog.timeout / NS
        return Reason.STALE, f"answer to a sample of {behind:g} s ago, longer than the time-out of {timeout:g} s"

    def _limited(self, value: float) -> float:
        return value if (limit := self.limit) >= 1.0 else max(-limit, min(limit, value))

    def _watch(self, begin: int, end: int) -> None:
        if self.safe and not self._awaited:
            return
        owned = self._gate.owner is not None
        spoken = owned and not self.safe
        at = self._watchdog.trip_at(self._gate.last_apply + self._grid.sample if spoken else self._first_due)
        if at >= end:
            return
        at = max(at, begin)
        if self.safe:
            self._give_up(at, owned)
            return
        self._states.trip(self._watchdog.latching and owned)
        if owned or self._refuge.moves_alone:
            self._gate.release(at)
            self._refuge.take(at)
        timeout = self._watchdog.timeout / NS
        missed = f"for {timeout:g} s" if owned else f"within {timeout:g} s of the first that was due"
        text = f"no {'' if owned else 'valid '}command {missed}: {self._refuge.words(owned)}"
        self.note(EventKind.SAFE, text, applied_at=at)

    def _give_up(self, at: int, owned: bool) -> None:
        """Nobody commands though no alarm keeps the plant safe: it belongs to nobody any more."""
        self._awaited = False
        self._gate.release(at)
        if self._watchdog.latching and owned:
            self._states.latch()
            timeout = self._watchdog.timeout / NS
            self.note(EventKind.LATCHED, f"no command for {timeout:g} s though the alarm is gone", applied_at=at)

    def note(
        self, kind: EventKind, text: str, source: int = 0, command: int = 0, apply_at: int = 0, applied_at: int = 0
    ) -> None:
        """Keep what has happened until it is asked for."""
        self._notes.append(Note(kind, text, source, command, apply_at, applied_at))

    def _note_late(self, command: Any, now: int) -> None:
        self.late += 1
        behind = now - command.apply_at
        self.worst_lateness = max(self.worst_lateness, behind)
        text = f"acted {behind / 1e6:g} ms late"
        self.note(EventKind.LATE, text, command.source, command.sequence, command.apply_at, now)

    def _note_refusal(self, reason: Reason, text: str, source: int = 0, sequence: int = 0, apply_at: int = 0) -> bool:
        """False when it is only counted."""
        count = self.refused[reason]
        if count > EVENTS_PER_REASON or (reason == Reason.ALARM and self._kept_out):
            return False
        self._kept_out = reason == Reason.ALARM
        last = NO_MORE_TOLD if count == EVENTS_PER_REASON or self._kept_out else ""
        self.note(EventKind.REFUSED, refusal(reason, f"{text}{last}"), source, sequence, apply_at)
        return True
