"""The link between plant and controller when it is bad, seen from the plant's edge.

What becomes of a message is a function of the seed, the direction and the message's number (of measurements the tick,
of commands their sequence), so the plant knows which command will never come. A message that takes less than a DAQ
period is there in time, as over a good network: the plant integrates a block when the block has passed.
"""

import heapq
import math
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from bridge.loop.fault_chance import Bursts, Luck
from bridge.loop.fault_clock import Spell
from bridge.loop.spells import Spells
from bridge.scenario.fault_kinds import LONGEST
from bridge.scenario.faults import PlannedFault
from controller.grid import NS, to_ns

Bent = Callable[[int, int, list[int], int], tuple[list[int], int]]  # of number, sending, arrivals and shift
Delay = Callable[[int, int], int]  # of a message's number, sent at an instant [ns]: how long it takes [ns]


class Fate(NamedTuple):
    """What becomes of one message."""

    arrivals: tuple[int, ...]  # when its copies are there [ns]; none of one that is lost
    shift: int  # of the times in it [ns]


class Way:
    """One direction of the link."""

    def __init__(self, seed: int, direction: str, daq: int) -> None:
        self._seed = seed
        self._direction = direction
        self._daq = daq
        self._spells: Spells[Bent] = Spells(back=to_ns(LONGEST))
        self._last = 0  # arrival of the newest message that may not be overtaken
        self._queue: list[tuple[int, int, Any]] = []
        self._put = 0
        self.counts: dict[str, int] = {}  # messages by what became of them

    def start(self, spell: Spell) -> None:
        """A fault of this direction is going to be there."""
        self._spells.add(spell, self._made(spell))

    def end(self, fault: PlannedFault, now: int) -> None:
        """End a fault at an instant [ns]. What a link that was frozen has held back is there then."""
        held = max((spell.end for spell, _ in self._spells.there(now) if spell.fault.name == fault.name), default=now)
        self._spells.end(fault.name, now, self._made)
        if fault.kind == "freeze" and held > now:
            early = held - now
            self._queue = [(at - early if at >= held else at, put, message) for at, put, message in self._queue]
            heapq.heapify(self._queue)
            self._last -= early if self._last >= held else 0

    def send(self, number: int, sent: int) -> Fate:
        """What becomes of a message; its copies are to be put on their way."""
        fate = self._fate(number, sent)
        self._count("lost", not fate.arrivals)
        self._count("delayed", any(arrival > sent + self._daq for arrival in fate.arrivals))
        self._count("doubled", len(fate.arrivals) > 1)
        self._count("wrong in time", bool(fate.shift))
        return fate

    def put(self, arrival: int, message: Any) -> None:
        """Let a copy be there at an instant [ns]."""
        self._put += 1
        heapq.heappush(self._queue, (arrival, self._put, message))

    def __len__(self) -> int:
        """Copies on their way."""
        return len(self._queue)

    def arrived(self, now: int) -> Iterable[tuple[int, Any]]:
        """What is there when the block that begins now is integrated, with its arrival [ns]; in this order."""
        while self._queue and self._queue[0][0] <= now + self._daq:
            arrival, _, message = heapq.heappop(self._queue)
            yield arrival, message

    def _fate(self, number: int, sent: int) -> Fate:
        arrivals, shift, ordered = [sent], 0, False
        for spell, kind in self._spells.there(sent):
            arrivals, shift = kind(number, sent, arrivals, shift)
            ordered = ordered or spell.fault.kind in IN_ORDER
        if arrivals and ordered:
            arrivals[0] = max(arrivals[0], self._last)
        if arrivals:
            self._last = max(self._last, arrivals[0])
        return Fate(tuple(arrivals), shift)

    def _made(self, spell: Spell) -> Bent:
        return KINDS[spell.fault.kind](spell, Luck(self._seed, f"{spell.fault.name} message"))

    def _count(self, word: str, happens: bool) -> None:
        if happens:
            name = f"{self._direction}s {word}"
            self.counts[name] = self.counts.get(name, 0) + 1


IN_ORDER = ("delay", "freeze")


def _delay(spell: Spell, luck: Luck) -> Bent:
    takes = LAWS[spell.fault.word](spell, luck)
    return lambda number, sent, arrivals, shift: ([arrival + takes(number, sent) for arrival in arrivals], shift)


def _constant(spell: Spell, luck: Luck) -> Delay:
    time = to_ns(spell.fault.sizes["time"])
    return lambda number, sent: time


def _uniform(spell: Spell, luck: Luck) -> Delay:
    time, spread = spell.fault.sizes["time"], spell.fault.sizes["spread"]
    return lambda number, sent: max(0, to_ns(time + spread * (2.0 * luck.uniform(number) - 1.0)))


def _normal(spell: Spell, luck: Luck) -> Delay:
    time, spread = spell.fault.sizes["time"], spell.fault.sizes["spread"]
    return lambda number, sent: max(0, to_ns(time + spread * luck.normal(number)))


def _exponential(spell: Spell, luck: Luck) -> Delay:
    time, spread = spell.fault.sizes["time"], spell.fault.sizes["spread"]
    return lambda number, sent: to_ns(time - spread * math.log1p(-luck.uniform(number)))


def _in_bursts(spell: Spell, luck: Luck) -> Delay:
    sizes = spell.fault.sizes
    bursts, time = Bursts(luck, sizes["share"], sizes["length"]), to_ns(sizes["time"])
    return lambda number, sent: time if bursts(number) else 0


def _growing(spell: Spell, luck: Luck) -> Delay:
    time, growth = spell.fault.sizes["time"], spell.fault.sizes["growth"]
    return lambda number, sent: to_ns(time + growth * (sent - spell.begin) / NS)


LAWS: dict[str, Callable[[Spell, Luck], Delay]] = {
    "constant": _constant,
    "uniform": _uniform,
    "normal": _normal,
    "exponential": _exponential,
    "bursts": _in_bursts,
    "growing": _growing,
}


def _loss(spell: Spell, luck: Luck) -> Bent:
    share = spell.fault.sizes["share"]
    return lambda number, sent, arrivals, shift: ([] if luck.uniform(number) < share else arrivals, shift)


def _burst_loss(spell: Spell, luck: Luck) -> Bent:
    bursts = Bursts(luck, spell.fault.sizes["share"], spell.fault.sizes["length"])
    return lambda number, sent, arrivals, shift: ([] if bursts(number) else arrivals, shift)


def _duplicate(spell: Spell, luck: Luck) -> Bent:
    share, later = spell.fault.sizes["share"], to_ns(spell.fault.sizes["time"])

    def bend(number: int, sent: int, arrivals: list[int], shift: int) -> tuple[list[int], int]:
        copies = [arrivals[0] + later] if arrivals and luck.uniform(number) < share else []
        return arrivals + copies, shift

    return bend


def _reorder(spell: Spell, luck: Luck) -> Bent:
    share, time = spell.fault.sizes["share"], to_ns(spell.fault.sizes["time"])

    def bend(number: int, sent: int, arrivals: list[int], shift: int) -> tuple[list[int], int]:
        held = time if luck.uniform(number) < share else 0
        return [arrival + held for arrival in arrivals], shift

    return bend


def _freeze(spell: Spell, luck: Luck) -> Bent:
    return lambda number, sent, arrivals, shift: ([max(arrival, spell.end) for arrival in arrivals], shift)


def _clock(spell: Spell, luck: Luck) -> Bent:
    offset, drift = to_ns(spell.fault.sizes["offset"]), spell.fault.sizes["drift"]
    return lambda number, sent, arrivals, shift: (arrivals, shift + offset + round(drift * (sent - spell.begin)))


KINDS: dict[str, Callable[[Spell, Luck], Bent]] = {
    "delay": _delay,
    "loss": _loss,
    "burst-loss": _burst_loss,
    "duplicate": _duplicate,
    "reorder": _reorder,
    "freeze": _freeze,
    "clock": _clock,
}
