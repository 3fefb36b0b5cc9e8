"""Frequency response of a line: the exact one, and what each scheme makes of it, discrete in space and in time.

A response is an array (n, 2, 2) of T at n frequencies omega [rad/s], (p_1, Q_1) = T (p_2, Q_2), Q [m^3/s] from end 1 to
end 2. A scheme's is exact for the scheme: its own difference equations at z = exp(i omega h).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from twin.lines.lab.exact import transfer_matrix
from twin.lines.lab.friction import Friction, convolution_weights, recursion
from twin.lines.lab.pipe import PRESSURE, VELOCITY, Array, Case, End, Pipe, closed, constant, reservoir
from twin.lines.lab.propagate import propagator
from twin.lines.lab.rig_line import rig_modes
from twin.lines.lab.space import Grid
from twin.lines.lab.system import LineSystem, line_system
from twin.lines.lab.tableau import PAIRS

if TYPE_CHECKING:
    from control import FrequencyResponseData

Complex = Any  # NDArray[complex128], which numpy's own annotations lose on the way
FAR_ENDS = ("held", "closed")
REMEMBERED = 4000  # steps of the convolution's kernel


def exact_response(pipe: Pipe, friction: str, omega: Array) -> Complex:
    """The exact line; friction: none, steady or unsteady."""
    return transfer_matrix(1j * np.asarray(omega), pipe, friction)


def impedance(matrices: Complex, far: str = "held") -> Complex:
    """p_1/Q_1 [Pa s/m^3] with end 2 held at constant pressure, or closed."""
    if far not in FAR_ENDS:
        raise ValueError(f"far end {far!r} unknown; known: {', '.join(FAR_ENDS)}")
    t = matrices
    return t[:, 0, 1] / t[:, 1, 1] if far == "held" else t[:, 0, 0] / t[:, 1, 0]


def frequency_response_data(omega: Array, response: Complex) -> FrequencyResponseData:
    """For python-control: of an impedance (n,), or of T (n, 2, 2)."""
    from control import FrequencyResponseData

    values = np.asarray(response)
    return FrequencyResponseData(values if values.ndim == 1 else np.moveaxis(values, 0, -1), omega)


def lines_response(pipe: Pipe, grid: Grid, time: str, model: Friction, step: float, omega: Array) -> Complex:
    """The method of lines on a grid; time: of `integrate.TIMES`, or "exact" for the semi-discrete line."""
    if not model.linear:
        raise ValueError(f"friction {model.name} is not linear and has no frequency response")
    ends = {PRESSURE: reservoir(0.0), VELOCITY: closed()}
    answers = {}
    for holds, end in ends.items():
        system, _ = line_system(Case(pipe, End(VELOCITY, constant(0.0)), end, 0.0, 0.0), grid, model)
        if time in PAIRS:
            found = _by_stages(system, time, step, omega)
        else:
            found = np.array([_by_symbol(system, s) for s in _symbol(time, step, omega)])
        n, per_u = system.nodes, pipe.area / pipe.hammer
        answers[holds] = found[:, 0], found[:, n - 1], found[:, 2 * n - 1] * per_u, per_u
    p_open, _, q_open, q = answers[PRESSURE]
    p_shut, far, _, _ = answers[VELOCITY]
    return _matrices(p_shut / far, p_open / q_open, q / far, q / q_open)


def _matrices(t_11: Complex, t_12: Complex, t_21: Complex, t_22: Complex) -> Complex:
    return np.moveaxis(np.array([[t_11, t_12], [t_21, t_22]]), 2, 0)


def _symbol(time: str, step: float, omega: Array) -> Complex:
    """What stands for s in a linear multistep scheme."""
    late = np.exp(-1j * np.asarray(omega) * step)
    if time == "exact":
        return 1j * np.asarray(omega)
    if time == "backward-euler":
        return (1.0 - late) / step
    if time == "bdf2":
        return (1.5 - 2.0 * late + 0.5 * late**2) / step
    raise ValueError(f"time {time!r} unknown; known: exact, backward-euler, bdf2, {', '.join(PAIRS)}")


def _by_symbol(system: LineSystem, s: complex) -> Complex:
    """y for u_1 = 1 Pa at a value of s."""
    frozen = system.freeze(np.zeros(2 * system.nodes))
    share = complex((system.model.weights * s / (s + system.alpha)).sum())
    right = np.zeros(2 * system.nodes, complex)
    right[system.nodes] = 1.0
    return splu(sparse.csc_array(s * system.mass - system.with_friction(share, frozen))).solve(right)


def _by_stages(system: LineSystem, time: str, step: float, omega: Array) -> Complex:
    """The same of a Runge-Kutta scheme: z x = R x + r e^(i omega c h)."""
    one, k = propagator(system, time, step), list(system.rows).index(system.nodes)
    eye, out = np.eye(len(one.matrix)), []
    for turn in np.asarray(omega) * step:
        drive = np.exp(1j * turn * one.stages) @ one.drive[:, k]
        out.append(np.linalg.solve(np.exp(1j * turn) * eye - one.matrix, drive)[: 2 * system.nodes])
    return np.array(out)


def characteristics_response(pipe: Pipe, model: Friction, cells: int, omega: Array, courant: float = 1.0) -> Complex:
    """The method of characteristics: one cell's matrix to the power of their number."""
    if not model.linear:
        raise ValueError(f"friction {model.name} is not linear and has no frequency response")
    step = courant * pipe.travel_time / cells
    late = np.exp(-1j * np.asarray(omega) * step)
    phi = 0.5 * step * _friction_symbol(pipe, model, step, late)
    own, moved = 1.0 - (1.0 - courant) * late, courant * late
    ahead = (1.0 + phi) - (1.0 - courant) * late * (1.0 - phi)
    left = np.array([[own, ahead], [moved, -moved * (1.0 - phi)]])  # of (p_j, u_j)
    right = np.array([[moved, moved * (1.0 - phi)], [own, -ahead]])  # of (p_j-1, u_j-1)
    cell = np.linalg.solve(np.moveaxis(right, 2, 0), np.moveaxis(left, 2, 0))
    whole = np.array([np.linalg.matrix_power(one, cells) for one in cell])
    per_u = pipe.area / pipe.hammer
    return whole * np.array([[1.0, 1.0 / per_u], [per_u, 1.0]])


def _friction_symbol(pipe: Pipe, model: Friction, step: float, late: Complex) -> Complex:
    """f/u at z, late = 1/z."""
    total = np.zeros_like(late)
    for decay, gain in zip(*recursion(model, pipe.viscous_time, step), strict=True):
        total += gain * (1.0 - late) / (1.0 - decay * late)
    if model.convolved:
        weights = convolution_weights(pipe.viscous_time, step, REMEMBERED)
        total += (1.0 - late) * np.polyval(weights[::-1], late)
    return model.steady * pipe.steady_rate + 4.0 / pipe.viscous_time * total


def rig_response(pipe: Pipe, model: Friction, step: float, omega: Array) -> Complex:
    """The rig's real-time line `ends` at a step [s]."""
    alike, opposite = rig_modes(pipe, model, step, np.asarray(omega))
    own, cross = 0.5 * (alike + opposite), 0.5 * (alike - opposite)
    return _matrices(own / cross, (own**2 - cross**2) / cross, 1.0 / cross, own / cross)
