"""Where commands enter the plant: taken or refused, held until the next one acts, the safe state when none comes.

Nothing here knows clocks or networks: times are simulated nanoseconds that the plant hands in.
"""

from typing import Any, NamedTuple

from bridge.loop.safety import Gaps, Gate, Watchdog
from bridge.scenario import Scenario
from bridge.scenario.fitted_valve import power_off_of
from bridge.wire.events import absence, refusal
from bridge.wire.messages import EventKind, Reason
from controller.grid import NS, next_sample, to_ns
from controller.hold import Hold, Segment

CENTRED = 0.0  # spool reference until somebody speaks
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
    """Gate, watchdog and zero-order hold of one run of a plant."""

    def __init__(self, scenario: Scenario, run_id: int) -> None:
        loop = scenario.loop
        self._grid = grid = loop.grid()
        self.late = 0
        self.worst_lateness = 0
        self._gate = Gate(run_id, grid)
        self._watchdog = Watchdog(to_ns(loop.command_timeout), grid, loop.after_timeout == "latch")
        self._hold = Hold(CENTRED)
        self._power_off = power_off_of(scenario)
        self._first_due = next_sample(0, grid) + grid.delay  # of a controller that has not spoken yet [ns]
        self._gaps = Gaps()
        self._notes: list[Note] = []

    @property
    def value(self) -> float:
        """The spool reference in force."""
        return self._hold.value

    @property
    def safe(self) -> bool:
        """Is the plant in its safe state?"""
        return self._watchdog.safe

    @property
    def latched(self) -> bool:
        """Does it take a reset to leave it?"""
        return self._watchdog.blocks()

    @property
    def safe_states(self) -> int:
        """How often the plant went to its safe state."""
        return self._watchdog.trips

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
        refused = self._gate.check(command, now, self._watchdog.blocks())
        if refused is not None:
            if self._note_refusal(*refused, command.source, command.sequence, command.apply_at):
                self._gaps.refuse(command, refused[0])
            return False
        if gap := self._gaps.accept(command):
            self.note(EventKind.MISSED, absence(*gap), command.source, command.sequence, command.apply_at)
        if self.safe:
            self._watchdog.clear()
            self.note(EventKind.RESUMED, "commands have resumed", command.source, command.sequence)
        if command.apply_at < now:
            self._note_late(command, now)
        self._hold.put(command.apply_at, command.spool)
        return True

    def refuse(self, reason: Reason, text: str) -> None:
        """Count and note what is not a command at all."""
        self._note_refusal(*self._gate.refuse(reason, text))

    def reset(self, now: int) -> None:
        """Leave the safe state because somebody says so."""
        if self.safe:
            self._watchdog.clear()
            self._gate.release(now)
            self._first_due = next_sample(now, self._grid) + self._grid.delay
            self.note(EventKind.RESET, "safe state left by reset")

    def segments(self, begin: int, end: int) -> list[Segment]:
        """The values in force over [begin, end), the block that is integrated now."""
        self._watch(begin, end)
        segments = list(self._hold.segments(begin, end))
        self._gate.in_force = max(self._gate.in_force, self._hold.since)
        return segments

    def notes(self) -> list[Note]:
        """What has happened since the last call."""
        notes, self._notes = self._notes, []
        return notes

    def _watch(self, begin: int, end: int) -> None:
        if self.safe:
            return
        owned = self._gate.owner is not None
        at = self._watchdog.trip_at(self._gate.last_apply + self._grid.sample if owned else self._first_due)
        if at >= end:
            return
        at, timeout = max(at, begin), self._watchdog.timeout / NS
        self._watchdog.trip(owned)
        if owned or self._power_off != CENTRED:
            self._gate.release(at)
            self._hold.put(at, self._power_off)
        stays = "valve centred" if owned else "the valve stays centred"  # so whoever speaks first will be heard
        goes = stays if self._power_off == CENTRED else f"valve without power, spool to {self._power_off:g}"
        missed = f"for {timeout:g} s" if owned else f"within {timeout:g} s of the first that was due"
        text = f"no {'' if owned else 'valid '}command {missed}: {goes}"
        self.note(EventKind.SAFE, text, applied_at=at)

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
        if count > EVENTS_PER_REASON:
            return False
        last = "; more of these are only counted" if count == EVENTS_PER_REASON else ""
        self.note(EventKind.REFUSED, refusal(reason, f"{text}{last}"), source, sequence, apply_at)
        return True
