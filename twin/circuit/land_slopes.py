"""Slopes of the directional valve: of the flow through its lands and of its spool; where its lands have their edges."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.directional_valve import Valve, lands_at, leaks_at
from twin.lands import Lands
from twin.oil import Oil
from twin.orifice import LEAST_AREA, flow_slopes
from twin.servo_opening import opening_slope
from twin.servo_valve import Edge, ServoValve
from twin.spool_valve import SpoolValve
from twin.switching_valve import SwitchingValve

Array = NDArray[np.float64]
SIDES = {"+": ("p_a", "b_t"), "-": ("p_b", "a_t")}
SIGN = {name: 1.0 if side == "+" else -1.0 for side, names in SIDES.items() for name in names}


class LandSlope(NamedTuple):
    """Slopes of the flow through one land, and of the force that it puts on the spool [shares of the command]."""

    name: str  # of Lands
    by_drop: float  # [m^3/(s Pa)]
    by_spool: float  # [m^3/s], per whole travel
    force_by_drop: float  # [1/Pa]
    force_by_spool: float


def land_slopes(valve: Valve, spool: float, drop: Lands, oil: Oil) -> list[LandSlope]:
    """Of every land that lets oil through at a spool position; drop: over each [Pa]."""
    areas, leaks = lands_at(valve, spool), leaks_at(valve, spool)
    return [
        _slope(name, valve, spool, getattr(drop, name), areas, leaks, oil)
        for name in SIGN
        if getattr(areas, name) > LEAST_AREA or getattr(leaks, name) > 0.0
    ]


def edge_slopes(valve: Valve, edge: str, drop: Lands, oil: Oil) -> list[LandSlope]:
    """Of the two lands of a side just beyond their edges: by the spool only, as if there were no overlap."""
    found = []
    for name in SIDES[edge]:
        d, widening = getattr(drop, name), SIGN[name] * _widening(valve, name, 0.0)
        speed = _orifice_speed(valve, d, oil)
        found.append(LandSlope(name, 0.0, speed * widening, 0.0, -_kappa(valve) * widening * abs(d)))
    return found


def _slope(name: str, valve: Valve, spool: float, drop: float, areas: Lands, leaks: Lands, oil: Oil) -> LandSlope:
    area, leak, kappa = getattr(areas, name), getattr(leaks, name), _kappa(valve)
    widening = SIGN[name] * _widening(valve, name, _beyond(valve, name, spool)) if area > LEAST_AREA else 0.0
    by_drop, by_area = flow_slopes(drop, area, valve.orifice, oil) if area > LEAST_AREA else (0.0, 0.0)
    force = -SIGN[name] * kappa
    return LandSlope(
        name,
        by_drop + leak,
        by_area * widening + drop * _leak_slope(valve, name, spool),
        force * area * float(np.sign(drop)),
        force * widening * abs(drop),
    )


def _kappa(valve: Valve) -> float:
    return valve.flow_force if isinstance(valve, ServoValve) else 0.0


def _orifice_speed(valve: Valve, drop: float, oil: Oil) -> float:
    return valve.orifice.discharge * math.copysign(math.sqrt(2.0 * abs(drop) / oil.density), drop)


def _way(valve: ServoValve, name: str, spool: float) -> float:
    return SIGN[name] * (spool - valve.null_bias)


def _beyond(valve: Valve, name: str, spool: float) -> float:
    """Share of the way beyond a land's edge."""
    if isinstance(valve, ServoValve):
        edge: Edge = getattr(valve, name)
        return (_way(valve, name, spool) - edge.overlap) / (1.0 - edge.overlap)
    return 0.0


def _widening(valve: Valve, name: str, beyond: float) -> float:
    """Slope of a land's area by its way [m^2 per travel]."""
    if isinstance(valve, ServoValve):
        edge: Edge = getattr(valve, name)
        return edge.area * opening_slope(valve.opening, beyond) / (1.0 - edge.overlap)
    if isinstance(valve, SpoolValve):
        return valve.area / (1.0 - valve.overlap)
    return 0.0


def _leak_slope(valve: Valve, name: str, spool: float) -> float:
    """Slope of a clearance's conductance by the spool."""
    if not isinstance(valve, ServoValve):
        return 0.0
    edge: Edge = getattr(valve, name)
    lap = edge.overlap - _way(valve, name, spool)
    return SIGN[name] * valve.tightening * edge.leak / (1.0 + valve.tightening * lap) ** 2 if lap > 0.0 else 0.0


def spool_slopes(valve: Valve) -> tuple[Array, Array]:
    """Slopes of the rates of position and speed by both, and by the command; limits, plays and delay left out."""
    if isinstance(valve, ServoValve) and (quick := valve.motion.quickness) > 0.0:
        return np.array([[-quick, 0.0], [0.0, -quick]]), np.array([quick, 0.0])
    if isinstance(valve, ServoValve):
        spring, damper = valve.motion.spring, valve.motion.damper
    elif isinstance(valve, SwitchingValve):
        spring = damper = 0.0
    else:
        omega = valve.natural_frequency
        spring, damper = omega**2, 2.0 * valve.damping * omega
    return np.array([[0.0, 1.0], [-spring, -damper]]), np.array([0.0, spring])


def edge_of(valve: Valve, edge: str) -> float:
    """Spool position at which both lands of a side begin to open."""
    sign = 1.0 if edge == "+" else -1.0
    if isinstance(valve, ServoValve):
        return valve.null_bias + sign * max(getattr(valve, name).overlap for name in SIDES[edge])
    return math.copysign(valve.overlap, sign) if isinstance(valve, SpoolValve) else 0.0


def area_ratio(valve: Valve, edge: str) -> float:
    """How much faster the land towards the cylinder opens than the one from it."""
    towards, back = (_widening(valve, name, 0.0) for name in SIDES[edge])
    return towards / back


def joins(valve: Valve, spool: float) -> bool:
    """Can oil both reach and leave the cylinder at a spool position?"""
    areas, leaks = lands_at(valve, spool), leaks_at(valve, spool)
    open_ = {name for name in SIGN if getattr(areas, name) > LEAST_AREA or getattr(leaks, name) > 0.0}
    return bool(open_ & {"p_a", "a_t"}) and bool(open_ & {"p_b", "b_t"})
