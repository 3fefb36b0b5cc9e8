"""The two scattering filters of a line in z, and what they answer.

    S11 ~ a0 + sum aA_i P_i + fB_0 z^-mB + fB_1 z^-(mB+1) + z^-round(2M) sum aB_i P_i,   P_i = (1-p_i)/(1-p_i z^-1)
    S12 ~ sum_(j<8) fD_j z^-(m0+j) + z^-round(M) sum aD_i P_i,                           M = T/h, p_i = exp(-h/tau_i)

a = p + Z0 q, b = p - Z0 q at each end (q into the line): b1 = S11 a1 + S12 a2 and its mirror; S+- = S11 +- S12.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import allocating_kernel
from twin.lines.householder import Matrix
from twin.lines.theory import Complex

POLES = 8
TAPS = 8  # fD; a delay of a fraction of a step, flat nearly up to Nyquist


class Filters(NamedTuple):
    """The two filters of a line; arrays are in the order of the equations above."""

    poles: NDArray[np.float64]  # p
    direct: float  # a0
    own: NDArray[np.float64]  # aA
    echo: NDArray[np.float64]  # aB
    across: NDArray[np.float64]  # aD
    echo_taps: NDArray[np.float64]  # fB
    taps: NDArray[np.float64]  # fD
    echo_first: int  # mB
    first: int  # m0
    echo_delay: int  # round(2M)
    delay: int  # round(M)


def unknowns(line: Filters) -> int:
    return 1 + 3 * len(line.poles) + 2 + TAPS


def filled(empty: Filters, x: Matrix) -> Filters:
    """Filters of these poles and delays with the unknowns x = (a0, aA, fB, aB, fD, aD)."""
    n = len(empty.poles)
    at = np.cumsum([1, n, 2, n, TAPS])
    return empty._replace(
        direct=float(x[0]), own=x[1 : at[1]], echo_taps=x[at[1] : at[2]], echo=x[at[2] : at[3]],
        taps=x[at[3] : at[4]], across=x[at[4] :],
    )  # fmt: skip


def responses(theta: Matrix, line: Filters) -> tuple[Complex, Complex]:
    """Rows that give S+ and S- at z = exp(i theta) from the unknowns (a0, aA, fB, aB, fD, aD)."""
    z1 = np.exp(-1j * theta)[:, None]
    p = (1.0 - line.poles) / (1.0 - line.poles * z1)
    own = [np.ones_like(z1), p, z1 ** (line.echo_first + np.arange(2)), z1**line.echo_delay * p]
    across = [z1 ** (line.first + np.arange(TAPS)), z1**line.delay * p]
    return np.hstack(own + across), np.hstack(own + [-block for block in across])


@allocating_kernel
def scattering(theta, f):
    """S+ and S- of filters f at z = exp(i theta)."""
    plus, minus = np.zeros(len(theta), np.complex128), np.zeros(len(theta), np.complex128)
    for k in range(len(theta)):
        z1 = np.exp(-1j * theta[k])
        own, echo, across, passed = 0j, 0j, 0j, 0j
        for i in range(len(f.poles)):
            p = (1.0 - f.poles[i]) / (1.0 - f.poles[i] * z1)
            own += f.own[i] * p
            echo += f.echo[i] * p
            across += f.across[i] * p
        for j in range(len(f.taps) - 1, -1, -1):
            passed = passed * z1 + f.taps[j]
        own += f.direct + np.exp(-1j * theta[k] * f.echo_delay) * echo
        own += np.exp(-1j * theta[k] * f.echo_first) * (f.echo_taps[0] + f.echo_taps[1] * z1)
        passed = np.exp(-1j * theta[k] * f.first) * passed + np.exp(-1j * theta[k] * f.delay) * across
        plus[k], minus[k] = own + passed, own - passed
    return plus, minus


def lagrange(delay: float, count: int) -> Matrix:
    """Taps that delay by a number of steps in the middle of 0 .. count - 1."""
    at = np.arange(count)
    return np.array([float(np.prod((delay - np.delete(at, j)) / (j - np.delete(at, j)))) for j in at])
