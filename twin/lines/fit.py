"""Scattering filters of a line, fitted once before a run.

The fit is one linear least-squares problem, directly in z: no fraction of a step is lost between a continuous fit and
the grid. Exact whatever it finds: S+(1) = 1 and S+'(1) (the mass: sum h (q1 + q2) between two rests is (V/B) dp), the
next two derivatives (else |S+| exceeds 1 near rest), S-(1) (the steady resistance). `passivity.py` does the rest.
"""

import math

import numpy as np

from twin.lines.filters import POLES, TAPS, Filters, lagrange, responses, scattering
from twin.lines.householder import Matrix, product, split, triangle
from twin.lines.passivity import enforced
from twin.lines.theory import Line, modes, slow_minus, slow_plus

SHORTEST = 3.5  # M: taps need room before the first echo
SHORT = 16.0  # M of a short line
FAR = 100.0  # M of a long line
POINTS = 300  # frequencies of the fit
EVEN = 400  # more of them after a fit that was not passive
TOLERANCE = 1e-9  # |S+-| - 1 that is certified
FOLLOWED = 0.3  # angle per step up to which a line whose wall creeps must be met
FAR_OFF = 0.05  # what may be missing in S+-
RIDGE = 1e-5  # weight on the coefficients themselves: in short lines poles and taps could cancel each other


def fit(line: Line) -> Filters:
    """The filters of a line, passive, or ValueError with the limit it meets."""
    if line.steps < SHORTEST:
        raise ValueError(
            f"travel time {line.travel_time:.3g} s is {line.steps:.2f} steps, limit {SHORTEST} for model ends"
        )
    if line.losses == "none" and not line.creep:
        return _lossless(line)
    empty = _empty(line, POLES)
    excess = math.inf
    for steep in _steepness(line.steps):
        omega = _frequencies(line, empty, EVEN if math.isfinite(excess) else 0)
        filters, excess = _fit(line, empty, omega, steep)
        if excess <= TOLERANCE:
            _refuse_far_off(line, filters)
            return filters
    raise ValueError(f"no passive filters found for travel time {line.travel_time:.4g} s, |S| - 1 = {excess:.1e}")


def _refuse_far_off(line: Line, filters: Filters) -> None:
    """ValueError where a wall that creeps fast along a long line is beyond what so few poles can follow."""
    if not line.creep:
        return
    omega = np.geomspace(1e-2 / line.travel_time, FOLLOWED / line.step, POINTS)
    right = modes(1j * omega, line.travel_time, line.viscous_time, line.losses, line.creep)
    miss = max(float(np.abs(a - b).max()) for a, b in zip(right, scattering(omega * line.step, filters), strict=True))
    if miss > FAR_OFF:
        times = ", ".join(f"{element.time:.3g} s" for element in line.creep)
        raise ValueError(
            f"retardation {times} is too fast for a travel time of {line.travel_time:.3g} s: the reflection is met "
            f"within {miss:.2f}, limit {FAR_OFF}"
        )


def _fit(line: Line, empty: Filters, omega: Matrix, steep: float) -> tuple[Filters, float]:
    """Filters by least squares, as passive as rounds of enforcing make them, and their worst |S| - 1."""
    plus, minus = modes(1j * omega, line.travel_time, line.viscous_time, line.losses, line.creep)
    a_plus, a_minus = responses(omega * line.step, empty)
    matrix = np.vstack([a_plus.real, a_plus.imag, a_minus.real, a_minus.imag])
    target = np.concatenate([plus.real, plus.imag, minus.real, minus.imag])
    weight = _weight(omega, line, steep)
    weights = np.tile(weight, 4)
    fixed, free = split(*_exact(line, empty))
    rest = target - product(matrix, fixed.reshape(-1, 1))[:, 0]
    ridge = RIDGE * float(weight.max())
    rows = np.vstack([product(matrix * weights[:, None], free), ridge * free])
    r, y = triangle(rows, np.concatenate([rest * weights, -ridge * fixed]))
    return enforced(line, empty, fixed, free, r, y)


def _lossless(line: Line) -> Filters:
    """A pure delay: Lagrange's taps about its middle, where |H| <= 1; exact for whole M."""
    first = math.floor(line.steps + 1e-9) - (TAPS // 2 - 1)
    return _empty(line, 0)._replace(first=first, taps=lagrange(line.steps - first, TAPS))


def _empty(line: Line, poles: int) -> Filters:
    """Poles and delays; every coefficient zero."""
    slowest = max(min(0.4 * line.viscous_time, 40.0 * line.travel_time), 8.0 * line.step)
    fastest = line.step * (2.0 if line.steps > FAR else 0.6)
    none = np.zeros(poles)
    spaced = np.geomspace(fastest, slowest, poles - len(line.creep)) if poles else none
    return Filters(
        poles=np.exp(-line.step / np.append(spaced, [element.time for element in line.creep])) if poles else none,
        direct=0.0,
        own=none,
        echo=none,
        across=none,
        echo_taps=np.zeros(2),
        taps=np.zeros(TAPS),
        echo_first=max(1, math.floor(2.0 * line.steps)),
        first=_first_tap(line.steps),
        echo_delay=round(2.0 * line.steps),
        delay=round(line.steps),
    )


def _first_tap(m: float) -> int:
    """Four before the last whole step, in short lines three where M is little above it (by trial: rms near M = 8)."""
    return max(1, math.floor(m) - (TAPS // 2 - 1 if m < SHORT and m % 1.0 < 0.5 else TAPS // 2))


def _frequencies(line: Line, empty: Filters, even: int) -> Matrix:
    """Log-spaced up to Nyquist, and some evenly spaced among them, which see more of the turns of the echo."""
    slowest = -line.step / math.log(empty.poles.max())
    nyquist = math.pi / line.step
    slow = np.geomspace(min(1e-3 / line.travel_time, 0.05 / slowest), nyquist, POINTS)
    return np.sort(np.concatenate([slow, np.linspace(0.02 * nyquist, 0.9999 * nyquist, even)]))


def _weight(omega: Matrix, line: Line, steep: float) -> Matrix:
    """A step-like input, the gain of closed loops at low frequency, fading out towards Nyquist."""
    u = omega * line.travel_time
    bent = np.maximum(u, 0.1)
    return np.sqrt(np.gradient(u)) / bent * (1.0 + 1.0 / bent) / (1.0 + (omega * line.step / 0.85) ** steep)


def _steepness(m: float) -> list[float]:
    """How fast the weight fades out, the best rms error first (by trial), then those that may be passive yet.

    Long lines keep some weight up to Nyquist: points in log spacing see few of the many turns of the echo there.
    """
    best = 2.0 if m > FAR else 4.0 if m >= 8.0 else 3.0
    return [best, *(s for s in (3.0, 2.0, 4.0, 1.0) if s != best)]


def _moments(delays: Matrix, poles: Matrix) -> tuple[Matrix, Matrix]:
    """Moments 0 to 3 of the delay in steps: of plain delays, and of the poles' geometric distributions."""
    d = np.array([delays**k for k in range(4)])
    r = 1.0 / (1.0 - poles)
    p = np.array([np.ones_like(r), poles * r, poles * (1.0 + poles) * r**2])
    return d, np.vstack([p, poles * (1.0 + 4.0 * poles + poles**2) * r**3])


def _behind(delay: int, p: Matrix) -> Matrix:
    """Moments of a pole behind a delay."""
    d = float(delay)
    return np.array([p[0], d * p[0] + p[1], d**2 * p[0] + 2.0 * d * p[1] + p[2],
                     d**3 * p[0] + 3.0 * d**2 * p[1] + 3.0 * d * p[2] + p[3]])  # fmt: skip


def _exact(line: Line, empty: Filters) -> tuple[Matrix, Matrix]:
    """Constraints on the unknowns: S+ and its first three derivatives at rest, S- at rest."""
    m = line.steps
    delays = [np.zeros(1), empty.echo_first + np.arange(2.0), empty.first + np.arange(float(TAPS))]
    (one, p), (echo, _), (taps, _) = (_moments(d, empty.poles) for d in delays)
    rows = np.hstack([one, p, echo, _behind(empty.echo_delay, p), taps, _behind(empty.delay, p)])
    scale = np.array([1.0, -1.0 / m, 0.5 / m**2, -1.0 / (6.0 * m**3)])  # z^-n = exp(-u n/M)
    rows *= scale[:, None]
    across = np.ones(rows.shape[1])
    across[-(TAPS + len(empty.poles)) :] = -1.0
    values = np.append(slow_plus(line), slow_minus(line.dissipation, line.losses))
    rows = np.vstack([rows, rows[0] * across])
    size = np.abs(rows).max(axis=1)
    return rows / size[:, None], values / size
