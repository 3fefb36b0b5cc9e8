"""The tests of 2.6 on a circuit, in process: load change, hold, restart, impingement, at a pump speed.

The course is that of figure 2.28 in time and places; a run starts at rest shortly before the first command. Columns
are the true states every millisecond.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.kinds import of_kind
from twin.circuit.state import flatten
from twin.circuit.step import Circuit
from twin.pump import Pump
from twin.rig import values
from twin.topology import OBSERVED

Array = NDArray[np.float64]
Columns = dict[str, Array]
SPEEDS = (502, 800, 1035, 1230)  # [rpm]
BEGIN = 0.9  # [s], where a run starts
UP = 0.976  # [s], first command, 2.6
LIFT = {502: 0.69, 800: 0.39, 1035: 0.29, 1230: 0.24}  # [s] up, to about the middle
RESTART = {502: 3.0, 800: 2.6, 1035: 2.6, 1230: 2.6}  # [s]
END = {502: 3.0, 800: 2.6, 1035: 2.6, 1230: 3.3}  # [s]: the impingement is told at the highest speed
STEP, EVERY = 50e-6, 20  # [s], steps between two rows
TEST = {"valve": {"kind": "switching"}, "load": {"mass": 120.0, "added": 183.0}}


class Course(NamedTuple):
    """A run over time."""

    time: Array  # [s]
    columns: Columns  # OBSERVED quantities

    def between(self, name: str, begin: float, end: float) -> Array:
        """A column in a window of time [s]."""
        return self.columns[name][(self.time >= begin) & (self.time <= end)]


def circuit_for(overrides: Mapping[str, Mapping[str, Any]]) -> Circuit:
    """The rig of the test, at the highest speed of the pump, with some numbers replaced."""
    parts = {part: dict(entries) for part, entries in overrides.items()}
    for part, entries in (*TEST.items(), ("pump", {"speed": max(SPEEDS) / 60.0})):
        parts[part] = {**parts.get(part, {}), **entries}
    return build(values(parts), STEP)


def at_speed(circuit: Circuit, speed: int) -> Circuit:
    """The same with another speed [rpm] of its pump."""
    pump, ratio = of_kind(circuit.parts.supply, Pump), speed / max(SPEEDS)
    pump = pump._replace(delivery=ratio * pump.delivery, tooth_frequency=ratio * pump.tooth_frequency)
    return circuit._replace(parts=circuit.parts._replace(supply=pump))


def reference(time: float, speed: int) -> float:
    """Spool reference at a time [s]."""
    return float(UP <= time < UP + LIFT[speed] or time >= RESTART[speed])


def run(circuit: Circuit, speed: int, place: float) -> Course:
    """The test at a pump speed [rpm] from a place [m], up to its restart or, at the highest, its impingement."""
    circuit = at_speed(circuit, speed)
    advance, state, (taps, _) = block_of(compiled(circuit)), flatten(equilibrium(circuit, place)), buffers()
    seen = np.zeros((round((END[speed] - BEGIN) / (EVERY * STEP)), len(OBSERVED)))
    time = BEGIN + EVERY * STEP * np.arange(1.0, len(seen) + 1.0)
    for row, now in zip(seen, time.tolist(), strict=True):
        advance(state, reference(now - 0.5 * EVERY * STEP, speed), EVERY, taps, row)
    return Course(time, dict(zip(OBSERVED, seen.T, strict=True)))
