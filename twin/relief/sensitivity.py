"""What shapes the static curve of the relief valve, and what the curve can tell about it.

Sensitivities dp/d(ln parameter) [Pa] of the inlet pressure at given flows, by central differences of the steady
solution; their singular values say which combinations of parameters a measured curve determines.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.oil import Oil
from twin.relief.poppet import cracking_pressure
from twin.relief.steady import (
    HIGHEST,
    pilot_flow,
    pilot_lift,
    pilot_pressure,
    rest,
    steady_pressure,
)
from twin.relief.valve import Relief, ReliefState, relief

Array = NDArray[np.float64]
DYNAMIC = (  # without effect at rest
    "pilot_mass", "pilot_restitution", "pilot_spring_diameter", "pilot_spring_turns", "pilot_travel", "spool_mass",
    "spool_length", "spool_gap", "spool_restitution", "spool_travel", "damping_length", "rest_speed", "pilot_seat",
    "film_floor", "channel_volume",
)  # fmt: skip
STEP = 1e-4  # of the logarithm


class Curve(NamedTuple):
    """The static curve at given flows, an entry each."""

    flow: Array  # [m^3/s]
    pressure: Array  # [Pa]
    pilot_lift: Array  # [m]
    spool_lift: Array  # [m]
    pilot_flow: Array  # [m^3/s]


class Knee(NamedTuple):
    """Where the main stage opens."""

    pressure: float  # [Pa]
    flow: float  # [m^3/s]
    cracking: float  # [Pa], where the pilot opens


def curve(flows: Sequence[float] | Array, valve: Relief) -> Curve:
    """Pressure and openings of both stages at flows [m^3/s] > 0."""
    found = [steady_pressure(float(flow), valve) for flow in flows]
    states = [rest(p, valve) for p in found]
    through = [_pilot_flow(p, s, valve) for p, s in zip(found, states, strict=True)]
    lifts = np.array([(s.pilot_lift, s.spool_lift) for s in states]).reshape(-1, 2)
    return Curve(np.array(flows, float), np.array(found), lifts[:, 0], lifts[:, 1], np.array(through))


def _pilot_flow(p: float, s: ReliefState, valve: Relief) -> float:
    return pilot_flow(pilot_pressure(p, s.pilot_lift, valve), s.pilot_lift, valve)


def knee(valve: Relief) -> Knee:
    """The pressure at which the pilot's flow lifts the spool off its seat, by bisection to rounding.

    Raises ValueError where no pressure lifts it.
    """
    low = cracking_pressure(valve.pilot)
    high = low + 1e5
    while rest(high, valve).spool_lift == 0.0:
        high = low + 2.0 * (high - low)
        if high > HIGHEST:
            raise ValueError(f"no pressure up to {HIGHEST:.0e} Pa lifts the spool; take a softer or less loaded spring")
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rest(middle, valve).spool_lift == 0.0 else (low, middle)
    lift = pilot_lift(low, valve)
    return Knee(low, _pilot_flow(low, ReliefState(lift, 0.0, 0.0, 0.0), valve), cracking_pressure(valve.pilot))


def parameters(sizes: Mapping[str, Any]) -> list[str]:
    """The parameters of `relief` that a static curve depends on and that are not zero."""
    return [name for name, value in sizes.items() if name not in DYNAMIC and value != 0.0]


def sensitivities(flows: Sequence[float] | Array, sizes: Mapping[str, Any], oil: Oil) -> tuple[list[str], Array]:
    """Names, and dp/d(ln parameter) [Pa], (flows, parameters), all others fixed, the precompressions among them."""
    names = parameters(sizes)

    def pressures(name: str, sign: float) -> Array:
        moved = relief({**sizes, name: sizes[name] * math.exp(sign * STEP)}, oil)
        return np.array([steady_pressure(float(flow), moved) for flow in flows])

    columns = [(pressures(name, 1.0) - pressures(name, -1.0)) / (2.0 * STEP) for name in names]
    return names, np.array(columns).T


def set_and_override(low: float, high: float, sizes: Mapping[str, Any], oil: Oil) -> tuple[list[str], Array]:
    """Names, and the change of the set pressure (at `low` [m^3/s]) and of the override up to `high`, (2, n) [Pa].

    Per 1 of the parameter's logarithm: a hundredth of it for 1 %.
    """
    names, rows = sensitivities((low, high), sizes, oil)
    return names, np.array([rows[0], rows[1] - rows[0]])


class Identified(NamedTuple):
    """What a curve with a noise tells."""

    names: list[str]
    singular: Array  # values of sensitivity/noise, falling: 1/value is the spread of its combination
    directions: Array  # combinations of ln parameters, a row each
    alone: Array  # spread of ln parameter, all others known
    known: int  # combinations known better than `within`


def identifiable(names: list[str], sensitivity: Array, noise: float, within: float = 0.1) -> Identified:
    """Singular values of scaled sensitivities (flows, n) [Pa]; noise [Pa] of a reading; within: of ln, 0.1 is 10 %."""
    _, singular, rows = np.linalg.svd(sensitivity / noise, full_matrices=False)
    size = np.sqrt((sensitivity**2).sum(axis=0))
    alone = np.divide(noise, size, out=np.full(len(names), math.inf), where=size > 0.0)
    return Identified(names, singular, rows, alone, int((singular > 1.0 / within).sum()))
