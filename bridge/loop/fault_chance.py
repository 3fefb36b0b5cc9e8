"""Chance in faults: functions of the seed, a fault's name and a number alone, so a run is the same again.

Messages, scans and beginnings are counted; whatever else happens in the run, the nth has the same luck.
"""

import zlib
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

ROWS = 256
DRAWS = 3  # of each number: [0, 1), [0, 1), standard normal


class Luck:
    """The draws of one fault."""

    def __init__(self, seed: int, name: str) -> None:
        self._key = seed, zlib.crc32(name.encode())

    def uniform(self, number: int, which: int = 0) -> float:
        """0 to 1."""
        return float(_block(*self._key, number // ROWS)[number % ROWS, which])

    def normal(self, number: int) -> float:
        """Standard normal."""
        return float(_block(*self._key, number // ROWS)[number % ROWS, 2])

    def spells(self, number: int, share: float, length: float, end: float) -> Iterator[tuple[float, float]]:
        """Beginning and end of spells within [0, end), exponential both in the spells and between them.

        share: of the time, below 1; length: mean of a spell. Each `number` has its own.
        """
        source = np.random.Generator(np.random.Philox(key=self._key, counter=[0, 0, 1, number]))
        between = length * (1.0 - share) / share if share > 0.0 else np.inf
        at = source.exponential(between)
        while at < end:
            spell = source.exponential(length)
            yield at, min(at + spell, end)
            at += spell + source.exponential(between)


@lru_cache(64)
def _block(seed: int, name: int, block: int) -> NDArray[np.float64]:
    source = np.random.Generator(np.random.Philox(key=(seed, name), counter=[0, 0, 0, block]))
    return np.column_stack([source.random((ROWS, DRAWS - 1)), source.standard_normal(ROWS)])


class Bursts:
    """Is the nth message in a burst? A Markov chain of two states: Gilbert (1960)."""

    def __init__(self, luck: Luck, share: float, length: float) -> None:
        """share: of the messages in bursts, below 1; length: mean of a burst, messages."""
        self._luck = luck
        self._ends = 1.0 / length
        self._begins = min(1.0, share / (1.0 - share) / length)
        self._states = [luck.uniform(0, 1) < share]

    def __call__(self, number: int) -> bool:
        while len(self._states) <= number:
            now = self._states[-1]
            moves = self._luck.uniform(len(self._states)) < (self._ends if now else self._begins)
            self._states.append(now != moves)
        return self._states[number]
