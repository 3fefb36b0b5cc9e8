"""Which commands a plant takes, and what it does when they stop coming.

Nothing here knows clocks or networks: times are simulated nanoseconds that the plant hands in.
"""

import math
from typing import Any, NamedTuple

from bridge.wire.messages import Reason
from controller.grid import NS, Sampling

FURTHEST = 10 * NS  # an `apply_at` further ahead than this is refused


class Refusal(NamedTuple):
    """Why a command was not taken: the reason's name, to be counted, and a sentence for people."""

    reason: Reason
    text: str


Objection = tuple[Reason, str]
ANSWERS = (  # reasons to refuse what is an answer all the same
    *(Reason.NOT_FINITE, Reason.OUT_OF_RANGE, Reason.FAR_FUTURE, Reason.OFF_THE_GRID, Reason.LATCHED, Reason.ALARM),
)


class Gate:
    """Lets through the commands of one owner, in order; everything else is refused and counted."""

    def __init__(self, run_id: int, grid: Sampling) -> None:
        self.run_id = run_id
        self.grid = grid
        self.owner: int | None = None
        self.refused: dict[Reason, int] = {}
        self.accepted = 0
        self.last_sequence = -1
        self.last_sample = -1
        self.last_apply = -1
        self.answered = -1  # stamp of the last sample that was answered, well or badly [ns]
        self.in_force = -1  # since when the present value has acted [ns]

    def refuse(self, reason: Reason, text: str) -> Refusal:
        """Count a refusal."""
        self.refused[reason] = self.refused.get(reason, 0) + 1
        return Refusal(reason, text)

    def check(self, command: Any, now: int, shut: Objection | None = None) -> Refusal | None:
        """None when the command is taken; `now` is the simulated time reached [ns], `shut`: why none can be."""
        for test in (self._run, self._value, self._owner, self._time, self._order):
            refusal = shut if shut and test == self._order else test(command, now)
            if refusal is not None:
                if refusal[0] in ANSWERS:  # it is refused for what it says
                    self.note_answer(command, now)
                return self.refuse(*refusal)
        self.owner = command.source
        self.last_sequence, self.last_sample = command.sequence, command.sample_stamp
        self.last_apply = command.apply_at
        self.answered = max(self.answered, command.sample_stamp)
        self.accepted += 1
        return None

    def note_answer(self, command: Any, now: int) -> None:
        """The controller has answered a sample, whatever becomes of its command."""
        ours = self.owner is None or command.source == self.owner
        if ours and command.run_id == self.run_id and command.sample_stamp <= now:
            self.answered = max(self.answered, command.sample_stamp)

    def release(self, since: int) -> None:
        """Let anybody own the plant from an instant on [ns]; what was to act before it is of no use any more."""
        self.owner, self.last_sequence, self.last_sample, self.last_apply = None, -1, -1, -1
        self.in_force = since

    def _run(self, command: Any, now: int) -> Objection | None:
        if command.run_id != self.run_id:
            return Reason.FOREIGN_RUN, f"command for run {command.run_id}, this is run {self.run_id}"
        return None

    def _value(self, command: Any, now: int) -> Objection | None:
        if not math.isfinite(command.spool):
            return Reason.NOT_FINITE, f"spool reference {command.spool} is not a finite number"
        if abs(command.spool) > 1.0:
            return Reason.OUT_OF_RANGE, f"spool reference {command.spool:g} is outside -1 to 1"
        return None

    def _owner(self, command: Any, now: int) -> Objection | None:
        if self.owner is not None and command.source != self.owner:
            return Reason.SECOND_CONTROLLER, f"controller {command.source} came second: {self.owner} owns this plant"
        return None

    def _order(self, command: Any, now: int) -> Objection | None:
        if command.sequence <= self.last_sequence:
            return Reason.OUT_OF_ORDER, f"command {command.sequence} after {self.last_sequence}"
        if command.apply_at < self.in_force:
            return (
                Reason.STALE,
                f"command for {command.apply_at} ns is older than the one in force since {self.in_force} ns",
            )
        if command.sample_stamp < self.last_sample:
            return Reason.STALE, f"answer to {command.sample_stamp} ns after the one to {self.last_sample} ns"
        return None

    def _time(self, command: Any, now: int) -> Objection | None:
        if command.sample_stamp > now or command.apply_at < command.sample_stamp:
            return Reason.IMPOSSIBLE_TIME, (
                f"sample at {command.sample_stamp} ns, to act at {command.apply_at} ns, now is {now} ns"
            )
        if command.apply_at - now > FURTHEST:
            return Reason.FAR_FUTURE, f"to act at {command.apply_at} ns, more than 10 s ahead of {now} ns"
        if command.apply_at % self.grid.step:
            return Reason.OFF_THE_GRID, f"to act at {command.apply_at} ns, not a whole number of {self.grid.step} ns"
        return None


class Gaps:
    """Which commands never came, or were refused without an event of their own.

    Told by their sequence: a recorder that heard them could not know that they did not act.
    """

    def __init__(self) -> None:
        self._source = 0
        self._last = -1  # sequence of the last command that was taken
        self._told = 0  # refusals that were told since then

    def refuse(self, source: int, sequence: int, reason: Reason) -> None:
        """A command was refused, and an event says so."""
        if reason not in (Reason.FOREIGN_RUN, Reason.SECOND_CONTROLLER, Reason.UNDECODABLE):
            self.lose(source, sequence)

    def lose(self, source: int, sequence: int) -> None:
        """A command was lost, and everybody knows by which rule."""
        self._turn_to(source)
        self._told += sequence > self._last

    def accept(self, command: Any) -> tuple[int, int] | None:
        """First and last sequence of the gap before a command that is taken; None without a gap."""
        self._turn_to(command.source)
        first, last, told = self._last + 1, command.sequence - 1, self._told
        self._last, self._told = command.sequence, 0
        return (first, last) if last - first + 1 > told else None

    def _turn_to(self, source: int) -> None:
        if source != self._source:
            self._source, self._last, self._told = source, -1, 0


class Watchdog:
    """Patience with a controller: `timeout` [ns of simulated time] for the command that is due."""

    def __init__(self, timeout: int, grid: Sampling, latching: bool) -> None:
        self.timeout = timeout
        self.grid = grid
        self.latching = latching  # the safe state that follows takes a reset

    def trip_at(self, due: int) -> int:
        """When patience ends [ns, whole steps] for the command that is to act at `due`."""
        return -(-(due + self.timeout) // self.grid.step) * self.grid.step
