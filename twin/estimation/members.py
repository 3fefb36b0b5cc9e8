"""The twins of an ensemble, all moved by one call: their states side by side, and what their sensors would touch."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import compiled, run_steps
from twin.circuit.step import Circuit
from twin.estimation.unknowns import Unknowns
from twin.kernel import entry, kernel
from twin.topology import CHANNELS, OBSERVED

Array = NDArray[np.float64]


class Members:
    """N twins of a circuit, whose unknowns differ."""

    def __init__(self, circuit: Circuit, unknowns: Unknowns, states: Array) -> None:
        count = len(states)
        self.states = states  # flat, a row for each
        self.taps = np.zeros((count, 2, len(CHANNELS)))  # as of `buffers`
        self.seen = np.zeros((count, len(OBSERVED)))
        plant = compiled(circuit)
        self._unknowns, self._references = unknowns, np.zeros(count)
        own: Any = (unknowns.records, plant.whole, plant.numbers, states, self._references, 1, self.taps, self.seen)
        self._run = entry(_run_members, *own)
        self._before, self._behind = own[:5], own[6:]

    def run(self, reference: float | Array, steps: int) -> None:
        """Advance all by some steps under a spool reference, or one of each; with 0 steps only look at them."""
        self._references[:] = reference + self._unknowns.spool_offsets
        self._run(*self._before, steps, *self._behind)


@kernel
def _run_members(parts, whole, numbers, states, references, steps: int, taps, seen) -> None:
    for m in range(len(states)):
        run_steps(parts[m : m + 1], whole, numbers, states[m], references[m], steps, taps[m], seen[m])
