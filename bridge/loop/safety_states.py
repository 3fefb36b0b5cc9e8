"""The states of a plant's safety and what leads from one to the other; docs/safety.md draws them.

    running <-> degraded     by alarms
    either  ->  safe         by silence or by an alarm; back by a valid command or by reset
    either  ->  latched      the same where it is to take a reset; back by reset alone
    safe    ->  latched      by a further alarm, or by silence after the last one

Nothing here knows times or signals.
"""

from bridge.wire.messages import EventKind, SafetyState


class SafetyStates:
    """Where one plant stands among them."""

    def __init__(self) -> None:
        self.trips = 0  # how often it left running and degraded
        self._safe = False
        self._latched = False
        self._there: dict[int, SafetyState] = {}  # alarms that are there, by number: where each leads
        self._acknowledged: set[int] = set()  # of those: a reset says that they shall not keep the plant safe

    @property
    def state(self) -> SafetyState:
        """The state now."""
        if self._safe:
            return SafetyState.LATCHED if self._latched else SafetyState.SAFE
        return SafetyState.DEGRADED if self._there else SafetyState.RUNNING

    @property
    def safe(self) -> bool:
        """Do commands not act?"""
        return self._safe

    @property
    def keeping(self) -> list[int]:
        """The alarms that keep the plant safe, by their numbers."""
        left = {number for number, then in self._there.items() if then != SafetyState.DEGRADED}
        return sorted(left - self._acknowledged) if self._safe else []

    @property
    def shut(self) -> bool:
        """Are valid commands refused?"""
        return self._safe and (self._latched or bool(self.keeping))

    def knows(self, number: int) -> bool:
        """Is an alarm there?"""
        return number in self._there

    def trip(self, latched: bool) -> None:
        """Go to the safe state; `latched`: only a reset leaves it."""
        self._safe, self._latched = True, latched
        self.trips += 1

    def latch(self) -> None:
        """From the safe state only a reset leads from now on."""
        self._latched = True

    def come(self, number: int, then: SafetyState) -> EventKind:
        """An alarm has come; what that is for the plant."""
        was = self.state
        self._there[number] = then
        if then == SafetyState.DEGRADED:
            return EventKind.DEGRADED if was == SafetyState.RUNNING else EventKind.ALARM
        if not self._safe:
            self.trip(then == SafetyState.LATCHED)
            return EventKind.SAFE
        if then == SafetyState.LATCHED and not self._latched:
            self.latch()
            return EventKind.LATCHED
        return EventKind.ALARM

    def go(self, number: int) -> EventKind:
        """An alarm is gone; what that is for the plant."""
        was = self.state
        del self._there[number]
        self._acknowledged.discard(number)
        ended = was == SafetyState.DEGRADED and self.state == SafetyState.RUNNING
        return EventKind.RESTORED if ended else EventKind.CLEARED

    def leave(self) -> list[int]:
        """Leave the safe state, by reset or by a command; the alarms that are still there: they degrade the plant."""
        self._safe = self._latched = False
        self._acknowledged |= set(self._there)
        return sorted(self._there)
