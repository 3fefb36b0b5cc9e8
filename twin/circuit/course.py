"""A whole course of the plant in one call: a held reference after the other, readings kept, on demand led by data.

What fits the rig's numbers to a recording runs the same commands again and again. A call of Python for each sample
would take longer than the samples.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import Compiled, buffers, run_steps
from twin.circuit.state import MEMORY_AT
from twin.kernel import INTERPRETED, entry, kernel
from twin.topology import CHANNELS

Array = NDArray[np.float64]
Whole = NDArray[np.int64]


class Stretches(NamedTuple):
    """What acts on the valve: each reference over whole steps; a stretch may end in a sample, or in between."""

    reference: Array  # of the spool, -1..1
    steps: Whole
    row: Whole  # of the sample at its end; -1: none


class Watched(NamedTuple):
    """What is kept of each sample, and how the state is led."""

    places: Whole  # among the OBSERVED quantities, kept behind the taps
    led: Whole  # numbers of the flat state that are led to what was measured
    by: Whole  # by which of the kept quantities
    gain: Array  # change of the number for a deviation


Course = Callable[[Array, Array, Array], None]
NOTHING: Whole = np.zeros(0, np.int64)


def width(watched: Watched) -> int:
    """Numbers that are kept of a sample."""
    return 2 * len(CHANNELS) + len(watched.places)


def course_of(plant: Compiled, stretches: Stretches, watched: Watched) -> Course:
    """A function (state, measured, out) that runs the stretches on a flat state, in place.

    out, shape (samples, width): what the CHANNELS touch a step before each sample, and at it, then the places at it.
    measured, the same shape: where a number is led, its deviation from this is taken back by its gain; NaN leaves it.
    All arrays contiguous.
    """
    taps, seen = buffers()
    rest = taps, seen, *stretches, *watched
    example = np.zeros(MEMORY_AT), np.zeros((1, 1)), np.zeros((1, 1))
    run: Any = _run_course if INTERPRETED else entry(_run_course, *plant, *example, *rest)

    def course(state: Array, measured: Array, out: Array) -> None:
        run(*plant, state, measured, out, *rest)

    return course


@kernel
def _run_course(
    parts, whole, numbers, state, measured, out, taps, seen, reference, steps, row, places, led, by, gain
) -> None:
    """As `course_of` says."""
    for i in range(len(steps)):
        run_steps(parts, whole, numbers, state, reference[i], steps[i], taps, seen)
        if row[i] < 0:
            continue
        sample, wide = out[row[i]], taps.shape[1]
        for j in range(wide):
            sample[j], sample[wide + j] = taps[0, j], taps[1, j]
        for j in range(len(places)):
            sample[2 * wide + j] = seen[places[j]]
        for j in range(len(led)):
            off = measured[row[i], by[j]] - sample[by[j]]
            if off == off:
                state[led[j]] += gain[j] * off
