"""A load lowered at constant speed through the valve that holds it: the point of rest of its pressures.

The held chamber gives its oil through a counterbalance or a pilot-operated check valve, line and directional valve to
the tank; the pump drives the other chamber, whose line is the pilot. With a flow taken, everything follows from the
tank and from the tee on; what is left is that the valve, at rest under these pressures, passes that flow.
"""

from collections.abc import Callable
from typing import NamedTuple

from twin.accessory import Necks, between, resting_neck
from twin.check_valve import cracking_drop
from twin.circuit.chambers import balance, pair_at
from twin.circuit.equilibrium import line_drop, relieved_at
from twin.circuit.step import Circuit
from twin.counterbalance import Counterbalance
from twin.directional_valve import land_orifice, lands_at
from twin.environment import Environment
from twin.fitting import fitting_resistance
from twin.kernel import interpreted
from twin.load_at_rest import moved_weight, surroundings
from twin.neck import steady_flow
from twin.orifice import resistance
from twin.pilot_check import PilotCheck
from twin.return_end import steady_end
from twin.supply import steady_supply

HIGHEST = 1e9  # [Pa]
SLOWEST, LEAST = 1e-7, 1e-10  # [m/s], of what moves; [m^3/s], less passes a shut valve


class Lowering(NamedTuple):
    """Pressures [Pa] and flows [m^3/s] of a steady motion towards the held chamber."""

    held: str  # accessory_a: the lower chamber holds; accessory_b: the upper one
    speed: float  # of the piston towards the held chamber [m/s]
    position: float  # [m]
    spool: float
    p_held: float
    p_driven: float
    p_line: float  # of the held chamber's line, before its valve
    p_pilot: float  # of the driven chamber's line
    p_a: float  # at the directional valve, of the line out of the held chamber
    p_b: float  # at the directional valve, of the line to the driven one
    p_p: float
    p_t: float
    tee: float
    q_held: float  # at reference density
    q_driven: float


def held_by(necks: Necks) -> tuple[str, ...]:
    """The ports whose accessory holds a load."""
    sides = {"accessory_a": necks.accessory_a, "accessory_b": necks.accessory_b}
    return tuple(name for name, kind in sides.items() if isinstance(kind, Counterbalance | PilotCheck))


def lowering(circuit: Circuit, position: float, spool: float) -> Lowering:
    """The steady motion at a position [m] with the directional valve at a spool position, without friction.

    A positive spool lets oil out of the upper chamber, a negative one out of the lower. ValueError where the chamber
    that empties has no valve that holds, where the load stands still, and where the oil would not follow.
    """
    held = "accessory_b" if spool > 0.0 else "accessory_a"
    if held not in held_by(between(circuit.parts.necks)):
        raise ValueError(f"spool {spool:g} empties a chamber without a valve that holds it: see {held}.kind")

    def excess(speed: float) -> float:
        at = _at(speed, held, position, spool, circuit)
        return _passed(at, circuit) - at.q_held

    slow = _at(SLOWEST, held, position, spool, circuit)
    if _passed(slow, circuit) <= max(LEAST, slow.q_held):
        raise ValueError(f"no motion at spool {spool:g}: the valve in {held} stays shut; take a lower setting")
    fast = 1e-3
    while excess(fast) > 0.0:
        fast *= 2.0
    found = _at(_root(excess, 0.5 * fast if fast > 1e-3 else SLOWEST, fast), held, position, spool, circuit)
    if min(found.p_held, found.p_driven, found.p_b) <= circuit.parts.oil.vapour_pressure:
        raise ValueError(f"oil would cavitate at spool {spool:g}: the pump does not follow; take a smaller opening")
    if found.q_held <= LEAST:
        raise ValueError(f"leaks alone lower the load at spool {spool:g}: the valve in {held} stays shut")
    if found.tee >= HIGHEST:
        raise ValueError(f"the pump has no way but into the chamber at spool {spool:g}: fit a relief valve")
    return found


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import root_scalar

    return root_scalar(function, bracket=(low, high), xtol=1e-15, rtol=1e-13).root


def _passed(at: Lowering, circuit: Circuit) -> float:
    """What the valve passes at rest under these pressures [m^3/s]."""
    neck = resting_neck(
        getattr(between(circuit.parts.necks), at.held), at.p_line, at.p_held, at.p_pilot, circuit.parts.oil
    )
    return -steady_flow(at.p_line - at.p_held, neck)


def _at(speed: float, held: str, position: float, spool: float, circuit: Circuit) -> Lowering:
    """Pressures at a speed, whatever the valve would pass; oil expands and is compressed on its way."""
    parts, lower = circuit.parts, held == "accessory_a"
    pair = pair_at(parts.cylinder, position, lower)
    force = (1.0 if lower else -1.0) * moved_weight(parts.load, position) - _drag(speed, surroundings(parts.load))
    lands, orifice = interpreted(lands_at)(parts.valve, spool), land_orifice(parts.valve)
    to_driven, to_tank = (lands.p_b, lands.a_t) if lower else (lands.p_a, lands.b_t)
    way = _way_in(pair.driven.area * speed, to_driven, lower, circuit)
    for _ in range(2):
        way = _way_in(balance(pair, force, way.p_driven, speed).q_driven, to_driven, lower, circuit)
    p_held, q_held, q_driven = balance(pair, force, way.p_driven, speed)
    p_t = line_drop(4, q_held, circuit) + line_drop(5, q_held, circuit) + steady_end(parts.return_end, q_held, 0.0)
    p_a = p_t + _edge(q_held, *resistance(to_tank, orifice, parts.oil))
    return Lowering(
        held=held,
        speed=speed,
        position=position,
        spool=spool,
        p_held=p_held,
        p_line=p_a + line_drop(2 if lower else 3, q_held, circuit),
        p_a=p_a,
        p_t=p_t,
        q_held=q_held,
        q_driven=q_driven,
        **way._asdict(),
    )


class _WayIn(NamedTuple):
    """Pressures [Pa] from the tee to the driven chamber, by the names of `Lowering`."""

    tee: float
    p_p: float
    p_b: float
    p_pilot: float
    p_driven: float


def _way_in(q: float, land: float, lower: bool, circuit: Circuit) -> _WayIn:
    """What a flow [m^3/s] loses on its way; land: the open area [m^2] to the driven chamber, lower: the other holds."""
    parts = circuit.parts
    tee = _tee(q, circuit)
    p_p = tee - cracking_drop(parts.check) - fitting_resistance(q, parts.fitting) * q
    p_p -= line_drop(1, q, circuit)
    p_b = p_p - _edge(q, *resistance(land, land_orifice(parts.valve), parts.oil))
    p_pilot = p_b - line_drop(3 if lower else 2, q, circuit)
    return _WayIn(tee, p_p, p_b, p_pilot, p_pilot - drop_into(q, "accessory_b" if lower else "accessory_a", circuit))


def _drag(speed: float, around: Environment) -> float:
    """Force [N] of the dampers around a load against its motion."""
    return (around.viscous + around.quadratic * speed) * speed


def _edge(q: float, a: float, b: float) -> float:
    return (a * abs(q) + b) * q


def _tee(q: float, circuit: Circuit) -> float:
    """Pressure [Pa] at the tee where the pump delivers a flow [m^3/s] beyond the relief valve's; falls with it.

    Beyond -HIGHEST where no pressure draws so much from the pump, beyond HIGHEST where none stops it.
    """

    def excess(tee: float) -> float:
        relieved = relieved_at(tee, circuit)[0]
        pump = tee + line_drop(0, relieved + q, circuit)
        return steady_supply(circuit.parts.supply, pump, 1.0, circuit.parts.oil)[0] - relieved - q

    low, high = -1e5, 1e5
    while excess(low) < 0.0 and low > -HIGHEST:
        low *= 2.0
    while excess(high) > 0.0 and high < HIGHEST:
        high *= 2.0
    if excess(low) < 0.0:
        return low
    return high if excess(high) > 0.0 else _root(excess, low, high)


def drop_into(q: float, port: str, circuit: Circuit) -> float:
    """Drop [Pa] of the accessory on the way into the driven chamber."""
    neck = resting_neck(getattr(between(circuit.parts.necks), port), 0.0, 0.0, 0.0, circuit.parts.oil)
    if q <= 0.0 or neck.into.a_beside == 0.0 == neck.into.b_beside:
        return 0.0
    high = 1e5
    while steady_flow(high, neck) < q:
        high *= 2.0
    return _root(lambda drop: steady_flow(drop, neck) - q, 0.0, high)
