"""A servo valve at rest: what it lets through, by clearance or underlap, and the chamber pressures that it makes.

With A and B blocked the oil runs from P to T in two ways, by A and by B, each through two lands in series. A load that
is held moves a little all the same: its chambers come to the pressures at which both are filled and emptied by the same
speed, while they carry it.
"""

from twin.actuator import areas, outside
from twin.circuit.step import Circuit
from twin.cylinder import Chambers
from twin.kernel import interpreted
from twin.land_law import Law, Laws, land_flow
from twin.lands import Lands
from twin.servo_valve import ServoValve, servo_laws


def steady_lands(drop: Lands, spool: float, circuit: Circuit) -> Lands:
    """Steady flows [m^3/s] of the lands of a servo valve under drops [Pa]; of another valve none."""
    if not isinstance(circuit.parts.valve, ServoValve):
        return Lands(0.0, 0.0, 0.0, 0.0, 0.0)
    laws = servo_laws(spool, circuit.parts.valve, circuit.parts.oil)
    return Lands(*(_flow(over, law) for over, law in zip(drop, laws, strict=True)))


def laws_at_rest(circuit: Circuit) -> Laws | None:
    """Of a servo valve that passes oil from P to T with its spool in the middle; None of any other valve."""
    if not isinstance(circuit.parts.valve, ServoValve):
        return None
    laws = servo_laws(0.0, circuit.parts.valve, circuit.parts.oil)
    ways = (laws.p_a, laws.a_t), (laws.p_b, laws.b_t)
    return laws if any(not first.shut and not second.shut for first, second in ways) else None


def passed(drop: float, laws: Laws) -> float:
    """Flow [m^3/s] from P to T at a drop [Pa], A and B blocked."""
    return _in_series(drop, laws.p_a, laws.a_t) + _in_series(drop, laws.p_b, laws.b_t)


def upper_pressure(p: float, t: float, position: float, weight: float, laws: Laws, circuit: Circuit) -> float | None:
    """Pressure [Pa] of the upper chamber while the valve in the middle holds a weight [N]; None where it cannot."""
    actuator, vapour = circuit.parts.cylinder, circuit.parts.oil.vapour_pressure
    area = interpreted(areas)(actuator, position)

    def sinks(upper: float) -> float:
        """Sum of the speeds at which the chambers are filled [m/s]: falls with their pressures."""
        lower = (weight + area.upper * upper) / area.lower
        leak, drains = actuator.leakage * (lower - upper), interpreted(outside)(actuator, Chambers(lower, upper))
        into_lower = _flow(p - lower, laws.p_a) - _flow(lower - t, laws.a_t) - leak - drains.lower * lower
        into_upper = _flow(p - upper, laws.p_b) - _flow(upper - t, laws.b_t) + leak - drains.upper * upper
        return into_lower / area.lower + into_upper / area.upper

    low = max(vapour, (area.lower * vapour - weight) / area.upper)
    high = max(p, (area.lower * p - weight) / area.upper)
    if not (low < high and sinks(low) > 0.0 > sinks(high)):
        return None
    return _root(sinks, low, high)


def _in_series(drop: float, first: Law, second: Law) -> float:
    if first.shut or second.shut or drop <= 0.0:
        return 0.0
    over_first = _root(lambda d: _flow(d, first) - _flow(drop - d, second), 0.0, drop)
    return _flow(over_first, first)


def _flow(drop: float, law: Law) -> float:
    return interpreted(land_flow)(drop, law)


def _root(function, low: float, high: float) -> float:
    from scipy.optimize import root_scalar

    return root_scalar(function, bracket=(low, high), xtol=1e-6, rtol=1e-14).root
