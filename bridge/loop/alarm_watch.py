"""Which alarms are there: signals past their limits for long enough, and back again for long enough."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from bridge.scenario.conditions import crosses, gone
from bridge.scenario.safety import PlannedAlarm


class Turn(NamedTuple):
    """An alarm has come or gone."""

    alarm: PlannedAlarm
    there: bool
    value: float  # of its signal, SI


class AlarmWatch:
    """Looks at the signals once per scan; one that is past its limit at the start counts from there."""

    def __init__(self, alarms: Sequence[PlannedAlarm]) -> None:
        self._alarms = alarms
        self._there: set[int] = set()
        self._since: dict[int, int] = {}  # since when a signal is on the other side than its alarm [ns]

    def look(self, now: int, signal: Callable[[str], float]) -> Iterator[Turn]:
        """After a scan [ns]: the alarms that come and go."""
        for alarm in self._alarms:
            value, there = signal(alarm.condition.signal), alarm.number in self._there
            other = gone(alarm.condition, value, alarm.hysteresis) if there else crosses(alarm.condition, value)
            if not other:
                self._since.pop(alarm.number, None)
            elif now - self._since.setdefault(alarm.number, now) >= (alarm.clears_after if there else alarm.lasts):
                del self._since[alarm.number]
                self._there ^= {alarm.number}
                yield Turn(alarm, not there, value)
