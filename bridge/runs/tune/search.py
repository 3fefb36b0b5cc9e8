"""The search: differential evolution of scipy with a fixed seed, then a pattern search about the best.

It knows no runs: `evaluate` gives the energies of many points at once, each a tuple of shares from 0 to 1, and raises
SpentError when there may be no more. The course depends on the energies and the seed alone, not on who computes them.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

Shares = tuple[float, ...]
Evaluate = Callable[[list[Shares]], list[float]]
LEAST_MEMBERS, MEMBERS = 8, 6  # of a population; per number
TOLERANCE = 5e-3  # spread of the energies of a population, relative, at which it has converged
WIDEST, NARROWEST = 0.1, 2e-3  # steps of the pattern search, shares of the range
FOR_PATTERN = 0.3  # share of the runs that is left to it


class SpentError(Exception):
    """There may be no more runs."""


class Best(NamedTuple):
    """The best point of a search."""

    shares: Shares
    energy: float


class Search:
    """A search of `runs` points at most."""

    def __init__(self, evaluate: Evaluate, runs: int) -> None:
        self.runs = runs
        self.best: Best | None = None
        self._evaluate = evaluate
        self._asked: set[Shares] = set()

    def ask(self, points: Sequence[Shares], most: int) -> list[float]:
        """Energies of points, as long as no more than `most` different ones are asked for in all. Raises SpentError."""
        new = {*points} - self._asked
        if len(self._asked) + len(new) > most:
            raise SpentError
        self._asked |= new
        found = self._evaluate([*points])
        for shares, energy in zip(points, found, strict=True):
            if self.best is None or energy < self.best.energy:
                self.best = Best(shares, energy)
        return found

    def run(self, start: Shares, seed: int) -> bool:
        """Search from a start; False where the runs were spent before the pattern search had converged."""
        self._evolve(start, seed)
        try:
            self._refine(len(start))
        except SpentError:
            return False
        return True

    def _evolve(self, start: Shares, seed: int) -> None:
        members = max(LEAST_MEMBERS, MEMBERS * len(start))
        most = max(members, round((1.0 - FOR_PATTERN) * self.runs))

        init: Any = _population(members, len(start), seed)  # an array, which the stubs do not know

        def energies(columns: NDArray[np.float64]) -> NDArray[np.float64]:
            points = [tuple(map(float, row)) for row in np.atleast_2d(columns.T)]
            return np.array(self.ask(points, min(most, self.runs)))

        with suppress(SpentError):
            differential_evolution(
                energies,
                [(0.0, 1.0)] * len(start),
                x0=np.array(start),
                init=init,
                rng=seed,
                tol=TOLERANCE,
                maxiter=self.runs,
                polish=False,
                updating="deferred",
                vectorized=True,
            )

    def _refine(self, numbers: int) -> None:
        """To the best neighbour along any axis, else to half the step."""
        step = WIDEST
        while self.best is not None and step >= NARROWEST:
            before = self.best
            around = [_moved(before.shares, n, way * step) for n, way in product(range(numbers), (-1.0, 1.0))]
            self.ask(list(dict.fromkeys(around)), self.runs)
            if self.best.energy >= before.energy:
                step *= 0.5


def _population(members: int, numbers: int, seed: int) -> NDArray[np.float64]:
    """Latin hypercube: every number is spread evenly over its range."""
    random = np.random.default_rng(seed)
    cells = np.stack([random.permutation(members) for _ in range(numbers)], axis=1)
    return (cells + random.random((members, numbers))) / members


def _moved(shares: Shares, number: int, step: float) -> Shares:
    moved = min(max(shares[number] + step, 0.0), 1.0)
    return (*shares[:number], moved, *shares[number + 1 :])
