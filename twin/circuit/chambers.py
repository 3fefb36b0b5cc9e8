"""Both chambers of an actuator while a load is lowered: h holds it, d is driven. What they pass in steady motion.

At a speed w towards h, c = S/V of what each holds, G the force that the load asks for, with leaks between them and to
the outside:

    A_h p_h = G + A_d p_d              Q_h = A_h w c_h - g (p_h - p_d) - g_h p_h, out of the held chamber
                                       Q_d = A_d w c_d - g (p_h - p_d) + g_d p_d, into the driven one

with g_h(p_h), g_d(p_d) where there is a hole.

Of a motor the volumes stay and the oil passes, so c = 1 there.
"""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.actuator import Actuator, areas, moduli, outside, volumes, widening
from twin.air import AnyAir, compressibility, compression
from twin.cylinder import Chambers
from twin.kernel import interpreted

SMALL = 1e3  # [Pa], for the slope of what drains


class Chamber(NamedTuple):
    """One chamber at a place."""

    area: float  # A [m^2]
    volume: float  # V [m^3]
    modulus: float  # B [Pa], with the walls around it
    widens: bool  # the piston opens a volume
    air: AnyAir
    lowest: float  # pressure that the oil can have [Pa]
    actuator: Actuator
    side: int  # of it, 0: lower, 1: upper

    def filling(self, pressure: float) -> float:
        """c, the oil over the volume that the piston sweeps."""
        if not self.widens:
            return 1.0
        return interpreted(compression)(self.air, self.modulus, max(self.lowest, pressure))

    def drain(self, pressure: float) -> float:
        """Oil to the outside [m^3/s]."""
        return interpreted(outside)(self.actuator, Chambers(pressure, pressure))[self.side] * pressure

    def squeeze(self, pressure: float) -> float:
        """Slope of S/V by the pressure [1/Pa]."""
        return interpreted(compressibility)(self.air, self.modulus, max(self.lowest, pressure))

    def admittance(self, s: NDArray[Any], pressure: float, growth: float) -> NDArray[Any]:
        """Flow per pressure [m^3/(s Pa)] at each s, without the leak between them; growth: speed away from it [m/s]."""
        swept = self.area * growth if self.widens else 0.0
        drained = (self.drain(pressure + SMALL) - self.drain(pressure - SMALL)) / (2.0 * SMALL)
        return (self.volume * s + swept) * self.squeeze(pressure) + drained


class Pair(NamedTuple):
    """Both, and the leak between them."""

    held: Chamber
    driven: Chamber
    leakage: float  # g [m^3/(s Pa)]


class Balance(NamedTuple):
    """Pressure [Pa] and flows [m^3/s] of a steady motion."""

    p_held: float
    q_held: float
    q_driven: float


def pair_at(actuator: Actuator, position: float, lower_holds: bool) -> Pair:
    """The chambers at a position [m]."""
    area, volume = interpreted(areas)(actuator, position), interpreted(volumes)(actuator, position)
    b, widens = interpreted(moduli)(actuator), interpreted(widening)(actuator) == 1.0
    lower, upper = (
        Chamber(area[side], volume[side], b[side], widens, actuator.air, actuator.vapour_pressure, actuator, side)
        for side in (0, 1)
    )
    return Pair(lower, upper, actuator.leakage) if lower_holds else Pair(upper, lower, actuator.leakage)


def balance(pair: Pair, force: float, p_driven: float, speed: float) -> Balance:
    """What holds a force [N], G, at a speed [m/s] and a pressure [Pa] of the driven chamber."""
    h, d = pair.held, pair.driven
    p_held = (force + d.area * p_driven) / h.area
    leak = pair.leakage * (p_held - p_driven)
    q_held = h.area * speed * h.filling(p_held) - leak - h.drain(p_held)
    return Balance(p_held, q_held, d.area * speed * d.filling(p_driven) - leak + d.drain(p_driven))
