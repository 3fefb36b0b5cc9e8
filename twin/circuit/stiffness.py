"""Oil that becomes stiffer or softer while a circuit runs: no oil comes or goes, so the pressures change.

Of lines without waves half of the oil stands at each end, C p, or all of it in one volume; of a chamber S = V (1 +
p/B). What a wall has taken late stays in it. A line with waves keeps those that are under way, and a change of their
speed cannot be had.

A lumped line meets a chamber without inertia between them: both are one store, whose pressure is one. Where they become
softer in different measure, oil passes at once until they have jumped alike. Nothing in the scheme would do it later:
the trapezoidal rule lets the flow between them swing from step to step for ever.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.accessory import Joined
from twin.actuator import areas, chamber_pressures, moduli, outside, volumes, widening
from twin.air import compressibility, compression
from twin.circuit.state import ENDS_AT, LINES_AT, MEMORY_AT, load, store
from twin.circuit.step import LOWER, UPPER, Circuit
from twin.cylinder import Chambers
from twin.kernel import interpreted
from twin.lines import lumped, volume
from twin.topology import END_COUNT

HALVES = 60  # of an interval: to the last bit


def keep_oil(state: NDArray[np.float64], before: Circuit, after: Circuit) -> None:
    """Give a flat state, in place, the pressures that its oil has in another circuit of the same lines.

    Nothing changes where the capacities are the same.
    """
    old = _at_chambers(state, before)
    for lines, places, pressures_at in (
        (after.lines.lumped_lines, after.lines.lumped_place, lumped.PRESSURES_AT),
        (after.lines.volume_lines, after.lines.volume_place, volume.PRESSURES_AT),
    ):
        for line, place in zip(lines, places, strict=True):
            share = before.lines.capacity[line] / after.lines.capacity[line]
            state[MEMORY_AT + place + pressures_at] *= share
    if interpreted(moduli)(after.parts.cylinder) != interpreted(moduli)(before.parts.cylinder):
        core = load(state)
        pressures = interpreted(chamber_pressures)(core.chambers, core.piston.position, after.parts.cylinder)
        state[ENDS_AT + LOWER], state[ENDS_AT + UPPER] = pressures
    if isinstance(after.parts.necks, Joined):
        for joint, then in zip(old, _at_chambers(state, after), strict=True):
            _level(state, joint, then, after)


class _Joint(NamedTuple):
    """Where a lumped line meets a chamber."""

    side: int  # of the chamber, 0: lower, 1: upper
    line: int
    place: int  # of the line's memory in a flat state
    chamber: float  # pressure [Pa]
    own: float  # that of the line's end


def _at_chambers(state: NDArray[np.float64], circuit: Circuit) -> list[_Joint]:
    joints = []
    for side, end in enumerate((LOWER, UPPER)):
        for line, at in zip(circuit.lines.lumped_lines, circuit.lines.lumped_place, strict=True):
            if line == end // 2:
                place = MEMORY_AT + int(at)
                own = float(state[place + lumped.SECOND_PRESSURE])
                joints.append(_Joint(side, int(line), place, float(state[ENDS_AT + end]), own))
    return joints


def _level(state: NDArray[np.float64], before: _Joint, now: _Joint, circuit: Circuit) -> None:
    """Let oil pass between a chamber and its line's end until both have jumped alike; it flows on as both swell."""
    gap = (now.own - before.own) - (now.chamber - before.chamber)
    if gap == 0.0:
        return
    capacity = 0.5 * float(circuit.lines.capacity[now.line])
    passed = _passed(state, now, gap, capacity, circuit)
    core = load(state)
    stored = [*core.chambers]
    stored[now.side] += passed
    store(core._replace(chambers=Chambers(*stored)), state)
    state[LINES_AT + now.line] -= passed
    state[now.place + lumped.SECOND_AT] -= passed / capacity
    _set_flow(state, now, capacity, circuit)


def _passed(state: NDArray[np.float64], now: _Joint, gap: float, capacity: float, circuit: Circuit) -> float:
    """Oil [m^3] from the line into the chamber; by halves, since a chamber may be hollow or have air in it."""
    core, actuator = load(state), circuit.parts.cylinder

    def lacks(oil: float) -> float:
        held = [*core.chambers]
        held[now.side] += oil
        p = interpreted(chamber_pressures)(Chambers(*held), core.piston.position, actuator)[now.side]
        return gap - oil / capacity - (p - now.chamber)

    none, most = 0.0, gap * capacity
    for _ in range(HALVES):
        middle = 0.5 * (none + most)
        none, most = (middle, most) if lacks(middle) * gap > 0.0 else (none, middle)
    return 0.5 * (none + most)


def _set_flow(state: NDArray[np.float64], now: _Joint, capacity: float, circuit: Circuit) -> None:
    """The pressure and the flow of a joint: one rate for both, (q + Q)/C = (-q - G)/C_chamber; G: what it swallows."""
    actuator, core, end = circuit.parts.cylinder, load(state), (LOWER, UPPER)[now.side]
    x, v = core.piston
    p = interpreted(chamber_pressures)(core.chambers, x, actuator)
    state[ENDS_AT + LOWER], state[ENDS_AT + UPPER] = p
    way, modulus = (1.0, -1.0)[now.side], interpreted(moduli)(actuator)[now.side]
    dense = interpreted(compression)(actuator.air, modulus, p[now.side]) if interpreted(widening)(actuator) else 1.0
    grown = way * interpreted(areas)(actuator, x)[now.side] * v * dense
    leaked = way * actuator.leakage * (p.lower - p.upper) + interpreted(outside)(actuator, p)[now.side] * p[now.side]
    volume = interpreted(volumes)(actuator, x)[now.side]
    held = (
        math.inf
        if p[now.side] == actuator.vapour_pressure
        else volume * interpreted(compressibility)(actuator.air, modulus, p[now.side])
    )
    share = 1.0 / (1.0 + capacity / held)
    through = float(state[now.place + lumped.FLOW])
    flow = -share * through - (1.0 - share) * (grown + leaked)
    at, impedance = ENDS_AT + END_COUNT + end, circuit.parts.step / (2.0 * capacity)
    state[now.place + lumped.SECOND_FREE] += impedance * (flow - state[at])
    state[at] = flow
