"""The pilot of the relief valve before its volume, in SI, and its dimensionless system for either seat.

(4.5) to (4.10), (4.34) to (4.39) of the thesis, recomputed: its sigma is 22 times too small, and its formula for the
conical reference lift gives 1.23 mm, not 0.23 mm. Lifts are in reference lifts, pressures in `s x_ref/A`.
"""

import math
from typing import NamedTuple

from twin.chatter.equilibrium import onset, rest
from twin.chatter.system import CHAMFERED, CONICAL, SeatLaw, System
from twin.seats.chamfered import ChamferedSeat
from twin.seats.conical import ConicalSeat, shear_damping
from twin.seats.film import film_damping


class Pilot(NamedTuple):
    """A poppet with both seats it could have, and the oil before it."""

    mass: float  # m [kg]
    stiffness: float  # s [N/m]
    drag: float  # K [N s/m], of the spring in oil, (2.44)
    chamfered: ChamferedSeat
    conical: ConicalSeat
    modulus: float  # B [Pa]
    volume: float  # V [m^3]
    reference_lift: float  # x_ref [m]
    restitution: float  # of the seat


class Reference(NamedTuple):
    """What is 1 in the dimensionless system."""

    omega: float  # [rad/s]
    lift: float  # [m]
    pressure: float  # [Pa]
    flow: float  # [m^3/s]
    beta: float  # [-], what is left


def reference(law: SeatLaw, pilot: Pilot) -> Reference:
    """(4.5) to (4.9) for the chamfered, (4.34) to (4.39) for the conical seat."""
    omega = math.sqrt(pilot.stiffness / pilot.mass)
    area = math.pi * pilot.conical.radius**2
    x = pilot.reference_lift
    p = pilot.stiffness * x / area
    if law == CHAMFERED:
        seat = pilot.chamfered
        q = seat.discharge * math.pi * seat.diameter * x * math.sin(seat.angle) * math.sqrt(2.0 * p / seat.density)
    else:
        q = conical_conductance(pilot.conical) * x**3 * p
    return Reference(omega, x, p, q, q * pilot.modulus / (p * omega * pilot.volume))


def conical_conductance(seat: ConicalSeat) -> float:
    """R [m s/kg] of Q = R p x^3, (4.35)."""
    length = math.log1p(seat.length * seat.sine / seat.radius)
    return math.pi * seat.sine**4 / (6.0 * seat.viscosity * length)


def narrowing(pilot: Pilot) -> float:
    """sigma of (4.4), [-]: by sigma y1 a chamfered opening is smaller than in proportion to the lift."""
    seat = pilot.chamfered
    return pilot.reference_lift * math.sin(seat.angle) * math.cos(seat.angle) / seat.diameter


def displacement(pilot: Pilot) -> float:
    """kappa = A^2 B/(V s) [-]: what the poppet itself displaces, left out of the system (-kappa y2 in y3')."""
    area = math.pi * pilot.conical.radius**2
    return area**2 * pilot.modulus / (pilot.volume * pilot.stiffness)


class Damping(NamedTuple):
    """Damping of a poppet at work, each K [N s/m]."""

    spring: float  # oil on the spring
    shear: float  # in the conical gap
    film: float  # oil squeezed in the conical gap


def system(law: SeatLaw, flow: float, precompression: float, pilot: Pilot) -> System:
    """The dimensionless system at a flow [m^3/s] and precompression [m], with the drag on its spring alone."""
    r = reference(law, pilot)
    k = pilot.drag / (pilot.mass * r.omega)
    return System(law, r.beta, flow / r.flow, precompression / r.lift, k, pilot.restitution)


def lift(law: SeatLaw, flow: float, precompression: float, pilot: Pilot) -> float:
    """Steady lift [m]."""
    return rest(system(law, flow, precompression, pilot)).lift * pilot.reference_lift


def damping(law: SeatLaw, flow: float, precompression: float, pilot: Pilot) -> Damping:
    """What damps the poppet at its steady lift; a chamfered seat has no gap to do so."""
    if law == CHAMFERED:
        return Damping(pilot.drag, 0.0, 0.0)
    x = lift(law, flow, precompression, pilot)
    return Damping(pilot.drag, shear_damping(x, pilot.conical), film_damping(x, pilot.conical))


class Comparison(NamedTuple):
    """One seat at a physical flow."""

    lift: float  # [m]
    pressure: float  # [Pa]
    frequency: float  # [Hz], of the swing that begins
    critical: float  # K_crit [N s/m]
    damping: Damping

    def safety(self, *parts: str) -> float:
        """Damping of some parts over the critical one: above 1 the valve is calm."""
        return sum(getattr(self.damping, part) for part in parts) / self.critical


def compare(law: SeatLaw, flow: float, precompression: float, pilot: Pilot) -> Comparison:
    """A seat at a flow [m^3/s] and precompression [m], with its own beta and the damping that it truly has."""
    s, r = system(law, flow, precompression, pilot), reference(law, pilot)
    at, start = rest(s), onset(s)
    return Comparison(
        at.lift * r.lift,
        at.pressure * r.pressure,
        start.frequency * r.omega / (2.0 * math.pi),
        start.damping * pilot.mass * r.omega,
        damping(law, flow, precompression, pilot),
    )


def equal_flow(precompression: float, pilot: Pilot, parts: tuple[str, ...]) -> float:
    """Flow [m^3/s] beyond which the conical seat has less damping over K_crit than the chamfered one.

    parts: of the damping that count. Raises ValueError where that never happens up to 1 m^3/s.
    """

    def advantage(flow: float) -> float:
        conical, chamfered = (compare(law, flow, precompression, pilot) for law in (CONICAL, CHAMFERED))
        return math.log(conical.safety(*parts) / chamfered.safety(*parts))

    low, high = 1e-9, 1e-9
    while advantage(high) > 0.0:
        low, high = high, 1.3 * high
        if high > most_flow(precompression, pilot):
            raise ValueError("the conical seat has the greater share of its critical damping at every flow it can pass")
    for _ in range(80):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if advantage(middle) > 0.0 else (low, middle)
    return low


def most_flow(precompression: float, pilot: Pilot) -> float:
    """Flow [m^3/s] at which the cone has left its housing: a lift of the seat's length times cos a."""
    x = pilot.conical.length * pilot.conical.cosine
    y = x / pilot.reference_lift
    r = reference(CONICAL, pilot)
    return r.flow * y**3 * (y + precompression / pilot.reference_lift)
