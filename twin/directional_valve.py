"""The slot of the directional valve: how its spool moves, which lands it opens and what flows through them.

Which kind is fitted is known when a step is compiled. Positive spool positions connect P with A and B with T, negative
ones P with B and A with T.
"""

from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import by_type
from twin.lands import Lands, Ports, land_flows
from twin.oil import Oil
from twin.orifice import Orifice
from twin.spool_valve import SpoolValve, closed_centre_lands, move_spool
from twin.switching_valve import SwitchingValve, switch_spool, tandem_lands


class Spool(NamedTuple):
    """Spool of the directional valve, in shares of its travel."""

    position: float  # -1..1
    velocity: float  # [1/s]


Valve = SpoolValve | SwitchingValve


@by_type
def move_valve(valve: Any, spool: Spool, reference: float, memory: NDArray, step: float) -> Spool:
    """The spool a step [s] later under a reference -1..1; memory: of the slot."""
    raise TypeError(f"{valve} is not a directional valve")


@move_valve.register
def _(valve: SpoolValve, spool: Spool, reference: float, memory: NDArray, step: float) -> Spool:
    return Spool(*move_spool(spool.position, spool.velocity, reference, valve, step))


@move_valve.register
def _(valve: SwitchingValve, spool: Spool, reference: float, memory: NDArray, step: float) -> Spool:
    return Spool(*switch_spool(spool.position, reference, valve, step))


@by_type
def lands_at(valve: Any, spool: float) -> Lands:
    """Areas [m^2] at a spool position."""
    raise TypeError(f"{valve} is not a directional valve")


@lands_at.register
def _(valve: SpoolValve, spool: float) -> Lands:
    return closed_centre_lands(spool, valve)


@lands_at.register
def _(valve: SwitchingValve, spool: float) -> Lands:
    return tandem_lands(spool, valve)


@by_type
def valve_flows(valve: Any, spool: float, ports: Ports, oil: Oil) -> Lands:
    """Flows [m^3/s] through the lands between the ports at a spool position."""
    raise TypeError(f"{valve} is not a directional valve")


@valve_flows.register
def _(valve: SpoolValve, spool: float, ports: Ports, oil: Oil) -> Lands:
    return land_flows(ports, closed_centre_lands(spool, valve), valve.orifice, oil)


@valve_flows.register
def _(valve: SwitchingValve, spool: float, ports: Ports, oil: Oil) -> Lands:
    return land_flows(ports, tandem_lands(spool, valve), valve.orifice, oil)


@by_type
def land_orifice(valve: Any) -> Orifice:
    """The orifice that each land is."""
    raise TypeError(f"{valve} is not a directional valve")


@land_orifice.register
def _(valve: SpoolValve) -> Orifice:
    return valve.orifice


@land_orifice.register
def _(valve: SwitchingValve) -> Orifice:
    return valve.orifice


@by_type
def is_switching(valve: Any) -> bool:
    """Does the valve know three positions only?"""
    raise TypeError(f"{valve} is not a directional valve")


@is_switching.register
def _(valve: SpoolValve) -> bool:
    return False


@is_switching.register
def _(valve: SwitchingValve) -> bool:
    return True


@by_type
def spool_acceleration(valve: Any, position: float, speed: float, reference: float) -> float:
    """Acceleration of the spool [1/s^2], its limits left out."""
    raise TypeError(f"{valve} has no equation of its spool without limits")


@spool_acceleration.register
def _(valve: SpoolValve, position: float, speed: float, reference: float) -> float:
    omega = valve.natural_frequency
    return omega**2 * (reference - position) - 2.0 * valve.damping * omega * speed


@spool_acceleration.register
def _(valve: SwitchingValve, position: float, speed: float, reference: float) -> float:
    return 0.0
