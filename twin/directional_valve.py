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
from twin.servo_spool import motion_rates
from twin.servo_valve import (
    ServoValve,
    begin_servo,
    flow_force,
    move_servo,
    servo_areas,
    servo_flows,
    servo_leaks,
)
from twin.spool_valve import SpoolValve, closed_centre_lands, move_spool
from twin.switching_valve import SwitchingValve, switch_spool, tandem_lands


class Spool(NamedTuple):
    """Spool of the directional valve, in shares of its travel."""

    position: float  # -1..1
    velocity: float  # [1/s]


Valve = SpoolValve | SwitchingValve | ServoValve
TIGHT = Lands(0.0, 0.0, 0.0, 0.0, 0.0)


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


@move_valve.register
def _(valve: ServoValve, spool: Spool, reference: float, memory: NDArray, step: float) -> Spool:
    return Spool(*move_servo(spool.position, spool.velocity, reference, valve, memory, step))


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


@lands_at.register
def _(valve: ServoValve, spool: float) -> Lands:
    return servo_areas(spool, valve)


@by_type
def leaks_at(valve: Any, spool: float) -> Lands:
    """Conductances of the lands' clearances [m^3/(s Pa)] at a spool position."""
    raise TypeError(f"{valve} is not a directional valve")


@leaks_at.register
def _(valve: SpoolValve, spool: float) -> Lands:
    return TIGHT


@leaks_at.register
def _(valve: SwitchingValve, spool: float) -> Lands:
    return TIGHT


@leaks_at.register
def _(valve: ServoValve, spool: float) -> Lands:
    return servo_leaks(spool, valve)


@by_type
def valve_flows(valve: Any, spool: float, ports: Ports, memory: NDArray, oil: Oil) -> Lands:
    """Flows [m^3/s] through the lands between the ports at a spool position; memory: of the slot."""
    raise TypeError(f"{valve} is not a directional valve")


@valve_flows.register
def _(valve: SpoolValve, spool: float, ports: Ports, memory: NDArray, oil: Oil) -> Lands:
    return land_flows(ports, closed_centre_lands(spool, valve), valve.orifice, oil)


@valve_flows.register
def _(valve: SwitchingValve, spool: float, ports: Ports, memory: NDArray, oil: Oil) -> Lands:
    return land_flows(ports, tandem_lands(spool, valve), valve.orifice, oil)


@valve_flows.register
def _(valve: ServoValve, spool: float, ports: Ports, memory: NDArray, oil: Oil) -> Lands:
    return servo_flows(valve, spool, ports, memory, oil)


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


@land_orifice.register
def _(valve: ServoValve) -> Orifice:
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


@is_switching.register
def _(valve: ServoValve) -> bool:
    return False


@by_type
def spool_rates(valve: Any, spool: Spool, reference: float, force: float) -> Spool:
    """Rates of position and speed, limits, plays and delay left out; force: of `force_at`."""
    raise TypeError(f"{valve} has no equation of its spool without limits")


@spool_rates.register
def _(valve: SpoolValve, spool: Spool, reference: float, force: float) -> Spool:
    omega = valve.natural_frequency
    back = omega**2 * (reference - spool.position) - 2.0 * valve.damping * omega * spool.velocity
    return Spool(spool.velocity, back)


@spool_rates.register
def _(valve: SwitchingValve, spool: Spool, reference: float, force: float) -> Spool:
    return Spool(spool.velocity, 0.0)


@spool_rates.register
def _(valve: ServoValve, spool: Spool, reference: float, force: float) -> Spool:
    return Spool(*motion_rates(spool.position, spool.velocity, reference + force, valve.motion))


@by_type
def force_at(valve: Any, drop: Lands, area: Lands) -> float:
    """Force of the flow on the spool in shares of the command; drop: of each land [Pa], area: [m^2]."""
    raise TypeError(f"{valve} is not a directional valve")


@force_at.register
def _(valve: SpoolValve, drop: Lands, area: Lands) -> float:
    return 0.0


@force_at.register
def _(valve: SwitchingValve, drop: Lands, area: Lands) -> float:
    return 0.0


@force_at.register
def _(valve: ServoValve, drop: Lands, area: Lands) -> float:
    return flow_force(drop, area, valve)


def begin_valve(valve: Valve, spool: Spool, flows: Lands, drop: Lands, memory: NDArray) -> None:
    """Fill what a valve keeps that has been at rest with flows [m^3/s] of its lands under drops [Pa]."""
    if isinstance(valve, ServoValve):
        begin_servo(valve, spool.position, flows, drop, memory)
