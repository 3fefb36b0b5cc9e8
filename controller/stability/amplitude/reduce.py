"""From a circuit to its reduced drive, and to where it rests."""

import numpy as np

from controller.stability.amplitude.drive import Capacities, Drive, DriveState, Line, Supply
from controller.stability.amplitude.run import resting
from twin.actuator import moduli
from twin.circuit.equilibrium import supply_at_rest
from twin.circuit.step import Circuit, Parts
from twin.compliant import Compliant
from twin.friction import NoFriction
from twin.kernel import interpreted
from twin.lever import Lever
from twin.load import Load
from twin.load_slot import HeldLoad
from twin.lugre import LuGre
from twin.minor_losses import loss_at_end
from twin.pump import Pump
from twin.relief.slot import steady_relief
from twin.seal import Seal
from twin.servo_valve import ServoValve
from twin.stribeck import Stribeck
from twin.supply import steady_supply

ANGULAR = 2.0 * np.pi * 30.0  # [rad/s], at which oil in the lines resists: swings between 2 and 40 Hz matter
KNEE = 0.3  # of the flow at rest, down to where the relief valve's curve is taken as straight
UNLIMITED = 1e12  # [Pa]


def reduced(circuit: Circuit) -> Drive:
    """The drive of a circuit. Raises ValueError for one with a part that the drive leaves out."""
    parts, lines = circuit.parts, circuit.lines
    load, seal = _without_states(parts)
    if isinstance(parts.valve, ServoValve):
        raise ValueError("the reduced drive has no servo valve: take valve.kind = 'proportional' or 'switching'")
    half = 0.5 * lines.capacity
    cylinder, b = parts.cylinder, interpreted(moduli)(parts.cylinder)
    lower, upper = float(half[2]) * b.lower, float(half[3]) * b.upper  # as dead volumes of the same capacity
    meet = (lines.capacity[0] + half[1], half[1], half[2], half[3], half[4], half[4] + half[5])
    return Drive(
        load=load._replace(added=0.0) if isinstance(load, Load) else load,
        stops=parts.stops,
        oil=parts.oil,
        cylinder=cylinder._replace(dead_lower=cylinder.dead_lower + lower, dead_upper=cylinder.dead_upper + upper),
        seal=seal,
        valve=parts.valve,
        supply=_supply(circuit),
        fitting=parts.fitting,
        capacities=Capacities(*map(float, meet)),
        **{f"line_{number}": _line(number - 1, circuit) for number in range(2, 7)},
    )


def _without_states(parts: Parts) -> tuple[Load | HeldLoad | Lever, Seal | Stribeck | NoFriction]:
    """Load and friction. Raises ValueError for those with a state of their own."""
    if isinstance(parts.load, Compliant):
        raise ValueError("the reduced drive has one mass: take load.kind = 'environment' with the sum of both masses")
    if isinstance(parts.seal, LuGre):
        raise ValueError("the reduced drive has no bristles: take friction.kind = 'stribeck' with the same curve")
    return parts.load, parts.seal


def at_rest(d: Drive, circuit: Circuit, position: float, p_upper: float) -> DriveState:
    """The drive where a run of the circuit starts."""
    return resting(d, position, p_upper, supply_at_rest(circuit).tee)


def _line(number: int, circuit: Circuit) -> Line:
    """A line whose oil resists as in a swing: by its boundary layer, never less than in steady flow."""
    lines, nu = circuit.lines, circuit.parts.oil.viscosity
    inertance, steady = float(lines.inertance[number]), float(lines.resistance[number])
    elbows = 2.0 * loss_at_end(circuit.parts.losses, number)
    if steady == 0.0:
        return Line(inertance, 0.0, elbows)
    radius = np.sqrt(8.0 * nu * inertance / steady)
    layer = inertance * np.sqrt(2.0 * nu * ANGULAR) / radius
    return Line(inertance, float(max(steady, layer)), elbows)


def _supply(circuit: Circuit) -> Supply:
    """The supply as a flow less a leakage, the relief valve's curve as a straight line from the flow at rest down to
    its knee."""
    at, valve = supply_at_rest(circuit), circuit.parts.relief
    delivery, leakage = _delivery(circuit, at.pump)
    if at.relieved <= 0.0:
        return Supply(delivery, leakage, UNLIMITED, 0.0)
    low = high = at.tee
    while (flow := steady_relief(valve, low)) > KNEE * at.relieved:
        low -= 2e-3 * at.tee
    slope = (at.relieved - flow) / (high - low)
    return Supply(delivery, leakage, high - at.relieved / slope, slope)


def _delivery(circuit: Circuit, pressure: float) -> tuple[float, float]:
    """Flow at no pressure [m^3/s] and leakage [m^3/(s Pa)]; of other supplies than the gear pump by their slope."""
    supply = circuit.parts.supply
    if isinstance(supply, Pump):
        return supply.delivery, supply.leakage
    flow, slope = steady_supply(supply, pressure, 1.0, circuit.parts.oil)
    return flow - slope * pressure, -slope
