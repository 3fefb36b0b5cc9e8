"""The state of a circuit, as its parts and as one flat array of numbers, which is what the kernels run on.

core | pressure | flow | cavity | free | impedance (14 each) | oil of the lines (7) | signals | memory of the slots |
memory of the lines
"""

from collections.abc import Iterator
from itertools import accumulate, pairwise
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from twin.accumulator import OIL as ACCUMULATED
from twin.circuit.step import Core, Ends, Ledger, Piston, Slots
from twin.cylinder import Chambers
from twin.directional_valve import Spool
from twin.kernel import inlined
from twin.load import Weight
from twin.relief.motion import Motion, ReliefState
from twin.topology import END_COUNT, END_OF, LINES, SLOT_SIZES, TAPS


def _names(kind: type, prefix: str = "") -> Iterator[str]:
    """The numbers of a nested NamedTuple in order, as "piston.position"."""
    for name, entry in get_type_hints(kind).items():
        yield from [prefix + name] if entry is float else _names(entry, f"{prefix}{name}.")


CORE = tuple(_names(Core))
ENDS_AT = len(CORE)
LINES_AT = ENDS_AT + 5 * END_COUNT
SIGNALS_AT = LINES_AT + END_COUNT // 2
SIGNALS = 1 + len(TAPS)  # behind amplifiers: the position and the pressures at the taps
SLOTS_AT = SIGNALS_AT + 2 * SIGNALS
SLOT_AT = tuple(accumulate(SLOT_SIZES, initial=SLOTS_AT))
MEMORY_AT = SLOT_AT[-1]


def place_of(name: str) -> int:
    """Where a number of the core stands in a flat state, as "piston.position"."""
    return CORE.index(name)


class Pressures(NamedTuple):
    """Gauge pressures [Pa] where components and line ends meet, in the order of PLACES."""

    pump: float
    tee: float
    p: float
    a: float
    lower: float
    upper: float
    b: float
    t: float
    back: float


class Flows(NamedTuple):
    """Flow through each line [m^3/s], the mean of its ends, from its first end to its second."""

    line_1: float
    line_2: float
    line_3: float
    line_4: float
    line_5: float
    line_6: float


class State(NamedTuple):
    """Everything that has a memory."""

    core: Core
    ends: Ends
    signals: NDArray[np.float64]  # of the amplifiers: outputs, then inputs
    slots: Slots
    memory: NDArray[np.float64]  # of the lines

    @property
    def piston(self) -> Piston:
        return self.core.piston

    @property
    def spool(self) -> Spool:
        return self.core.spool

    @property
    def ledger(self) -> Ledger:
        return self.core.ledger

    def with_core(self, **parts: object) -> "State":
        """The state with some parts of its core replaced."""
        return self._replace(core=self.core._replace(**parts))  # pyright: ignore[reportArgumentType]


def pressures(state: State) -> Pressures:
    """The pressures [Pa] at the PLACES."""
    return Pressures(*(float(state.ends.pressure[end]) for end in END_OF.values()))


def flows(state: State) -> Flows:
    """The six flows [m^3/s]."""
    into = state.ends.flow
    return Flows(*(0.5 * float(into[2 * line] - into[2 * line + 1]) for line in range(LINES)))


def oil_in(state: State) -> float:
    """Oil beyond what fills the lines [m^3 at reference density]; it changes by pumped - relieved - returned."""
    kept = sum(state.core.chambers) + float(state.slots.accumulator[ACCUMULATED])
    return kept + float(state.ends.oil.sum() - state.ends.cavity.sum())


def flatten(state: State) -> NDArray[np.float64]:
    """A state as an array of its numbers, in order."""
    return np.concatenate([list(_numbers(state.core)), *state.ends, state.signals, *state.slots, state.memory])


def _numbers(part: Any) -> Iterator[float]:
    if isinstance(part, tuple):
        for entry in part:
            yield from _numbers(entry)
    else:
        yield part


def unflatten(array: NDArray[np.float64]) -> State:
    """The state back from its numbers; a copy."""
    kept = array.copy()
    ends = [*kept[ENDS_AT:LINES_AT].reshape(-1, END_COUNT), kept[LINES_AT:SIGNALS_AT]]
    return State(
        load(kept),
        Ends._make(ends),
        kept[SIGNALS_AT:SLOTS_AT],
        Slots(*(kept[first:last] for first, last in pairwise(SLOT_AT))),
        kept[MEMORY_AT:],
    )


@inlined
def load(a) -> Core:
    """The core of a flat state."""
    return Core(
        a[0],
        Piston(a[1], a[2]),
        Spool(a[3], a[4]),
        Weight(a[5], a[6], a[7]),
        Chambers(a[8], a[9]),
        Motion(
            ReliefState(a[10], a[11], a[12], a[13]),
            a[14],
            a[15],
            a[16],
            a[17],
            a[18],
            a[19],
            a[20],
            a[21],
            a[22],
            a[23],
            a[24],
        ),
        a[25],
        Ledger(a[26], a[27], a[28]),
    )


@inlined
def store(s: Core, a) -> None:
    """The core back into a flat state."""
    a[0] = s.tick
    a[1], a[2] = s.piston.position, s.piston.velocity
    a[3], a[4] = s.spool.position, s.spool.velocity
    a[5], a[6], a[7] = s.weight.position, s.weight.velocity, s.weight.carried
    a[8], a[9] = s.chambers.lower, s.chambers.upper
    for i in range(4):
        a[10 + i] = s.relief.state[i]
    a[14], a[15], a[16] = s.relief.y, s.relief.y_rate, s.relief.pilot_force
    a[17], a[18], a[19] = s.relief.spool_gain, s.relief.spool_gain_before, s.relief.spool_gain_first
    a[20], a[21], a[22], a[23] = s.relief.rise, s.relief.rise_before, s.relief.pilot_oil, s.relief.flow
    a[24], a[25] = s.relief.filling, s.tee
    for i in range(3):
        a[26 + i] = s.ledger[i]


@inlined
def ends_of(a) -> Ends:
    """The line ends of a flat state, as views of it."""
    e, n = ENDS_AT, END_COUNT
    return Ends(
        a[e : e + n],
        a[e + n : e + 2 * n],
        a[e + 2 * n : e + 3 * n],
        a[e + 3 * n : e + 4 * n],
        a[e + 4 * n : e + 5 * n],
        a[LINES_AT:SIGNALS_AT],
    )


@inlined
def slots_of(a) -> Slots:
    """What the kinds in the slots of a flat state keep, as views of it."""
    return Slots(
        a[SLOT_AT[0] : SLOT_AT[1]],
        a[SLOT_AT[1] : SLOT_AT[2]],
        a[SLOT_AT[2] : SLOT_AT[3]],
        a[SLOT_AT[3] : SLOT_AT[4]],
        a[SLOT_AT[4] : SLOT_AT[5]],
        a[SLOT_AT[5] : SLOT_AT[6]],
        a[SLOT_AT[6] : SLOT_AT[7]],
        a[SLOT_AT[7] : SLOT_AT[8]],
        a[SLOT_AT[8] : SLOT_AT[9]],
        a[SLOT_AT[9] : SLOT_AT[10]],
        a[SLOT_AT[10] : SLOT_AT[11]],
        a[SLOT_AT[11] : SLOT_AT[12]],
    )
