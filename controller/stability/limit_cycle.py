"""Periodic orbits of the analogue loop: half a period as a boundary value problem, solved by multiple shooting.

Source: 5.3.3, with the symmetry it found: the second arc is the first one seen from the other side. On a point
X = (nodes y_0 .. y_(m-1), half-period T, parameter): phi_(T/m)(y_i) = y_(i+1), phi_(T/m)(y_(m-1)) = mirror(y_0),
h(y_0) = 0. Unknowns are scaled with alpha, as x and x' are small with it.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from controller.stability.actuator import Array, mirror
from controller.stability.arc import RELAY, Loop, derivatives, end_rates, follow

TOLERANCE = 1e-11  # of an arc's step
MIRROR = np.array([[-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]], float)
PARAMETERS = ("s", "d")


class Orbit(NamedTuple):
    """A symmetric periodic orbit."""

    loop: Loop
    nodes: Array  # (m, 4), equally spaced in time over the first half; the first on h = 0
    half_period: float


def along(loop: Loop, parameter: str, value: float) -> Loop:
    """The loop with another s or d."""
    return loop._replace(gains=loop.gains._replace(**{parameter: value}))


def pack(orbit: Orbit, parameter: str) -> Array:
    """X (4 m + 2,) of an orbit, scaled."""
    scale = _scale(len(orbit.nodes), orbit.loop)
    return np.concatenate([orbit.nodes.ravel(), [orbit.half_period, getattr(orbit.loop.gains, parameter)]]) / scale


def unpack(x: Array, loop: Loop, parameter: str) -> Orbit:
    """The orbit of an X."""
    values = x * _scale((len(x) - 2) // 4, loop)
    return Orbit(along(loop, parameter, float(values[-1])), values[:-2].reshape(-1, 4), float(values[-2]))


def _scale(count: int, loop: Loop) -> Array:
    alpha = loop.actuator.alpha
    return np.concatenate([np.tile([alpha, alpha, 1.0, 1.0], count), [1.0, 1.0]])


def equations(x: Array, loop: Loop, parameter: str) -> tuple[Array, Array]:
    """Residual (4 m + 1,) and its derivatives (4 m + 1, 4 m + 2). ArithmeticError where an arc cannot be followed."""
    orbit = unpack(x, loop, parameter)
    count, column = len(orbit.nodes), 4 + PARAMETERS.index(parameter)
    residual, jacobian = np.zeros(4 * count + 1), np.zeros((4 * count + 1, 4 * count + 2))
    for i, node in enumerate(orbit.nodes):
        row = _arc(orbit, node)
        rows, turn = slice(4 * i, 4 * i + 4), np.eye(4) if i < count - 1 else MIRROR
        following = (i + 1) % count
        residual[rows] = turn @ row[:4] - orbit.nodes[following]
        jacobian[rows, 4 * i : 4 * i + 4] += turn @ derivatives(row)[:, :4]
        jacobian[rows, 4 * following : 4 * following + 4] -= np.eye(4)
        jacobian[rows, -2] = turn @ end_rates(row[:4], orbit.loop) / count
        jacobian[rows, -1] = turn @ derivatives(row)[:, column]
    s, d = orbit.loop.gains
    residual[-1] = s * orbit.nodes[0, 0] + d * orbit.nodes[0, 1]
    jacobian[-1, :2], jacobian[-1, -1] = (s, d), orbit.nodes[0, column - 4]
    rows = np.concatenate([np.tile([loop.actuator.alpha] * 2 + [1.0, 1.0], count), [loop.actuator.alpha]])
    return residual / rows, jacobian * _scale(count, loop) / rows[:, None]


def _arc(orbit: Orbit, node: Array) -> Array:
    if orbit.half_period <= 0.0:
        raise ArithmeticError("half-period not above 0")
    row, time = follow(node, orbit.half_period / len(orbit.nodes), orbit.loop, TOLERANCE, False)
    if time < 0.0:
        raise ArithmeticError("the arc leaves the stroke")
    return row


def correct(x: Array, loop: Loop, parameter: str, extra: Callable[[Array], tuple[float, Array]]) -> tuple[Array, int]:
    """Newton on the equations and one further condition (its value and gradient); X and the iterations taken.

    ArithmeticError where it does not converge.
    """
    for turn in range(12):
        residual, jacobian = equations(x, loop, parameter)
        value, gradient = extra(x)
        change = np.linalg.solve(np.vstack([jacobian, gradient]), np.append(residual, value))
        x = x - change
        if np.abs(change).max() < 1e-9:
            return x, turn + 1
        if not np.abs(change).max() < 10.0:
            break
    raise ArithmeticError("Newton's method does not converge")


def solve(guess: Orbit, parameter: str = "d") -> Orbit:
    """The orbit near a guess, at its gains."""
    start = pack(guess, parameter)
    pick = np.eye(len(start))[-1]
    x, _ = correct(start, guess.loop, parameter, lambda x: (x[-1] - start[-1], pick))
    return unpack(x, guess.loop, parameter)


def settled(loop: Loop, start: Array, turns: int, longest: float) -> Orbit:
    """A guess by `turns` half-turns of the loop itself from a start on h = 0: near a stable orbit.

    ArithmeticError where an arc does not come back to h = 0 within `longest`.
    """
    y, time = np.asarray(start, float), 0.0
    for _ in range(turns):
        y, time = half_turn(loop, y, longest)
    return Orbit(loop, y[None, :], time)


def half_turn(loop: Loop, y: Array, longest: float) -> tuple[Array, float]:
    """The next switching point, mirrored, and the time to it."""
    row, time = follow(y, longest, loop, TOLERANCE, True)
    if not 0.0 < time < longest:
        raise ArithmeticError(f"no return to h = 0 within {longest} from {y}")
    return mirror(row[:4]), time


def split(orbit: Orbit, count: int) -> Orbit:
    """The same orbit on `count` nodes."""
    nodes, y = [orbit.nodes[0]], orbit.nodes[0]
    for _ in range(count - 1):
        y = follow(y, orbit.half_period / count, orbit.loop, TOLERANCE, False)[0][:4]
        nodes.append(y)
    return Orbit(orbit.loop, np.array(nodes), orbit.half_period)


def multipliers(orbit: Orbit) -> Array:
    """Floquet multipliers (4,) over the whole period, the largest first; one of them is 1, along the orbit.

    The half-turn N = mirror . saltation . d phi has them as squares of its eigenvalues. At the switch of a relay the
    field jumps from f to f': saltation 1 + (f' - f) n^T/(n^T f), n = (s, d, 0, 0); elsewhere the field is continuous.
    """
    half = np.linalg.eigvals(half_monodromy(orbit))
    return np.array(sorted(half**2, key=abs, reverse=True))


def half_monodromy(orbit: Orbit) -> Array:
    """N (4, 4)."""
    flow, row = np.eye(4), np.empty(0)
    for node in orbit.nodes:
        row = _arc(orbit, node)
        flow = derivatives(row)[:, :4] @ flow
    if orbit.loop.kind == RELAY:
        before, normal = end_rates(row[:4], orbit.loop), np.array([*orbit.loop.gains, 0.0, 0.0])
        after = MIRROR @ end_rates(orbit.nodes[0], orbit.loop)
        flow = (np.eye(4) + np.outer(after - before, normal) / (normal @ before)) @ flow
    return MIRROR @ flow


def stable(orbit: Orbit) -> bool:
    """Are all multipliers but the one along the orbit inside the unit circle?"""
    others = list(multipliers(orbit))
    others.pop(int(np.argmin([abs(mu - 1.0) for mu in others])))
    return max(abs(mu) for mu in others) < 1.0


def profile(orbit: Orbit, count: int) -> tuple[Array, Array]:
    """Times (2 count + 1,) and states (2 count + 1, 4) over the whole period."""
    half = split(Orbit(orbit.loop, orbit.nodes[:1], orbit.half_period), count).nodes
    states = np.vstack([half, mirror(half), half[:1]])
    return np.linspace(0.0, 2.0 * orbit.half_period, 2 * count + 1), states


def peaks(orbit: Orbit, count: int = 200) -> Array:
    """Greatest y1, y2, y3, y4 (4,) over the period: greatest of `count` points a half, its parabola through three."""
    states = profile(orbit, count)[1][:-1]
    before, after = np.roll(states, 1, axis=0), np.roll(states, -1, axis=0)
    top, columns = states.argmax(axis=0), np.arange(4)
    left, here, right = before[top, columns], states[top, columns], after[top, columns]
    bend = left - 2.0 * here + right
    return here - (right - left) ** 2 / np.where(bend < 0.0, 8.0 * bend, -np.inf)
