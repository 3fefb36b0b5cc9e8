"""What the tests of the plant share: circuits with some numbers changed, runs, and the energy of a state."""

import math
from collections.abc import Iterator

from twin.circuit import Circuit, State, advance, nodes, pressures
from twin.rig import build, numbers

BAR = 1e5
FRICTIONLESS = {"limit": 0.0}
TIGHT = {"leakage_resistance": math.inf}


def circuit(step: float = 50e-6, **parts: dict[str, float]) -> Circuit:
    """The rig with some numbers in place of its own, e.g. load={"mass": 302.0}."""
    return build(numbers(parts), step)


def run(s: State, reference: float, c: Circuit, seconds: float) -> State:
    return advance(s, reference, c, round(seconds / c.step))[0]


def states(s: State, reference: float, c: Circuit, seconds: float, every: int = 1) -> Iterator[State]:
    """The states after each `every` steps."""
    for _ in range(round(seconds / (every * c.step))):
        s = advance(s, reference, c, every)[0]
        yield s


def energy(s: State, c: Circuit) -> float:
    """Kinetic energy of load and lines, oil compression and height [J], no cavity. In a moving chamber the oil's
    share is right within p/2B."""
    p = pressures(s, c)
    lines = (c.line_1, c.line_2, c.line_3, c.line_4, c.line_5, c.line_6)
    oil = sum(0.5 * n.capacity * at**2 for n, at in zip(nodes(s.oil, s.piston.position, c), p, strict=True))
    flow = sum(0.5 * line.inertance * q**2 for line, q in zip(lines, s.flows, strict=True))
    load = c.load
    return oil + flow + 0.5 * load.mass * s.piston.velocity**2 + load.mass * load.gravity * s.piston.position
