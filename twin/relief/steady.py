"""Steady states of the relief valve by bracketing, apart from the stepper: `README.md`.

At an inlet pressure p with nothing moving p3 = p2, and everything follows from two balances, one after the other: the
poppet's (its lift sets the flow through orifices 1, 2 and the seat), then the spool's. The function iteration of the
thesis, 2.4.4, diverges beyond the knee; a bracket cannot.
"""

import math

from twin.kernel import kernel
from twin.orifice import quadratic_flow
from twin.relief.main_stage import MainStage, main_opening, spool_spring
from twin.relief.poppet import cracking_pressure, pilot_opening, spring_force
from twin.relief.seat import laminar_conductance
from twin.relief.valve import Relief, ReliefState

HALVINGS = 120  # more than the digits of a float
HIGHEST = 1e12  # [Pa] beyond which no pressure is looked for


@kernel
def pilot_pressure(pressure: float, lift: float, valve: Relief) -> float:
    """p2 [Pa] at a lift: a Q^2 + b Q + (Q/R)^2 = p through orifices 1, 2 and the seat."""
    laminar = laminar_conductance(valve.pilot.seat, lift)
    if laminar > 0.0:
        return quadratic_flow(pressure, valve.orifices.a_12, valve.orifices.b_12 + 1.0 / laminar) / laminar
    conductance, _ = pilot_opening(lift, valve.pilot)
    if conductance == 0.0:
        return pressure
    flow = quadratic_flow(pressure, valve.orifices.a_12 + 1.0 / conductance**2, valve.orifices.b_12)
    return (flow / conductance) ** 2


@kernel
def pilot_surplus(pressure: float, lift: float, valve: Relief) -> float:
    """Force that opens the poppet at a lift [N]; falls with the lift."""
    _, area = pilot_opening(lift, valve.pilot)
    return area * pilot_pressure(pressure, lift, valve) - spring_force(lift, valve.pilot)


@kernel
def pilot_lift(pressure: float, valve: Relief) -> float:
    """Steady lift of the poppet [m]."""
    if pressure <= cracking_pressure(valve.pilot):
        return 0.0
    low, high = 0.0, valve.pilot.stops.stroke
    if pilot_surplus(pressure, high, valve) >= 0.0:
        return high
    for _ in range(HALVINGS):
        lift = 0.5 * (low + high)
        if not low < lift < high:
            return lift  # as all further halvings
        if pilot_surplus(pressure, lift, valve) > 0.0:
            low = lift
        else:
            high = lift
    return 0.5 * (low + high)


@kernel
def spool_surplus(pressure: float, p2: float, lift: float, main: MainStage) -> float:
    """Force that opens the spool at a lift [N]."""
    return main_opening(lift, main).area * pressure - main.area * p2 - spool_spring(lift, main)


@kernel
def spool_lift(pressure: float, p2: float, main: MainStage) -> float:
    """Steady lift of the spool [m], p2 in its spring chamber."""
    low, high = 0.0, main.stops.stroke
    if spool_surplus(pressure, p2, low, main) <= 0.0:
        return low
    if spool_surplus(pressure, p2, high, main) >= 0.0:
        return high
    for _ in range(HALVINGS):
        lift = 0.5 * (low + high)
        if not low < lift < high:
            return lift
        if spool_surplus(pressure, p2, lift, main) > 0.0:
            low = lift
        else:
            high = lift
    return 0.5 * (low + high)


@kernel
def rest(pressure: float, valve: Relief) -> ReliefState:
    """The valve at rest under an inlet pressure [Pa]."""
    pilot = pilot_lift(pressure, valve)
    return ReliefState(pilot, 0.0, spool_lift(pressure, pilot_pressure(pressure, pilot, valve), valve.main), 0.0)


@kernel
def steady_flow(pressure: float, valve: Relief) -> float:
    """Q [m^3/s], both stages, at a steady inlet pressure [Pa]."""
    s = rest(pressure, valve)
    if s.pilot_lift == 0.0:
        return 0.0
    pilot = pilot_flow(pilot_pressure(pressure, s.pilot_lift, valve), s.pilot_lift, valve)
    return pilot + main_opening(s.spool_lift, valve.main).conductance * math.sqrt(pressure)


@kernel
def pilot_flow(p2: float, lift: float, valve: Relief) -> float:
    """Q [m^3/s] through the pilot seat, chamfered or long."""
    laminar = laminar_conductance(valve.pilot.seat, lift)
    if laminar > 0.0:
        return laminar * p2
    return pilot_opening(lift, valve.pilot)[0] * math.sqrt(p2)


@kernel
def steady_slope(pressure: float, valve: Relief) -> float:
    """dQ/dp [m^3/(s Pa)]: a central difference, 1e-5 of the pressure wide, of a flow known to rounding."""
    width = 0.5e-5 * abs(pressure)
    if width == 0.0:
        return 0.0
    return (steady_flow(pressure + width, valve) - steady_flow(pressure - width, valve)) / (2.0 * width)


@kernel
def steady_pressure(flow: float, valve: Relief) -> float:
    """p [Pa] at which the valve passes a flow [m^3/s]; the cracking pressure at none, about HIGHEST if none does."""
    low = cracking_pressure(valve.pilot)
    if flow <= 0.0:
        return low
    high = low + 1e5
    while steady_flow(high, valve) < flow and high < HIGHEST:
        high = low + 2.0 * (high - low)
    for _ in range(60):
        pressure = 0.5 * (low + high)
        if steady_flow(pressure, valve) < flow:
            low = pressure
        else:
            high = pressure
    return 0.5 * (low + high)


def precompression_for(setting_pressure: float, setting_flow: float, valve: Relief) -> float:
    """Precompression of the pilot's spring [m] with which the valve holds a pressure [Pa] at a flow [m^3/s].

    The one that `valve` has plays no part. Raises ValueError where no spring force can.
    """
    pilot = valve.pilot
    low, high = 0.0, setting_pressure * pilot.shut_area / pilot.stiffness
    if steady_pressure(setting_flow, _preloaded(low, valve)) > setting_pressure:
        least = steady_pressure(setting_flow, _preloaded(low, valve))
        raise ValueError(
            f"the relief valve cannot hold {setting_pressure} Pa at {setting_flow} m^3/s: without any precompression "
            f"of its pilot spring it needs {least:.0f} Pa; take a higher setting or less flow"
        )
    for _ in range(60):
        middle = 0.5 * (low + high)
        if steady_pressure(setting_flow, _preloaded(middle, valve)) < setting_pressure:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _preloaded(precompression: float, valve: Relief) -> Relief:
    pilot = valve.pilot
    return valve._replace(pilot=pilot._replace(preload=pilot.stiffness * precompression))
