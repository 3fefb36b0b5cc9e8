"""The exact laminar line by numerical inversion of its Laplace transform, and runs of the models beside it.

Written apart from `twin/lines/theory.py` on purpose: impedances here, scattering there. Bromwich's integral as one
FFT; a second way, Talbot's contour echo by echo, checks it at single points (`tests/twin/test_line_ends.py`).
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ive

from twin.kernel import allocating_kernel
from twin.lines.bank import Bank, arriving, bank_of, departing, memory_size, settle
from twin.lines.spec import LineSpec

Array = NDArray[np.float64]
Complex = Any  # NDArray[complex128], which numpy's own annotations lose on the way
RAMP = 0.5e-3  # s
TRAVELS = 20  # how long is compared


class Pipe(NamedTuple):
    """A line by its wave speed."""

    length: float  # [m]
    diameter: float  # [m]
    viscosity: float  # nu [m^2/s]
    speed: float  # a [m/s]
    density: float = 870.0  # [kg/m^3]

    @property
    def travel_time(self) -> float:
        return self.length / self.speed

    @property
    def viscous_time(self) -> float:
        return self.diameter**2 / (4.0 * self.viscosity)

    @property
    def impedance(self) -> float:
        return self.density * self.speed / (math.pi / 4.0 * self.diameter**2)

    def spec(self, model: str = "ends", friction: str = "unsteady") -> LineSpec:
        modulus = self.density * self.speed**2
        return LineSpec(self.length, self.diameter, modulus, self.density, self.viscosity, model, friction)


CORNERS = [
    Pipe(length, d, nu, a)
    for length in (0.5, 40.0) for d in (8e-3, 20e-3) for nu in (10e-6, 100e-6) for a in (600.0, 1330.0)
]  # fmt: skip
MIDDLE = [
    Pipe(3.0, 10e-3, 46e-6, 1222.0), Pipe(5.0, 12e-3, 30e-6, 1000.0),
    Pipe(10.0, 16e-3, 46e-6, 1200.0), Pipe(5.0, 8e-3, 100e-6, 800.0),
]  # fmt: skip
STEEL, HOSE = 1137.0, 630.0
RIG_LENGTHS = ((1.0, STEEL), (2.5, STEEL), (2.0, STEEL), (2.0, HOSE), (1.5, HOSE))
PEER = Pipe(3.0, 10e-3, 0.040 / 870.0, math.sqrt(1.3e9 / 870.0))  # 1.3 GPa, 40 mPa s: measured elsewhere
PEER_SPAN = 0.1  # s
RIG = [Pipe(length, 11e-3, 40e-6, a, 878.0) for length, a in RIG_LENGTHS]
ENDS = ("flow", "press", "closed", "res")


def invert(transform: Callable[[Complex], Complex], span: float, count: int) -> Array:
    """f at t = 0, span/count, ...: Bromwich's integral by the trapezoidal rule on twice the span.

    The contour at c damps what wraps round by exp(-2 c span) = 1e-10.
    """
    c = 5.0 * math.log(10.0) / span
    s = c + 1j * math.pi / span * np.arange(count + 1)
    values = transform(s)
    values[-1] = values[-1].real
    return np.fft.irfft(values, 2 * count)[:count] * np.exp(c * span / count * np.arange(count)) * count / span


def losses(s: Complex, pipe: Pipe, friction: str) -> Complex:
    """sqrt(N): 1, Hagen-Poiseuille, or the exact laminar flow."""
    if friction == "none":
        return np.ones_like(s)
    if friction == "unsteady":
        xi = np.sqrt(s * pipe.viscous_time)
        return np.sqrt(ive(0, xi) / ive(2, xi))
    return np.sqrt(1.0 + 8.0 / (s * pipe.viscous_time))


def answers(s: Complex, pipe: Pipe, ends: str, friction: str = "unsteady") -> tuple[Complex, Complex]:
    """Two transfer functions of a line in units of Z0: how it answers to a step of one at end 1.

    flow: q1 given, p2 = 0 -> p1, q2; press: p1 given, q2 = 0 -> q1, p2; closed: q1 given, q2 = 0 -> p1, p2;
    res: a source of one behind 0.5 Z0, a load of 0.3 Z0 -> p1, p2.
    """
    n = losses(s, pipe, friction)
    e = np.exp(-s * pipe.travel_time * n)
    coth, csch = (1.0 + e * e) / (1.0 - e * e), 2.0 * e / (1.0 - e * e)
    if ends == "flow":
        return n / coth, -csch / coth
    if ends == "press":
        return 1.0 / (n * coth), csch / coth
    if ends == "closed":
        return n * coth, n * csch
    own, cross = n * coth, n * csch
    q1 = 1.0 / (own + 0.5 - cross**2 / (own + 0.3))
    q2 = -cross * q1 / (own + 0.3)
    return 1.0 - 0.5 * q1, -0.3 * q2


def inside(s: Complex, pipe: Pipe, xi: float) -> Complex:
    """Pressure at a place xi in units of Z0 q1, end 2 held: n sinh(g (1 - xi))/cosh g."""
    n = losses(s, pipe, "unsteady")
    g = s * pipe.travel_time * n
    return n * np.exp(-g * xi) * (1.0 - np.exp(-2.0 * g * (1.0 - xi))) / (1.0 + np.exp(-2.0 * g))


def ramped(transform: Callable[[Complex], Complex], step: float, count: int) -> Array:
    """The answer to a ramp of one over RAMP from t = 0, at t = step, 2 step, ... count step."""
    fine = 2 ** math.ceil(math.log2(16 * (count + 1))) // (count + 1)

    def driven(s: Complex) -> Complex:
        return (1.0 - np.exp(-s * RAMP)) / (s * s * RAMP) * transform(s)

    return invert(driven, (count + 1) * step, fine * (count + 1))[::fine][1:]


def exact(pipe: Pipe, ends: str, step: float, count: int, friction: str = "unsteady") -> tuple[Array, Array]:
    """Both answers to a ramp."""
    first, second = (ramped(lambda s, i=i: answers(s, pipe, ends, friction)[i], step, count) for i in (0, 1))
    return first, second


def talbot(transform: Callable[[Complex], Complex], t: float, points: int = 32) -> float:
    """f(t) by Talbot's contour (Weideman's modified one), t > 0."""
    theta = (2.0 * np.arange(points) + 1.0) * math.pi / points - math.pi
    half = 0.6407 * theta
    z = points / t * (0.5017 * theta / np.tan(half) - 0.6122 + 0.2645j * theta)
    slope = points / t * (0.5017 / np.tan(half) - 0.5017 * half / np.sin(half) ** 2 + 0.2645j)
    return float((np.exp(z * t) * transform(z) * slope).sum().imag / points)


def echoes(pipe: Pipe, t: float, order: int) -> float:
    """Pressure at end 1, end 2 held, for a flow t^(order-1) from t = 0, in Z0: tanh as a series of echoes, one by one.

    tanh g = 1 + 2 sum (-1)^k exp(-2 k g); each echo is inverted in its own time t - 2 k T, so fronts stay sharp.
    """
    travel, total = pipe.travel_time, 0.0
    for k in range(math.ceil(t / (2.0 * travel))):
        late = 2.0 * k * travel

        def echo(s: Complex, late: float = late) -> Complex:
            n = losses(s, pipe, "unsteady")
            return n * np.exp(-s * late * (n - 1.0)) / s**order

        total += (1.0 if k == 0 else 2.0 * (-1.0) ** k) * talbot(echo, t - late)
    return total


HELD_FLOW, HELD_PRESSURE, SOURCE = 0, 1, 2


@allocating_kernel
def drive(bank, memory, kinds, values, resistance, out) -> None:
    """Run a bank of one line. Per tick and end: kinds, values of what is held; out: p1, p2, q1, q2.

    HELD_FLOW: q; HELD_PRESSURE: p; SOURCE: p behind a resistance.
    """
    c, z, q = np.zeros(2), np.zeros(2), np.zeros(2)
    for tick in range(len(values)):
        arriving(bank, memory, tick, c, z)
        for end in range(2):
            kind, value = kinds[tick, end], values[tick, end]
            if kind == HELD_FLOW:
                q[end] = value
            else:
                q[end] = (value - c[end]) / (z[end] + (resistance[end] if kind == SOURCE else 0.0))
            out[tick, end], out[tick, 2 + end] = c[end] + z[end] * q[end], q[end]
        departing(bank, memory, tick, q)


def at_rest(spec: LineSpec, step: float, vapour_pressure: float = -1e12) -> tuple[Bank, Array]:
    """A bank of one line and its memory, at rest without pressure."""
    bank = bank_of([spec], step, vapour_pressure)
    memory = np.zeros(memory_size(bank))
    settle(bank, memory, np.zeros(2), np.zeros(1))
    return bank, memory


def run(bank: Bank, memory: Array, kinds: tuple[int, int], values: Array, resistance=(0.0, 0.0)) -> Array:
    """p1, p2, q1, q2 at every tick."""
    out = np.zeros((len(values), 4))
    drive(bank, memory, np.tile(np.array(kinds), (len(values), 1)), values, np.array(resistance), out)
    return out


def simulate(pipe: Pipe, ends: str, step: float, count: int, model: str, friction: str = "unsteady"):
    """What `exact` gives, by a model."""
    bank, memory = at_rest(pipe.spec(model, friction), step)
    z0 = pipe.impedance
    flow = 1e-7  # m^3/s: far from turbulence, where the line is linear
    size = flow if ends in ("flow", "closed") else flow * z0
    values = np.zeros((count, 2))
    values[:, 0] = size * np.minimum(1.0, step / RAMP * np.arange(1, count + 1))
    kinds = {
        "flow": (HELD_FLOW, HELD_PRESSURE), "press": (HELD_PRESSURE, HELD_FLOW),
        "closed": (HELD_FLOW, HELD_FLOW), "res": (SOURCE, SOURCE),
    }  # fmt: skip
    p1, p2, q1, q2 = run(bank, memory, kinds[ends], values, (0.5 * z0, 0.3 * z0)).T / flow
    return {"flow": (p1 / z0, q2), "press": (q1, p2 / z0)}.get(ends, (p1 / z0, p2 / z0))


def rms(found: Array, right: Array) -> float:
    """Root of the mean square of the difference."""
    return math.sqrt(float(np.mean((found - right) ** 2)))


def error(pipe: Pipe, ends: str, step: float, model: str, span: float = 0.0) -> float:
    """The larger rms error of both answers over TRAVELS travel times or a span [s], in Joukowsky pressures (flows: in
    flows)."""
    count = int((span or TRAVELS * pipe.travel_time + 1e-3) / step)
    pairs = zip(simulate(pipe, ends, step, count, model), exact(pipe, ends, step, count), strict=True)
    return max(rms(found, right) for found, right in pairs)
