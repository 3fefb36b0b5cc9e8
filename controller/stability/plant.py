"""A linear plant with one input, and what it does while that input is held: the ground of every sampled loop here.

Source of the actuator: (5.27), the linear actuator about its middle, z1 = y1, z2 = y2, a = alpha (y3 - y4), which
leaves no alpha. All matrices may be stacked: leading axes are parameters, the last two are rows and columns.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm, matrix_balance

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]
SQRT2 = 2.0**0.5


class Plant(NamedTuple):
    """x' = a x + b u. The rows read what the controller samples; the same unit of time throughout."""

    a: Array  # (..., n, n)
    b: Array  # (..., n)
    position: Array  # (n,)
    velocity: Array | None  # (n,); None: no tachometer


def linear_actuator(k: ArrayLike, gamma: ArrayLike) -> Plant:
    """z1' = z2, z2' = a - k z2, a' = -2 z2 + sqrt2 gamma u, dimensionless; arrays of k and gamma give a stack."""
    k, gamma = np.broadcast_arrays(np.asarray(k, float), np.asarray(gamma, float))
    a, b = np.zeros((*k.shape, 3, 3)), np.zeros((*k.shape, 3))
    a[..., 0, 1] = a[..., 1, 2] = 1.0
    a[..., 1, 1], a[..., 2, 1] = -k, -2.0
    b[..., 2] = SQRT2 * gamma
    return Plant(a, b, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))


def plant_of(
    system: "StateSpace", entry: int | str = 0, position: int | str = 0, velocity: int | str | None = 1
) -> Plant:
    """Plant of a continuous control.StateSpace, such of `twin.circuit.linear.linearise`.

    Entry and outputs by index or name.

    velocity None: there is no tachometer. Raises ValueError for a sampled system, an unknown name, and an output that
    the input reaches at once (it could not be sampled before the command it causes).
    """
    if system.dt not in (0, None):
        raise ValueError(f"the plant is sampled at {system.dt} s already; give the continuous one")
    column = _index(entry, system.input_labels, "input")
    rows = [_index(name, system.output_labels, "output") for name in (position, velocity) if name is not None]
    if np.any(np.asarray(system.D)[rows, column]):
        raise ValueError(f"output {rows} answers input {column} without any lag; leave out the direct path")
    outputs = [np.array(system.C[row], float) for row in rows]
    return Plant(np.array(system.A, float), np.array(system.B, float)[:, column], outputs[0], (*outputs, None)[1])


def _index(name: int | str, labels: list[str], what: str) -> int:
    if isinstance(name, str) and name in labels:
        return labels.index(name)
    if isinstance(name, str) or not 0 <= name < len(labels):
        raise ValueError(f"{what} {name!r} is none of {', '.join(labels)}, nor an index below {len(labels)}")
    return name


def zero_order_hold(plant: Plant, time: ArrayLike) -> tuple[Array, Array]:
    """Phi = exp(a t) and Gamma, its integral over [0, t] times b: a held input u makes Phi x + Gamma u.

    time broadcasts with the stack. A single plant is balanced first (by powers of two, which round nothing): its
    states may have units as far apart as pascal and metre.
    """
    time, n = np.asarray(time, float), plant.b.shape[-1]
    whole = np.zeros((*plant.b.shape[:-1], n + 1, n + 1))
    whole[..., :n, :n], whole[..., :n, n] = plant.a, plant.b
    scale = np.diag(matrix_balance(whole, permute=False)[1]) if whole.ndim == 2 else np.ones(n + 1)
    spread = scale[:, None] / scale
    flow = np.asarray(spread * expm(whole / spread * time[..., None, None]), float)
    return flow[..., :n, :n], flow[..., :n, n]
