"""The plant for its callers: many steps at once on a flat state, what the sensors touch, what can be observed.

numba checks an argument of a hundred floats for microseconds on every call; an array costs next to nothing.
"""

from collections.abc import Callable
from contextvars import ContextVar
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.accumulator import OIL as ACCUMULATED
from twin.accumulator import is_fitted
from twin.actuator import chamber_cavities
from twin.amplifier import amplify, is_amplified
from twin.circuit.ends import TEE_2
from twin.circuit.state import (
    ENDS_AT,
    MEMORY_AT,
    SIGNALS_AT,
    SLOTS_AT,
    State,
    ends_of,
    flatten,
    load,
    place_of,
    slots_of,
    store,
    unflatten,
)
from twin.circuit.step import LOWER, PUMP, UPPER, Circuit, Core, Ends, Parts, Slots, seal_force, step_once
from twin.kernel import INTERPRETED, entry, field_names, inlined, kernel
from twin.lines.bank import Bank, inner_cavity, packed, unpacked
from twin.load_slot import moving_mass
from twin.topology import CHAMBERS, CHANNELS, END_COUNT, END_OF, FLOWS, LINES, OBSERVED, PLACES, PORTS, TAPS, cavity

HELD = {  # observed quantities that a flat state holds, and where
    "position": place_of("piston.position"),
    "velocity": place_of("piston.velocity"),
    "spool": place_of("spool.position"),
    **{place.pressure: ENDS_AT + END_OF[name] for name, place in PLACES.items()},
    "flow_pump": ENDS_AT + END_COUNT + PUMP,
    "flow_relief": place_of("relief.flow"),
    "relief_pilot": place_of("relief.state.pilot_lift"),
    "relief_spool": place_of("relief.state.spool_lift"),
    "oil_pumped": place_of("ledger.pumped"),
    "oil_relieved": place_of("ledger.relieved"),
    "oil_returned": place_of("ledger.returned"),
}


def _seen(*names: str) -> NDArray[np.int64]:
    """Where observed quantities stand among all."""
    return np.array([list(OBSERVED).index(name) for name in names])


HELD_AT, HELD_SEEN = np.array(list(HELD.values())), _seen(*HELD)
TAPPED = _seen(*(channel.reads for channel in CHANNELS.values()))
TAP_ENDS = np.array([END_OF[place] for place in TAPS.values()])
AMPLIFIED_AT = np.array([[*CHANNELS].index(name) for name in ("position", *TAPS)])
ALL_HELD = all(channel.reads in HELD for channel in CHANNELS.values())
PORT_ENDS, PORTS_SEEN = np.array([END_OF[place] for place in PORTS]), _seen(*map(cavity, PORTS))
FLOWS_SEEN = _seen(*FLOWS)
CAVITY_LOWER, CAVITY_UPPER = map(int, _seen(*map(cavity, CHAMBERS)))
CAVITY_TEE, CAVITY_LINES = map(int, _seen(cavity("tee"), cavity("lines")))
MASS, FRICTION, OIL_STORED = map(int, _seen("mass", "friction", "oil_stored"))


class Compiled(NamedTuple):
    """A circuit as the kernels take it."""

    parts: NDArray[Any]  # a record of Parts, length 1
    whole: NDArray[np.int64]  # both of the lines, `packed`
    numbers: NDArray[np.float64]


def record(parameters: tuple[Any, ...]) -> NDArray[Any]:
    """A nested NamedTuple of floats as a structured array of length 1, which kernels read by the same names."""
    return np.array([_plain(parameters)], dtype=_dtype(_kinds(parameters)))


def _plain(value: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(_plain(entry) if isinstance(entry, tuple) else entry for entry in value) or (0.0,)


def _kinds(value: tuple[Any, ...]) -> tuple[Any, ...]:
    """The class of a nested NamedTuple, then those of its entries: what is fitted."""
    return type(value), *(_kinds(entry) if isinstance(entry, tuple) else float for entry in value)


@cache
def _dtype(kinds: tuple[Any, ...]) -> np.dtype[Any]:
    """One object for each structure: numba compares others field by field at every call."""
    entries = [_dtype(kind) if isinstance(kind, tuple) else np.dtype(float) for kind in kinds[1:]] or [np.dtype(float)]
    fields = np.dtype(list(zip(field_names(kinds[0]), entries, strict=True)))
    return np.dtype((np.record, fields)) if INTERPRETED else fields  # Python reads no names of a plain record


def compiled(circuit: Circuit) -> Compiled:
    """The circuit as the kernels take it."""
    return Compiled(record(circuit.parts), *packed(circuit.lines))


def buffers() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What a block fills: taps, shape (2, channels), and the observed quantities."""
    return np.zeros((2, len(CHANNELS))), np.zeros(len(OBSERVED))


Array = NDArray[np.float64]
Block = Callable[[Array, float, int, Array, Array], None]


def block_of(plant: Compiled) -> Block:
    """A function (state, reference, steps, taps, seen) that advances a flat state in place.

    reference: of the spool, constant over the `steps`. taps, seen: of `buffers`; filled with what the CHANNELS touch, a
    step before the end and at the end, and with the OBSERVED quantities at the end. All arrays contiguous.
    """
    if INTERPRETED:
        return partial(run_steps, *plant)
    taps, seen = buffers()
    state = np.zeros(MEMORY_AT)
    run: Any = entry(run_steps, *plant, state, 0.0, 1, taps, seen)
    call, address, reference_at, steps_at = run.call, run.address, run.begins[4], run.begins[5]
    floats, whole = run.floats, run.whole
    last = state, taps, seen

    def block(state: Array, reference: float, steps: int, taps: Array, seen: Array) -> None:
        nonlocal last
        if state is not last[0] or taps is not last[1] or seen is not last[2]:
            for place, array in ((3, state), (6, taps), (7, seen)):
                run.put(place, array)
            last = state, taps, seen
        floats[reference_at], whole[steps_at] = reference, steps
        if call(address):
            run.failed()

    return block


@kernel
def run_steps(parts, whole, numbers, state, reference: float, steps: int, taps, seen) -> None:
    """As `block_of` says; parts, whole, numbers: of `Compiled`."""
    c, lines, s, ends, memory = parts[0], unpacked(whole, numbers), load(state), ends_of(state), state[MEMORY_AT:]
    signals, slots = state[SIGNALS_AT:SLOTS_AT], slots_of(state)
    for i in range(steps):
        if i == steps - 1:
            store(s, state)
            if ALL_HELD:
                _held(state, seen)
            else:
                observe(state, s, ends, slots, memory, c, lines, seen)
            _tap(seen, signals, c, taps[0])
        s = step_once(s, reference, c, lines, ends, slots, memory)
        amplify(c.amplifiers, s.piston.position, ends.pressure, TAP_ENDS, signals)
    store(s, state)
    observe(state, s, ends, slots, memory, c, lines, seen)
    _tap(seen, signals, c, taps[1])


@inlined
def _tap(seen, signals, c: Parts, row) -> None:
    for j in range(len(TAPPED)):
        row[j] = seen[TAPPED[j]]
    if is_amplified(c.amplifiers):
        for j in range(len(AMPLIFIED_AT)):
            row[AMPLIFIED_AT[j]] = signals[j]


@inlined
def _held(state, out) -> None:
    for i in range(len(HELD_AT)):
        out[HELD_SEEN[i]] = state[HELD_AT[i]]


@inlined
def observe(state, s: Core, ends: Ends, slots: Slots, memory, c: Parts, lines: Bank, out) -> None:
    """Fill `out` with the OBSERVED quantities of a flat state; s, ends, slots, memory: what it holds."""
    _held(state, out)
    hollow = chamber_cavities(s.chambers, s.piston.position, c.cylinder)
    out[CAVITY_LOWER], out[CAVITY_UPPER] = hollow.lower + ends.cavity[LOWER], hollow.upper + ends.cavity[UPPER]
    inner, total = 0.0, s.chambers.lower + s.chambers.upper + c.line_volume
    for line in range(LINES):
        out[FLOWS_SEEN[line]] = 0.5 * (ends.flow[2 * line] - ends.flow[2 * line + 1])
    for line in range(len(lines.model)):
        inner += inner_cavity(lines, memory, line)
        total += ends.oil[line]
    out[MASS], out[FRICTION] = moving_mass(c.load, s.piston.position, s.weight), seal_force(s, ends, slots, c)
    for i in range(len(PORT_ENDS)):
        out[PORTS_SEEN[i]] = ends.cavity[PORT_ENDS[i]]
    out[CAVITY_TEE] += ends.cavity[TEE_2]
    for end in range(END_COUNT):
        total -= ends.cavity[end]
    if is_fitted(c.tee_accumulator) or is_fitted(c.p_accumulator):
        total += slots.accumulator[ACCUMULATED]
    out[CAVITY_LINES], out[OIL_STORED] = inner, total


def advance(state: State, reference: float, circuit: Circuit, steps: int) -> State:
    """The state `steps` steps later under a constant spool reference (-1..1)."""
    flat = flatten(state)
    _block(circuit)(flat, reference, steps, *buffers())
    return unflatten(flat)


def observed(state: State, circuit: Circuit) -> dict[str, float]:
    """The OBSERVED quantities of a state, by name."""
    taps, seen = buffers()
    _block(circuit)(flatten(state), 0.0, 0, taps, seen)
    return dict(zip(OBSERVED, seen.tolist(), strict=True))


_latest: ContextVar[tuple[Circuit, Block] | None] = ContextVar("latest", default=None)  # of each thread


def _block(circuit: Circuit) -> Block:
    """Made once for a circuit that is advanced again and again."""
    latest = _latest.get()
    if latest is None or latest[0] is not circuit:
        _latest.set(latest := (circuit, block_of(compiled(circuit))))
    return latest[1]
