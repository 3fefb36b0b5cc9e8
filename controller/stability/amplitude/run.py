"""The reduced drive under a sampled law, from a step of the reference on: exact in hold and delay.

Between two samples one command begins to act: `late` after the sample, that of `whole` samples before. So a period has
two spans, each of equal steps. A linear law runs compiled; any other is asked at each sample.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controller.law import CLOSING, Sample
from controller.stability.amplitude.drive import Drive, DriveState, Into, Pace, advance, pace_of
from controller.stability.amplitude.linear_law import LinearLaw
from twin.actuator import chamber_pressures, stored_oil
from twin.circuit.equilibrium import holding_pressures
from twin.kernel import inlined, interpreted, kernel

COARSEST = 5e-4  # [s], a step
ROW = 2.5e-3  # [s], between rows of a run at most
MOST_PERIODS = 10_000  # of delay
Array = NDArray[np.float64]
Decide = Callable[[Sample, float], float]  # from a sample and the reference to the spool reference


class Card(NamedTuple):
    """What readings and commands are rounded to; 0.0: they are not."""

    position: float  # [m]
    velocity: float  # [m/s]
    noise: float  # [LSB rms], of both
    output: float  # of the spool reference


class Course(NamedTuple):
    """When what happens, in seconds."""

    period: float
    delay: float
    at: float  # when the reference steps
    duration: float


class Spans(NamedTuple):
    """A sampling period cut where a command begins to act."""

    paces: tuple[Pace, Pace]
    steps: tuple[int, int]
    every: tuple[int, int]  # steps between rows
    whole: int  # samples between a command's own and that after which it acts

    @property
    def rows(self) -> int:
        """In a period."""
        return sum(-(-n // e) for n, e in zip(self.steps, self.every, strict=True))


def spans_of(d: Drive, when: Course) -> Spans:
    """The spans of a period. Raises ValueError for a delay of more than MOST_PERIODS."""
    whole = math.floor(when.delay / when.period + 1e-9)
    if whole > MOST_PERIODS:
        raise ValueError(f"delay {when.delay:g} s is more than {MOST_PERIODS} sampling periods of {when.period:g} s")
    late = when.delay - whole * when.period
    first = _span(late if late > 1e-9 else 0.0, d)
    second = _span(when.period - max(0.0, late), d)
    return Spans((first[0], second[0]), (first[1], second[1]), (first[2], second[2]), whole)


def _span(length: float, d: Drive) -> tuple[Pace, int, int]:
    """Pace, steps, and steps between rows of a span [s]."""
    steps = math.ceil(length / COARSEST - 1e-9)
    if not steps:
        return pace_of(d.valve, COARSEST), 0, 1
    return pace_of(d.valve, length / steps), steps, max(1, math.floor(steps * ROW / length + 1e-9))


def run_linear(
    d: Drive, s: DriveState, law: LinearLaw, size: float, when: Course, card: Card, seed: int
) -> tuple[Array, Array]:
    """Times [s] and positions [m] of a run whose reference steps by a size [m] from where the drive stands."""
    spans, samples = spans_of(d, when), round(when.duration / when.period)
    rows = np.zeros((samples * spans.rows + 1, 2))
    z = np.zeros(len(law.c))
    counts = np.array([*spans.steps, *spans.every, spans.whole, samples, seed])
    numbers = np.array([law.limit, law.overlap, float(law.relay), law.clamped, s.position, size, when.at, when.period])
    numbers = np.append(numbers, (law.rest, 0.0))  # and whether the valve has left its rest
    a, b, c, direct, back = (np.ascontiguousarray(m, float) for m in (law.a, law.b, law.c, law.d, law.back))
    ring = np.zeros(spans.whole + 1)
    n = _run(d, *spans.paces, s, counts, numbers, a, b, c, direct, back, z, np.zeros(len(z)), ring, card, rows)
    return rows[:n, 0], rows[:n, 1]


@kernel
def _run(d, first, second, s, counts, numbers, a, b, c, direct, back, z, then, ring, card, rows) -> int:
    """Fill `rows` with time and position; returns how many."""
    n_first, n, whole, samples, state = counts[0], counts[0] + counts[1], counts[4], counts[5], counts[6] * 7919 + 17
    start, size, at, period = numbers[4], numbers[5], numbers[6], numbers[7]
    acting, row = 0.0, 0
    for k in range(samples):
        time = k * period
        target = start + (size if time >= at - 1e-9 else 0.0)
        state, x = _read(s.position, card.position, card.noise, state)
        state, v = _read(s.velocity, card.velocity, card.noise, state)
        ring[k % (whole + 1)] = _answer(numbers, a, b, c, direct, back, z, then, target - start, x - start, v)
        due = ring[(k - whole) % (whole + 1)] if k >= whole else 0.0
        for i in range(n):
            acting = acting if i < n_first else due
            pace = first if i < n_first else second
            s = advance(s, _put_out(acting, card.output), d, pace)
            time += pace.step
            if _is_row(i, counts):
                rows[row, 0], rows[row, 1], row = time, s.position, row + 1
    return row


@inlined
def _is_row(i: int, counts) -> bool:
    """Is the position kept after step i of a period? Each span ends with a row."""
    if i < counts[0]:
        return i % counts[2] == counts[2] - 1 or i == counts[0] - 1
    i -= counts[0]
    return i % counts[3] == counts[3] - 1 or i == counts[1] - 1


@inlined
def _answer(numbers, a, b, c, d, back, z, then, target: float, x: float, v: float) -> float:
    """The spool reference of a linear law for one sample; its memory moves on."""
    limit, overlap, clamped, n = numbers[0], numbers[1], int(numbers[3]), len(z)
    h = d[0] * target + d[1] * x + d[2] * v
    for i in range(n):
        h += c[i] * z[i]
    most = max(limit - overlap, 0.0) / (1.0 - overlap)  # of h, without saturation
    beyond = h - min(max(h, -most), most)
    for i in range(n):
        then[i] = b[i, 0] * target + b[i, 1] * x + b[i, 2] * v - back[i] * beyond
        for j in range(n):
            then[i] += a[i, j] * z[j]
    for i in range(n):
        if i != clamped or beyond * (then[i] - z[i]) <= 0.0:
            z[i] = then[i]
    if h == 0.0:
        return 0.0
    if numbers[2] == 1.0:
        return math.copysign(limit, h)
    if numbers[8] != 0.0:
        numbers[9] = 1.0 if abs(h) > numbers[8] * (CLOSING if numbers[9] == 1.0 else 1.0) else 0.0
        if numbers[9] == 0.0:
            return 0.0
    u = math.copysign(overlap + (1.0 - overlap) * abs(h), h)
    return max(min(u, limit), -limit)


@inlined
def _read(value: float, lsb: float, noise: float, state: int) -> tuple[int, float]:
    """A reading, rounded, with noise: the sum of four even ones is nearly normal."""
    if lsb == 0.0:
        return state, value
    total = 0.0
    for _ in range(4):
        state = (state * 1103515245 + 12345) & 0x7FFFFFFF
        total += state / 0x7FFFFFFF - 0.5
    return state, lsb * math.floor((value + noise * lsb * total * 1.7320508) / lsb + 0.5)


@inlined
def _put_out(reference: float, lsb: float) -> float:
    """A command as the card puts it out: -1 and 0 are values of it, 1 is not."""
    if lsb == 0.0:
        return reference
    return min(lsb * math.floor(reference / lsb + 0.5), 1.0 - lsb)


def run_asking(
    d: Drive, s: DriveState, decide: Decide, size: float, when: Course, card: Card, seed: int
) -> tuple[Array, Array]:
    """The same under any law, which is asked at each sample."""
    spans, samples = spans_of(d, when), round(when.duration / when.period)
    source, start, acting = np.random.default_rng(seed), s.position, 0.0
    waiting = [0.0] * spans.whole
    rows: list[tuple[float, float]] = []
    buffer = np.zeros((spans.rows + 1, 2))
    for k in range(samples):
        time = k * when.period
        target = start + (size if time >= when.at - 1e-9 else 0.0)
        waiting.append(float(decide(_sample(s, time, d, card, source), target)))
        due = waiting.pop(0)
        s, n = _period(
            d, *spans.paces, s, np.array([*spans.steps, *spans.every]), np.array([time, acting, due]), card, buffer
        )
        acting = due
        rows.extend(map(tuple, buffer[:n].tolist()))
    found = np.array(rows)
    return found[:, 0], found[:, 1]


def _sample(s: DriveState, time: float, d: Drive, card: Card, source: np.random.Generator) -> Sample:
    p = chamber_pressures(s.stored, s.position, d.cylinder)
    x, v = (
        value if lsb == 0.0 else lsb * math.floor(value / lsb + card.noise * source.standard_normal() + 0.5)
        for value, lsb in ((s.position, card.position), (s.velocity, card.velocity))
    )
    return Sample(round(time * 1e9), x, v, p1=max(0.0, s.p_tee), p2=max(0.0, p.lower), p3=max(0.0, p.upper))


@kernel
def _period(d, first, second, s, counts, numbers, card, rows):
    """One sampling period; returns the state and how many rows were filled."""
    row, time = 0, numbers[0]
    for i in range(counts[0] + counts[1]):
        pace = first if i < counts[0] else second
        s = advance(s, _put_out(numbers[1] if i < counts[0] else numbers[2], card.output), d, pace)
        time += pace.step
        if _is_row(i, counts):
            rows[row, 0], rows[row, 1], row = time, s.position, row + 1
    return s, row


def resting(d: Drive, position: float, p_upper: float, supply: float) -> DriveState:
    """At rest at a position [m] with the valve shut, as a run starts; pressures [Pa] of the upper chamber, the tee."""
    p = holding_pressures(d.cylinder, d.load, position, p_upper)
    stored = interpreted(stored_oil)(p, position, d.cylinder)
    nothing = Into(0.0, 0.0, 0.0, 0.0)
    return DriveState(position, 0.0, 0.0, 0.0, stored, supply, supply, *p, 0.0, 0.0, nothing, *[0.0] * 5)
