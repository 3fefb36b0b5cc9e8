"""The valve at the end of a line in time: the rig's own model of a line, and the poppet of `system.py` at its end.

Dimensionless as there; one line, its far end at constant pressure or flow, no further volume. Poppet by the velocity
Verlet rule, its lift known before the pressure: p = c - z phi(y1, p) is a quadratic in sqrt(p) or linear.
"""

import math

import numpy as np
from numpy.typing import NDArray

from twin.chatter.equilibrium import rest
from twin.chatter.inlet_line import InletLine
from twin.chatter.system import System
from twin.kernel import allocating_kernel, inlined
from twin.lines.bank import arriving, bank_of, departing, settle, steady_drop
from twin.lines.spec import LineSpec

Array = NDArray[np.float64]
FRICTION = {"none": "none", "steady": "steady", "unsteady": "unsteady"}


def spec(line: InletLine) -> LineSpec:
    """A pipe of density 1 and length travel_time that is this line."""
    diameter = math.sqrt(4.0 / (math.pi * line.impedance))
    return LineSpec(
        line.travel_time, diameter, 1.0, 1.0, diameter**2 / (4.0 * line.viscous_time), "ends", FRICTION[line.losses]
    )


@inlined
def seat_pressure(c: float, z: float, y1: float, chamfered: bool) -> float:
    """y3 with y3 = c - z phi."""
    y1 = max(y1, 0.0)
    if not chamfered:
        return c / (1.0 + z * y1**3)
    if c <= 0.0:
        return c
    b = z * y1
    root = 2.0 * c / (b + math.sqrt(b * b + 4.0 * c))
    return root * root


@allocating_kernel
def _run(y1, y2, y3, source, constant_flow, chamfered, bank, memory, steps, s):
    lifts = np.empty(steps)
    c, z, q = np.empty(2), np.empty(2), np.empty(2)
    h, force = bank.step, y3 - y1 - s.precompression - s.damping * y2
    for tick in range(steps):
        half = y2 + 0.5 * h * force
        y1 = y1 + h * half
        if y1 < 0.0:
            y1, half = 0.0, -s.restitution * half
        arriving(bank, memory, tick, c, z)
        y3 = seat_pressure(c[1], z[1], y1, chamfered)
        q[0] = source if constant_flow else (source - c[0]) / z[0]
        q[1] = (y3 - c[1]) / z[1]
        departing(bank, memory, tick, q)
        y2 = (half + 0.5 * h * (y3 - y1 - s.precompression)) / (1.0 + 0.5 * h * s.damping)
        force = y3 - y1 - s.precompression - s.damping * y2
        lifts[tick] = y1
    return lifts


def run(system: System, line: InletLine, time: float, step: float, push: float = 1e-3) -> Array:
    """Lifts at the steps of a run from the equilibrium, its lift pushed by a share; for a line without a volume."""
    if line.volume != 0.0:
        raise ValueError(f"volume {line.volume} at the valve: a run in time takes the line alone, volume 0.0")
    at, bank = rest(system), bank_of([spec(line)], step, -1e12)
    memory = np.zeros(bank.size)
    # the line's unit of flow: beta Y belongs to beta (q - phi), so phi enters as it is
    inlet = at.pressure + steady_drop(bank, 0, system.flow)
    settle(bank, memory, np.array([inlet, at.pressure]), np.array([system.flow]))
    constant = line.far_end == "flow"
    chamfered = system.law.lift == 1.0
    source = system.flow if constant else inlet
    return _run(
        at.lift * (1.0 + push), 0.0, at.pressure, source, constant, chamfered, bank, memory, round(time / step), system
    )
