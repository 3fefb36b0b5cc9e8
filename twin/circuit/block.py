"""The plant for its callers: many steps at once on a flat state, what the sensors touch, what can be observed.

numba checks an argument of a hundred floats for microseconds on every call; an array costs next to nothing.
"""

from functools import cache
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from twin.circuit.state import (
    MEMORY_AT,
    State,
    ends_of,
    flatten,
    load,
    store,
    unflatten,
)
from twin.circuit.step import (
    BACK_5,
    LOWER,
    PUMP,
    TEE_1,
    TEE_2,
    UPPER,
    A,
    B,
    Circuit,
    Core,
    Ends,
    P,
    Parts,
    T,
    seal_force,
    step_once,
)
from twin.cylinder import chamber_cavities
from twin.kernel import INTERPRETED, inlined, kernel
from twin.lines.bank import Bank, inner_cavity, packed, unpacked
from twin.load import carried_mass
from twin.topology import LINES, OBSERVED


class Taps(NamedTuple):
    """What the card's channels touch: true values, SI."""

    position: float
    velocity: float
    p1: float  # relief valve's inlet
    p2: float  # lower chamber
    p3: float  # upper chamber


PRESSURES = (PUMP, TEE_1, P, A, LOWER, UPPER, B, T, BACK_5)
CAVITIES = (PUMP, TEE_1, P, A, B, T, BACK_5)


class Compiled(NamedTuple):
    """A circuit as the kernels take it."""

    parts: NDArray[Any]  # a record of Parts, length 1
    whole: NDArray[np.int64]  # both of the lines, `packed`
    numbers: NDArray[np.float64]


def record(parameters: tuple[Any, ...]) -> NDArray[Any]:
    """A nested NamedTuple of floats as a structured array of length 1, which kernels read by the same names."""
    return np.array([_plain(parameters)], dtype=_dtype(type(parameters)))


def _plain(value: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(_plain(entry) if isinstance(entry, tuple) else entry for entry in value)


@cache
def _dtype(kind: type) -> np.dtype[Any]:
    """One object for each class: numba compares others field by field at every call."""
    hints = get_type_hints(kind).items()
    fields = np.dtype([(name, "f8" if entry is float else _dtype(entry)) for name, entry in hints])
    return np.dtype((np.record, fields)) if INTERPRETED else fields  # Python reads no names of a plain record


def compiled(circuit: Circuit) -> Compiled:
    """The circuit as the kernels take it."""
    return Compiled(record(circuit.parts), *packed(circuit.lines))


@inlined
def _tap(s, ends, row) -> None:
    row[0], row[1] = s.piston.position, s.piston.velocity
    row[2], row[3], row[4] = ends.pressure[TEE_1], ends.pressure[LOWER], ends.pressure[UPPER]


@kernel
def run_block(state, reference: float, parts, whole, numbers, steps: int, taps, seen) -> None:
    """Advance a flat state in place by `steps` under a constant spool reference.

    parts, whole, numbers: of `Compiled`. taps: shape (2, 5), filled with the Taps a step before the end and at the end.
    seen: filled with the OBSERVED quantities at the end.
    """
    c, lines, s, ends, memory = parts[0], unpacked(whole, numbers), load(state), ends_of(state), state[MEMORY_AT:]
    _tap(s, ends, taps[1])
    for i in range(steps):
        if i == steps - 1:
            _tap(s, ends, taps[0])
        s = step_once(s, reference, c, lines, ends, memory)
    _tap(s, ends, taps[1])
    store(s, state)
    observe(s, ends, memory, c, lines, seen)


@inlined
def observe(s: Core, ends: Ends, memory, c: Parts, lines: Bank, out) -> None:
    """Fill `out` with the OBSERVED quantities."""
    out[0], out[1], out[2] = s.piston.position, s.piston.velocity, s.spool.position
    for i in range(9):
        out[3 + i] = ends.pressure[PRESSURES[i]]
    hollow = chamber_cavities(s.chambers, s.piston.position, c.cylinder)
    out[12], out[13] = hollow.lower, hollow.upper
    inner, total = 0.0, s.chambers.lower + s.chambers.upper + c.line_volume
    for line in range(LINES):
        out[14 + line] = 0.5 * (ends.flow[2 * line] - ends.flow[2 * line + 1])
        inner += inner_cavity(lines, memory, line)
        total += ends.oil[line]
    out[20], out[21] = ends.flow[PUMP], s.relief.flow
    out[22], out[23] = s.relief.state.pilot_lift, s.relief.state.spool_lift
    out[24], out[25] = carried_mass(s.weight, c.load), seal_force(s, ends, c)
    for i in range(7):
        out[26 + i] = ends.cavity[CAVITIES[i]]
    out[27] += ends.cavity[TEE_2]
    for end in range(12):
        total -= ends.cavity[end]
    out[33] = inner
    out[34] = total
    for i in range(3):
        out[35 + i] = s.ledger[i]


def advance(state: State, reference: float, circuit: Circuit, steps: int) -> State:
    """The state `steps` steps later under a constant spool reference (-1..1)."""
    flat = flatten(state)
    run_block(flat, reference, *compiled(circuit), steps, np.zeros((2, 5)), np.zeros(len(OBSERVED)))
    return unflatten(flat)


def observed(state: State, circuit: Circuit) -> dict[str, float]:
    """The OBSERVED quantities of a state, by name."""
    seen = np.zeros(len(OBSERVED))
    run_block(flatten(state), 0.0, *compiled(circuit), 0, np.zeros((2, 5)), seen)
    return dict(zip(OBSERVED, seen.tolist(), strict=True))
