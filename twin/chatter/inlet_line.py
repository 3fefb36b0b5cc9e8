"""The valve at the end of a line: where the line's quarter wave makes it sing.

The line, with its exact laminar losses, takes the place of the volume or comes before it. Seen from the valve it is an
admittance Y(s), and (4.12), (4.40) become `(s^2 + k s + 1)(a3 + b Y(s)) + a1 = 0`, b Y = s for the volume alone. On
the imaginary axis this gives k and w apart: `1 - w^2 = -Re h(w)`, `k w = -Im h(w)`, h = a1/(a3 + b Y(iw)). A line takes
energy only, so Re Y > 0 and 1 < w^2 < 1 + a1/a3: whatever the line, a valve sings above its own frequency.
"""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from twin.chatter.equilibrium import Onset, gains
from twin.chatter.system import System
from twin.lines.theory import losses

FAR_ENDS = ("pressure", "flow")  # constant at the other end: a large vessel; a pump


class InletLine(NamedTuple):
    """A line before the valve, in the valve's units: time 1/omega, impedance p_ref/Q_ref."""

    travel_time: float  # omega T
    viscous_time: float  # omega R^2/nu
    impedance: float  # Z0 Q_ref/p_ref
    losses: str  # none | steady | unsteady
    far_end: str  # of FAR_ENDS
    volume: float  # oil at the valve, 1.0: that of beta; 0.0: none


def admittance(s: complex, line: InletLine, beta: float) -> complex:
    """b Y(s): the volume at the valve, and the line with its other end."""
    n = np.sqrt(losses(np.complex128(s), line.viscous_time, line.losses))
    through = np.tanh(s * line.travel_time * n)
    ratio = through if line.far_end == "flow" else 1.0 / through
    return line.volume * s + beta * ratio / (n * line.impedance)


def line_onsets(system: System, line: InletLine) -> list[Onset]:
    """All swings that some damping k > 0 just keeps up, the one that needs most first; empty: always calm.

    Raises ValueError for a far end that is none of FAR_ENDS.
    """
    if line.far_end not in FAR_ENDS:
        raise ValueError(f"far end {line.far_end!r} is none of {', '.join(FAR_ENDS)}")
    a1, a3 = gains(system)

    def answer(w: float) -> complex:
        return a1 / (a3 + admittance(1j * w, line, system.beta))

    def balance(w: float) -> float:
        return 1.0 - w * w + answer(w).real

    top = math.sqrt(1.0 + a1 / a3)
    grid = np.linspace(1.0, top, 400 + int(60.0 * (top - 1.0) * line.travel_time))
    # resonances of the line just above 1 are as narrow as its losses: look closely there
    near = 1.0 + np.geomspace(1e-9, min(0.1, top - 1.0), 300)
    values = [(w, balance(w)) for w in np.union1d(grid, near)]
    found = []
    for (w0, b0), (w1, b1) in pairwise(values):
        if b0 * b1 < 0.0:
            w = float(brentq(balance, w0, w1, xtol=1e-15))  # pyright: ignore[reportArgumentType]
            k = -answer(w).imag / w
            if k > 0.0:
                found.append(Onset(k, w, _speed(w, k, system, line)))
    return sorted(found, reverse=True)


def _speed(w: float, k: float, system: System, line: InletLine) -> float:
    """d Re(s)/dk at a root on the axis, by the implicit function; derivative by s by a difference along the axis."""
    a1, a3 = gains(system)

    def characteristic(s: complex) -> complex:
        return (s * s + k * s + 1.0) * (a3 + admittance(s, line, system.beta)) + a1

    s, d = 1j * w, 1e-6j
    by_s = (characteristic(s + d) - characteristic(s - d)) / (2.0 * d)
    return float((-s * (a3 + admittance(s, line, system.beta)) / by_s).real)


def critical_damping(system: System, line: InletLine) -> float:
    """k above which the valve is calm with its line; 0.0 where it is calm without any."""
    found = line_onsets(system, line)
    return found[0].damping if found else 0.0
