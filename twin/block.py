"""The plant for callers in a hurry: the same steps, on arrays.

numba checks an argument of a hundred floats for microseconds on every call; an array costs next to nothing.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit import (
    Circuit,
    Flows,
    Ledger,
    Piston,
    Spool,
    State,
    Stored,
    chamber_cavities,
    pressures,
    step_once,
)
from twin.kernel import kernel
from twin.pump import pump_flow
from twin.relief import relief_flow


class Taps(NamedTuple):
    """What the card's channels touch: true values, SI."""

    position: float
    velocity: float
    p1: float  # relief valve's inlet
    p2: float  # lower chamber
    p3: float  # upper chamber


OBSERVED = (
    *("position", "velocity", "spool", "p_pump", "p1", "p_p", "p_a", "p_lower", "p_upper", "p_b", "p_t", "p_return"),
    *("cavity_lower", "cavity_upper", "flow_1", "flow_2", "flow_3", "flow_4", "flow_5", "flow_6"),
    *("flow_pump", "flow_relief", "oil_stored", "oil_pumped", "oil_relieved", "oil_returned"),
)


def record(parameters: tuple[Any, ...]) -> NDArray[Any]:
    """A nested NamedTuple of floats as a structured array of length 1, which kernels read by the same names."""
    return np.array([_plain(parameters)], dtype=_dtype(parameters))


def _plain(value: tuple[Any, ...]) -> tuple[Any, ...]:
    return tuple(_plain(entry) if isinstance(entry, tuple) else entry for entry in value)


def _dtype(value: Any) -> Any:
    return [(k, _dtype(v) if isinstance(v, tuple) else "f8") for k, v in zip(value._fields, value, strict=True)]


def flatten(state: State) -> NDArray[np.float64]:
    """A state as an array of its numbers, in order."""
    return np.array([number for part in state for number in part])


@kernel
def _load(a) -> State:
    return State(
        Stored(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8]),
        Flows(a[9], a[10], a[11], a[12], a[13], a[14]),
        Piston(a[15], a[16]),
        Spool(a[17], a[18]),
        Ledger(a[19], a[20], a[21]),
    )


@kernel
def _store(s: State, a) -> None:
    for i in range(9):
        a[i] = s.oil[i]
    for i in range(6):
        a[9 + i] = s.flows[i]
    for i in range(2):
        a[15 + i] = s.piston[i]
        a[17 + i] = s.spool[i]
    for i in range(3):
        a[19 + i] = s.ledger[i]


def unflatten(array: NDArray[np.float64]) -> State:
    """The state back from its numbers."""
    return _load(array)


@kernel
def _tap(s: State, p, row) -> None:
    row[0], row[1], row[2], row[3], row[4] = s.piston.position, s.piston.velocity, p.tee, p.lower, p.upper


@kernel
def run_block(state, reference: float, circuit, steps: int, taps) -> None:
    """Advance a flat state in place by `steps` under a constant spool reference.

    circuit: a record of Circuit. taps: shape (2, 5), filled with the Taps a step before the end and at the end.
    """
    c = circuit[0]
    s = _load(state)
    p = pressures(s, c)
    _tap(s, p, taps[1])
    for i in range(steps):
        if i == steps - 1:
            _tap(s, p, taps[0])
        s, p = step_once(s, p, reference, c)
    _tap(s, p, taps[1])
    _store(s, state)


@kernel
def observe(state, circuit, out) -> None:
    """Fill `out` with the OBSERVED quantities of a flat state."""
    c = circuit[0]
    s = _load(state)
    p = pressures(s, c)
    out[0], out[1], out[2] = s.piston.position, s.piston.velocity, s.spool.position
    for i in range(9):
        out[3 + i] = p[i]
    out[12], out[13] = chamber_cavities(s, c)
    for i in range(6):
        out[14 + i] = s.flows[i]
    out[20] = pump_flow(p.pump, c.pump)
    out[21] = relief_flow(p.tee, c.relief)
    total = 0.0
    for i in range(9):
        total += s.oil[i]
    out[22] = total
    for i in range(3):
        out[23 + i] = s.ledger[i]


def compiled_for(circuit: Circuit) -> NDArray[Any]:
    """The circuit as a record, with the kernels above compiled for it and called once."""
    parameters = record(circuit)
    state = np.full(22, 1e-3)
    run_block(state, 0.0, parameters, 1, np.zeros((2, 5)))
    observe(state, parameters, np.zeros(len(OBSERVED)))
    return parameters
