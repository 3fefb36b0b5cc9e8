"""How the lines of `ends` lie in memory: sixteen ends to a chunk, the same quantity of all side by side."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.lines.filters import POLES, TAPS, Filters
from twin.lines.fit import fit
from twin.lines.spec import LineNumbers
from twin.lines.theory import Line

LANES = 16  # ends in a chunk; LLVM turns loops of fewer than 16 into no vectors
# rows of LANES numbers in the memory of a chunk: c, q, then what comes from the rings, then states
C, Q, SERIES, OWN, ECHO, FAR, TAP, ECHO_TAP, LATE, CHAIN = range(10)
STATES = CHAIN + TAPS
MEMORY = STATES + POLES  # rows; rings follow
# rows of coefficients
PER_H, Z, PUSH, ECHO_0, ECHO_1, Z0, M, HALF, PER_FLOW, TAPS_AT = range(10)
P = TAPS_AT + TAPS
NUMBERS = P + 4 * POLES
# rows of whole numbers: number of the end, its ring, mask, delays of FAR, ECHO, TAP, ECHO_TAP
END, RING, MASK, D_FAR, D_ECHO, D_TAP, D_ECHO_TAP = range(7)
LAYOUT = 7


class Chunks(NamedTuple):
    """All `ends` lines of a bank; place[k] is where the memory of chunk k starts."""

    place: NDArray[np.int64]
    layout: NDArray[np.int64]
    numbers: NDArray[np.float64]
    size: int  # of their memory


def fitted(line: LineNumbers, step: float) -> Filters:
    """The filters of a line; ValueError if it is too short."""
    return fit(Line(line.travel_time, line.viscous_time, line.losses, step, line.creep))


def chunks_of(
    which: Sequence[int], lines: Sequence[LineNumbers], filters: Sequence[Filters], step: float, start: int
) -> Chunks:
    """Lay out lines, their numbers in the bank being `which`, and their filters; their memory starts at `start`."""
    count = -(-2 * len(lines) // LANES)
    layout, numbers = np.zeros((count, LAYOUT, LANES), np.int64), np.zeros((count, NUMBERS, LANES))
    layout[:, END] = -1
    place, at = np.zeros(count, np.int64), start
    for k in range(count):
        place[k] = at
        at += MEMORY * LANES
        for j in range(k * LANES // 2, min(len(lines), (k + 1) * LANES // 2)):
            ring = 2 ** math.ceil(math.log2(filters[j].echo_delay + 3))
            coefficients = _coefficients(filters[j], lines[j], lines[j].travel_time / step)
            for end in (0, 1):
                lane = 2 * j + end - k * LANES
                layout[k, :, lane] = _delays(filters[j], 2 * which[j] + end, at + end * ring, ring)
                numbers[k, :, lane] = coefficients
            at += 2 * ring
    return Chunks(place, layout.reshape(count, LAYOUT * LANES), numbers.reshape(count, NUMBERS * LANES), at - start)


def _delays(f: Filters, end: int, ring: int, length: int) -> list[int]:
    return [end, ring, length - 1, f.delay, f.echo_delay, f.first, f.echo_first]


def _coefficients(f: Filters, line: LineNumbers, steps: float) -> NDArray[np.float64]:
    gain = 1.0 - f.poles
    direct = f.direct + math.fsum(gain * f.own)
    z = line.z0 * (1.0 + direct) / (1.0 - direct)
    table = np.zeros((4, POLES))
    table[:, : len(gain)] = f.poles, f.poles * gain * f.own, gain * f.echo, gain * f.across
    scalars = [1.0 / (1.0 - direct), z, z + line.z0, *f.echo_taps, line.z0, steps]
    friction = [0.5 * line.resistance, line.turbulent_per_flow]
    return np.concatenate([scalars, friction, f.taps, table.ravel()])
