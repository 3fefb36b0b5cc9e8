"""When faults begin and end: by the clock, on conditions, by chance. Times are simulated nanoseconds."""

import heapq
from collections.abc import Callable, Collection, Iterator
from typing import NamedTuple

from bridge.loop.fault_chance import Luck
from bridge.scenario.faults import PlannedFault
from bridge.scenario.timeline import Crossing, crosses
from controller.course import NEVER


class Spell(NamedTuple):
    """One time in which a fault is there, [begin, end)."""

    fault: PlannedFault
    begin: int
    end: int  # NEVER: to the end of the run
    number: int  # how often it could have begun before


class Turn(NamedTuple):
    """A fault begins, or ends."""

    instant: int
    begins: bool
    spell: Spell


class FaultClock:
    """Gives each spell to `start` once it is known, and tells of beginnings and ends."""

    def __init__(self, faults: Collection[PlannedFault], seed: int, start: Callable[[Spell], None]) -> None:
        self._seed = seed
        self._start = start
        self._turns: list[tuple[int, int, Turn]] = []
        self._count = 0  # of turns: those of one instant keep their order
        self._waiting: dict[str, PlannedFault] = {}
        self._met: dict[str, bool] = {}  # a condition that is met at the start has not been crossed
        self._chances: dict[str, int] = {}
        for fault in faults:
            self.add(fault)

    def add(self, fault: PlannedFault) -> None:
        """Take one more fault."""
        if fault.condition is None:
            for begin in fault.begins:
                self._begin(fault, begin)
        else:
            self._waiting[fault.name], self._met[fault.name] = fault, True

    def end(self, name: str, now: int) -> bool:
        """End a fault, and let it begin no more; False where it is over already. Its end is told, if its begin was."""
        waited = self._waiting.pop(name, None) is not None
        mine = [entry for entry in self._turns if entry[2].spell.fault.name == name]
        coming = {turn.spell.number for _, _, turn in mine if turn.begins}
        self._turns = [entry for entry in self._turns if entry[2].spell.fault.name != name]
        for _, count, turn in mine:
            if turn.spell.number not in coming:
                self._turns.append((min(now, turn.instant), count, turn._replace(instant=min(now, turn.instant))))
        heapq.heapify(self._turns)
        return waited or any(instant > now or turn.begins for instant, _, turn in mine)

    def turns(self, now: int) -> Iterator[Turn]:
        """What has begun or ended up to now, in order; each once."""
        while self._turns and self._turns[0][0] <= now:
            yield heapq.heappop(self._turns)[2]

    def watch(self, now: int, signal: Callable[[str], float]) -> None:
        """After a scan: begin what waits for a signal."""
        for name, fault in list(self._waiting.items()):
            if isinstance(fault.condition, Crossing):
                met = crosses(fault.condition, signal(fault.condition.signal))
                if met and not self._met[name]:
                    self._trigger(fault, now)
                self._met[name] = met

    def heard(self, now: int, kinds: Collection[str]) -> None:
        """Begin what waits for an event."""
        for fault in list(self._waiting.values()):
            if fault.condition in kinds:
                self._trigger(fault, now)

    def _trigger(self, fault: PlannedFault, now: int) -> None:
        if self._chances.get(fault.name, 0) + 1 >= fault.times:
            del self._waiting[fault.name]
        self._begin(fault, now + fault.after)

    def _begin(self, fault: PlannedFault, begin: int) -> None:
        number = self._chances.get(fault.name, 0)
        self._chances[fault.name] = number + 1
        if Luck(self._seed, f"{fault.name} begins").uniform(number) >= fault.probability:
            return
        end = NEVER if fault.lasts == NEVER else begin + fault.lasts
        spell = Spell(fault, begin, end, number)
        for turn in (Turn(begin, True, spell), Turn(end, False, spell)):
            self._count += 1
            heapq.heappush(self._turns, (turn.instant, self._count, turn))
        self._start(spell)
