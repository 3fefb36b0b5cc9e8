"""What the tests of the plant share: circuits with some numbers changed, runs, and the energy of a state."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from twin.block import OBSERVED, advance, compiled, run_block
from twin.build import build
from twin.circuit import Circuit
from twin.rig import values
from twin.state import State, flatten, flows, pressures, unflatten

BAR = 1e5
FRICTIONLESS = {"limit": 0.0}
TIGHT = {"leakage_resistance": math.inf}
SMOOTH = {"ripple": "none"}


def pipes(**entries: str | float) -> dict[str, Any]:
    """The same entries for all six pipes, e.g. pipes(model="lumped")."""
    return {f"pipe_{number}": dict(entries) for number in range(1, 7)}


def circuit(step: float = 50e-6, **parts: Any) -> Circuit:
    """The rig with some of its values replaced, e.g. load={"mass": 302.0}."""
    return build(values(parts), step)


def run(s: State, reference: float, c: Circuit, seconds: float) -> State:
    return advance(s, reference, c, round(seconds / c.parts.step))


def states(s: State, reference: float, c: Circuit, seconds: float, every: int = 1) -> Iterator[State]:
    """The states after each `every` steps."""
    flat, view, taps, seen = flatten(s), compiled(c), np.zeros((2, 5)), np.zeros(len(OBSERVED))
    for _ in range(round(seconds / (every * c.parts.step))):
        run_block(flat, reference, *view, every, taps, seen)
        yield unflatten(flat)


def energy(s: State, c: Circuit) -> float:
    """Kinetic energy of load and lines, oil compression and height [J]; lines lumped, no cavity, no weight to join.

    In a moving chamber the oil's share is right within p/2B. A lumped line's flow is staggered by half a step.
    """
    p, q, lines, cylinder = pressures(s), flows(s), c.lines, c.parts.cylinder
    at = ((p.pump, p.tee), (p.tee, p.p), (p.a, p.lower), (p.b, p.upper), (p.t, p.back), (p.back, 0.0))
    oil = sum(0.25 * lines.capacity[i] * (a**2 + b**2) for i, (a, b) in enumerate(at))
    flow = sum(0.5 * lines.inertance[i] * through**2 for i, through in enumerate(q))
    x, load = s.piston.position, c.parts.load
    v_lower = cylinder.dead_lower + cylinder.area_lower * x
    v_upper = cylinder.dead_upper + cylinder.area_upper * (cylinder.stroke - x)
    chambers = 0.5 * (v_lower * p.lower**2 + v_upper * p.upper**2) / cylinder.bulk_modulus
    return float(oil + flow + chambers + 0.5 * load.mass * s.piston.velocity**2 + load.mass * load.gravity * x)
