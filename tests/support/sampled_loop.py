"""The sampled linear actuator run the long way: `controller.law` itself, its commands at their instants, no matrices.

z1' = z2, z2' = a - k z2, a' = -2 z2 + sqrt2 gamma u; sample i is taken at i tau and its command acts from
(i + delay) tau on. Independent of `controller.stability`: no exponential, no past inputs in a state.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from controller.law import Gains, Memory, Sample, pd
from controller.reference import Target
from twin.integration import integrate

Flow = Callable[[Any, float, float], Any]  # (z, u, time) -> z after holding u for that time


class Case(NamedTuple):
    """Numbers of one loop."""

    s: float
    d: float
    k: float
    gamma: float
    tau: float
    delay: float  # sampling periods
    derivative: str
    filter_time: float | None  # sampling periods


def gains(case: Case) -> Gains:
    lag = (case.filter_time or 0.0) * case.tau
    return Gains(case.s, case.d, case.derivative, lag, case.tau, limit=np.inf, overlap=0.0)


def integrated(case: Case) -> Flow:
    """The plant under a held command by DOP853 to 1e-12."""

    def rates(_t: float, z: Any, u: float) -> list[float]:
        return [z[1], z[2] - case.k * z[1], -2.0 * z[1] + np.sqrt(2.0) * case.gamma * u]

    def flow(z: Any, u: float, time: float) -> Any:
        if time <= 0.0:
            return z
        limits = {"rtol": 1e-12, "atol": 1e-14}
        return integrate(lambda t, y: rates(t, y, u), (0.0, time), z, "DOP853", most=200_000, **limits).y[:, -1]

    return flow


def tabulated(case: Case) -> Flow:
    """The same for many periods: the flow is linear, so its four columns are integrated once for each time."""
    exact, table = integrated(case), {}

    def flow(z: Any, u: float, time: float) -> Any:
        if time not in table:
            table[time] = np.array([exact(z0, u0, time) for *z0, u0 in np.eye(4)]).T
        return table[time] @ np.append(z, u)

    return flow


def course(
    case: Case, z: ArrayLike, past: ArrayLike, memory: Memory | None, periods: int, flow: Flow
) -> tuple[Any, list[float], list[Memory | None]]:
    """z at every sample 0 .. periods, the commands given (after those of the past, youngest first) and the memories.

    Command j is followed from (j + delay) tau until the next; the events of each period are those that fall into it.
    """
    whole, before = int(case.delay), np.size(past)
    share = case.delay - whole
    given, states, memories = [*np.array(past, float)[::-1]], [np.array(z, float)], [memory]
    for i in range(periods):
        sample = Sample(i, states[-1][0], states[-1][1], 0.0, 0.0, 0.0)
        u, memory = pd(sample, Target(0.0, 0.0), memories[-1], gains(case))
        given.append(u)
        older, younger = _acting(given, before + i - whole - 1), _acting(given, before + i - whole)
        between = flow(states[-1], older, share * case.tau)
        states.append(flow(between, younger, (1.0 - share) * case.tau))
        memories.append(memory)
    return np.array(states), given, memories


def _acting(given: list[float], index: int) -> float:
    return given[index] if index >= 0 else 0.0
