"""The state of a circuit, as its parts and as one flat array of numbers, which is what the kernels run on.

core | pressure | flow | cavity | free | impedance (12 each) | oil of the lines (6) | memory of the lines
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.step import (
    BACK_5,
    LOWER,
    PUMP,
    TEE_1,
    UPPER,
    A,
    B,
    Core,
    Ends,
    Ledger,
    P,
    Piston,
    Spool,
    T,
)
from twin.cylinder import Chambers
from twin.kernel import inlined
from twin.load import Weight
from twin.relief.motion import Motion, ReliefState

CORE = 23
ENDS_AT, LINES_AT, MEMORY_AT = CORE, CORE + 60, CORE + 66
PLACES = {  # where each of the nine pressures is: its line end
    "pump": PUMP,
    "tee": TEE_1,
    "p": P,
    "a": A,
    "lower": LOWER,
    "upper": UPPER,
    "b": B,
    "t": T,
    "back": BACK_5,
}


class Pressures(NamedTuple):
    """Gauge pressures [Pa] at the nine places where components and line ends meet."""

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
    memory: NDArray[np.float64]

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
    """The nine pressures [Pa]."""
    return Pressures(*(float(state.ends.pressure[end]) for end in PLACES.values()))


def flows(state: State) -> Flows:
    """The six flows [m^3/s]."""
    into = state.ends.flow
    return Flows(*(0.5 * float(into[2 * line] - into[2 * line + 1]) for line in range(6)))


def oil_in(state: State) -> float:
    """Oil beyond what fills the lines [m^3 at reference density]; it changes by pumped - relieved - returned."""
    return sum(state.core.chambers) + float(state.ends.oil.sum() - state.ends.cavity.sum())


def flatten(state: State) -> NDArray[np.float64]:
    """A state as an array of its numbers, in order."""
    return np.concatenate([list(_numbers(state.core)), *state.ends, state.memory])


def _numbers(part: Any) -> Iterator[float]:
    if isinstance(part, tuple):
        for entry in part:
            yield from _numbers(entry)
    else:
        yield part


def unflatten(array: NDArray[np.float64]) -> State:
    """The state back from its numbers; a copy."""
    kept = array.copy()
    return State(load(kept), Ends(*np.split(kept[ENDS_AT:MEMORY_AT], range(12, 61, 12))), kept[MEMORY_AT:])


@inlined
def load(a) -> Core:
    """The core of a flat state."""
    return Core(
        a[0],
        Piston(a[1], a[2]),
        Spool(a[3], a[4]),
        Weight(a[5], a[6], a[7]),
        Chambers(a[8], a[9]),
        Motion(ReliefState(a[10], a[11], a[12], a[13]), a[14], a[15], a[16], a[17], a[18]),
        a[19],
        Ledger(a[20], a[21], a[22]),
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
    a[14], a[15], a[16], a[17] = s.relief.y, s.relief.pilot_force, s.relief.pilot_oil, s.relief.flow
    a[18], a[19] = s.relief.filling, s.tee
    for i in range(3):
        a[20 + i] = s.ledger[i]


@inlined
def ends_of(a) -> Ends:
    """The line ends of a flat state, as views of it."""
    e = ENDS_AT
    return Ends(
        a[e : e + 12], a[e + 12 : e + 24], a[e + 24 : e + 36], a[e + 36 : e + 48], a[e + 48 : e + 60],
        a[LINES_AT:MEMORY_AT],
    )  # fmt: skip
