"""Spells of faults, and what each does: those that are there at an instant, without a look at the others."""

import heapq
from collections.abc import Callable, Iterator
from typing import Generic, TypeVar

from bridge.loop.fault_clock import Spell
from controller.course import NEVER

T = TypeVar("T")


class Spells(Generic[T]):
    """Spells with what they do, in the order of their faults in the scenario."""

    def __init__(self, back: int = 0) -> None:
        """back: how far an instant may lie before the last one that was asked for [ns]."""
        self._back = back
        self._coming: list[tuple[int, int, Spell, T]] = []
        self._near: list[tuple[Spell, T]] = []
        self._count = 0

    def add(self, spell: Spell, does: T, early: bool = False) -> None:
        """Take one more; `early`: it has to see what is before it begins."""
        self._count += 1
        heapq.heappush(self._coming, (0 if early else spell.begin, self._count, spell, does))

    def end(self, name: str, now: int, renewed: Callable[[Spell], T] | None = None) -> None:
        """End a fault at an instant [ns]: those of its spells that are there, and let none come.

        renewed: what a spell does that ends then, where that depends on its end.
        """

        def cut(spell: Spell, does: T) -> tuple[Spell, T]:
            if spell.fault.name != name or spell.end <= now:
                return spell, does
            shorter = spell._replace(end=now)
            return shorter, does if renewed is None else renewed(shorter)

        mine = (spell.fault.name == name and spell.begin >= now for _, _, spell, _ in self._coming)
        self._coming = [one for one, over in zip(self._coming, mine, strict=True) if not over]
        self._coming = [(due, count, *cut(spell, does)) for due, count, spell, does in self._coming]
        heapq.heapify(self._coming)
        self._near = [cut(*one) for one in self._near if one[0].fault.name != name or one[0].begin < now]

    def near(self, now: int) -> list[tuple[Spell, T]]:
        """Those that are there at an instant [ns], some that have just ended, and the early ones."""
        if self._coming and self._coming[0][0] <= now:
            while self._coming and self._coming[0][0] <= now:
                self._near.append(heapq.heappop(self._coming)[2:])
            self._near.sort(key=lambda one: (one[0].fault.number or NEVER, one[0].begin))
        if any(spell.end <= now - self._back for spell, _ in self._near):
            self._near = [one for one in self._near if one[0].end > now - self._back]
        return self._near

    def there(self, now: int) -> Iterator[tuple[Spell, T]]:
        """Those that are there at an instant [ns]."""
        return (one for one in self.near(now) if one[0].begin <= now < one[0].end)

    def next(self, now: int) -> int | None:
        """The next instant at which one begins or ends [ns]."""
        ends = [spell.end for spell, _ in self.near(now) if spell.end > now]
        begins = [self._coming[0][0]] if self._coming else []
        return min(begins + ends, default=None)
