"""The rig's own real-time lines (`ends`, `nodes`, `lumped` of `twin/lines/bank.py`) on a case of the laboratory.

Cavitation as in the rig: no pressure below the vapour pressure, a cavity at each end that holds a velocity
(`twin/port.py`) and, in `nodes`, at every inner node.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import allocating_kernel
from twin.lines.bank import arriving, bank_of, departing, inner_cavity, memory_size, settle, steady_drop
from twin.lines.filters import scattering
from twin.lines.fit import fit
from twin.lines.lab.friction import Friction
from twin.lines.lab.pipe import PRESSURE, Array, Case, History, Pipe, sampled
from twin.lines.spec import LineSpec, derive
from twin.lines.theory import Line
from twin.port import Port, cavity, pressure, with_cavity

NEVER = -1e12  # [Pa], a vapour pressure that is not reached
FRICTIONS = {"none": "none", "steady": "steady", "quasi-steady": "quasi-steady", "fit": "unsteady"}


class RigHistory(NamedTuple):
    """Both ends, and the vapour in the line and at its ends."""

    ends: History
    vapour: Array  # [m^3]


def spec_of(pipe: Pipe, model: Friction, kind: str) -> LineSpec:
    """The rig's description of a pipe; kind: of `twin.lines.spec.MODELS`. ValueError: friction it does not have."""
    if model.name not in FRICTIONS:
        raise ValueError(f"the rig's lines have no friction {model.name}; take one of {', '.join(FRICTIONS)}")
    modulus = pipe.density * pipe.speed**2
    return LineSpec(
        pipe.length, pipe.diameter, modulus, pipe.density, pipe.viscosity, kind, FRICTIONS[model.name]
    )  # fmt: skip


@allocating_kernel
def _drive(bank, memory, of_pressure, values, vapour_pressure, out):
    """values (steps, 2): pressure [Pa], or inflow [m^3/s]; out (steps, 5): p_1, p_2, q_1, q_2 into the line, vapour."""
    c, z, q, v = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for tick in range(len(values)):
        arriving(bank, memory, tick, c, z)
        for end in range(2):
            p = values[tick, end]
            if not of_pressure[end]:
                port = with_cavity(Port(c[end], z[end]), v[end], bank.step)
                p = pressure(port, values[tick, end], vapour_pressure)
                v[end] = cavity(port, values[tick, end], vapour_pressure, bank.step)
            q[end] = (p - c[end]) / z[end]
            out[tick, end], out[tick, 2 + end] = p, q[end]
        departing(bank, memory, tick, q)
        out[tick, 4] = v[0] + v[1] + inner_cavity(bank, memory, 0)


def rig_line(
    case: Case, model: Friction, kind: str, step: float, span: float, vapour_pressure: float = NEVER
) -> RigHistory:
    """A run at a step [s], from t = 0 on (the first instant is that of a step later). ValueError: friction, or step."""
    try:
        bank = bank_of([spec_of(case.pipe, model, kind)], step, vapour_pressure)
    except ValueError as error:
        text = str(error).removeprefix("pipe_1, ").replace("loop.step", "step")
        raise ValueError(text) from None
    area, count = case.pipe.area, round(span / step)
    times = step * np.arange(1, count + 1)
    values, memory = np.zeros((count, 2)), np.zeros(memory_size(bank))
    for k, end in enumerate((case.left, case.right)):
        factor = 1.0 if end.holds == PRESSURE else (1.0 - 2.0 * k) * area
        values[:, k] = factor * sampled(end, times)
    flow = case.velocity * area
    drop = steady_drop(bank, 0, flow)
    low = case.pressure - (drop if case.anchored_left else 0.0)
    settle(bank, memory, np.array([low + drop, low]), np.array([flow]))
    out = np.zeros((count, 5))
    of_pressure = np.array([case.left.holds == PRESSURE, case.right.holds == PRESSURE])
    _drive(bank, memory, of_pressure, values, vapour_pressure, out)
    return RigHistory(History(times, out[:, 0], out[:, 1], out[:, 2] / area, -out[:, 3] / area), out[:, 4])


def rig_modes(pipe: Pipe, model: Friction, step: float, omega: Array) -> tuple[NDArray[np.complex128], ...]:
    """Impedances [Pa s/m^3] of an `ends` line with both ends alike and opposite, at omega [rad/s]."""
    line = derive(spec_of(pipe, model, "ends"))
    filters = fit(Line(line.travel_time, line.viscous_time, line.losses, step))
    plus, minus = (np.asarray(s) for s in scattering(omega * step, filters))
    return line.z0 * (1.0 + plus) / (1.0 - plus), line.z0 * (1.0 + minus) / (1.0 - minus)
