"""What the tests of the plant share: circuits with some numbers changed, runs, and the energy of a state.

Laws are tested on a rig of numbers that stand still, those before the calibration, with every later effect off unless a
test asks for it; what the calibrated rig does is tested by its facts (`tests/bridge/test_calibration.py`).
"""

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.scenario import load
from twin.actuator import chamber_volumes
from twin.circuit.block import advance, block_of, buffers, compiled
from twin.circuit.build import build
from twin.circuit.kinds import of_kind
from twin.circuit.state import (
    State,
    flatten,
    pressures,
    unflatten,
)
from twin.circuit.step import Circuit
from twin.cylinder import Cylinder
from twin.load import Load
from twin.pump import Pump
from twin.relief.network import Relief
from twin.rig import values
from twin.seal import Seal
from twin.spool_valve import SpoolValve
from twin.topology import ENDS, OBSERVED

Array = NDArray[np.float64]
BAR = 1e5
FLOW = 2  # of a lumped line, where its memory has it
FRICTIONLESS = {"limit": 0.0}
TIGHT = {"leakage_resistance": math.inf}
SMOOTH = {"ripple": "none"}


def pipes(**entries: str | float) -> dict[str, Any]:
    """The same entries for all six pipes, e.g. pipes(model="lumped")."""
    return {f"pipe_{number}": dict(entries) for number in range(1, 7)}


def circuit(step: float = 50e-6, **parts: Any) -> Circuit:
    """The rig of the tests with some of its values replaced, e.g. load={"mass": 302.0}."""
    replaced = {part: {**bench().get(part, {}), **parts.get(part, {})} for part in {**bench(), **parts}}
    return build(values(replaced), step)


def cylinder_of(c: Circuit) -> Cylinder:
    return of_kind(c.parts.cylinder, Cylinder)


def load_of(c: Circuit) -> Load:
    return of_kind(c.parts.load, Load)


def pump_of(c: Circuit) -> Pump:
    return of_kind(c.parts.supply, Pump)


def relief_of(c: Circuit) -> Relief:
    return of_kind(c.parts.relief, Relief)


def seal_of(c: Circuit) -> Seal:
    return of_kind(c.parts.seal, Seal)


def valve_of(c: Circuit) -> SpoolValve:
    return of_kind(c.parts.valve, SpoolValve)


@cache
def bench() -> dict[str, dict[str, Any]]:
    """All numbers of the rig of the tests."""
    return load("assumed-rig").rig_values()


def run(s: State, reference: float, c: Circuit, seconds: float) -> State:
    return advance(s, reference, c, round(seconds / c.parts.step))


def states(s: State, reference: float, c: Circuit, seconds: float, every: int = 1) -> Iterator[State]:
    """The states after each `every` steps."""
    flat, run, taps, seen = flatten(s), block_of(compiled(c)), *buffers()
    for _ in range(round(seconds / (every * c.parts.step))):
        run(flat, reference, every, taps, seen)
        yield unflatten(flat)


def watched(s: State, reference: float, c: Circuit, seconds: float, every: int = 1) -> tuple[dict[str, Array], State]:
    """What can be OBSERVED after each `every` steps, a column each, and the state at the end."""
    flat, run, taps = flatten(s), block_of(compiled(c)), buffers()[0]
    seen = np.zeros((round(seconds / (every * c.parts.step)), len(OBSERVED)))
    for row in seen:
        run(flat, reference, every, taps, row)
    return dict(zip(OBSERVED, seen.T, strict=True)), unflatten(flat)


def joined(*parts: dict[str, Array]) -> dict[str, Array]:
    """Columns one after the other."""
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def energy(s: State, c: Circuit) -> float:
    """Kinetic energy of load and lines, oil compression and height [J]; lines lumped, no cavity, no weight to join.

    In a moving chamber the oil's share is right within p/2B. A line's flow is known half a step before and after: what
    the scheme keeps is their product.
    """
    lines, cylinder, load = c.lines, cylinder_of(c), load_of(c)
    p = s.ends.pressure[: len(ENDS)].reshape(-1, 2)
    after = s.memory[lines.lumped_place + FLOW]
    before = after - c.parts.step / lines.inertance * (p[:, 0] - p[:, 1])
    oil = float((0.25 * lines.capacity * (p**2).sum(axis=1) + 0.5 * lines.inertance * after * before).sum())
    x, at = s.piston.position, pressures(s)
    volume = chamber_volumes(x, cylinder)
    chambers = 0.5 * (volume.lower * at.lower**2 + volume.upper * at.upper**2) / cylinder.bulk_modulus
    return oil + chambers + 0.5 * load.mass * s.piston.velocity**2 + load.mass * load.gravity * x
