"""How fast each part of a circuit is, which step still follows it, and which steps are refused."""

import math
from typing import NamedTuple

import numpy as np

from twin.circuit.step import Circuit
from twin.cylinder import Chambers, chamber_volumes
from twin.kernel import interpreted
from twin.pump import Pump
from twin.relief.direct import DirectRelief
from twin.seal import least_mass
from twin.servo_valve import ServoValve
from twin.switching_valve import SwitchingValve
from twin.topology import PIPES, RELIEF_LINE
from twin.variable_pump import VariablePump

FOLLOWED = 0.5  # omega h up to which the leapfrog keeps a frequency within (omega h)^2/24 = 1 %
STEPS_PER_TRAVEL = 8.0  # of a line, for its stated accuracy
STEPS_PER_TOOTH = 10.0  # of the pump


class Limit(NamedTuple):
    """The fastest thing in a part, and the longest step that still follows it."""

    part: str
    what: str
    time: float  # its own: 1/omega, travel or period [s]
    step: float  # [s]


def limits(circuit: Circuit) -> list[Limit]:
    """One or more for each part that has a time of its own. Stages of the relief valve have substeps of their own."""
    parts, stiffest = circuit.parts, stiffest_oil_spring(circuit)
    found = [
        Limit(pipe, "wave travel time", float(time), float(time) / STEPS_PER_TRAVEL)
        for pipe, time in zip((*PIPES, RELIEF_LINE), circuit.lines.travel_time, strict=False)
        if time > 0.0
    ]
    found.append(_oscillator("load", "on the oil shut in, stiffest place", stiffest, parts.load.mass))
    if parts.load.added > 0.0:
        found.append(_oscillator("load", "weight on its buffer", parts.load.stiffness, _reduced_mass(circuit)))
    if isinstance(parts.supply, Pump) and parts.supply.ripple > 0.0:
        tooth = 1.0 / parts.supply.tooth_frequency
        found.append(Limit("pump", "period of a tooth", tooth, tooth / STEPS_PER_TOOTH))
    return [*found, *_lags(circuit), _valve(circuit)]


def _lags(circuit: Circuit) -> list[Limit]:
    """First-order lags of swash plate and direct-operated relief valve, which any step keeps bounded."""
    supply, relief = circuit.parts.supply, circuit.parts.relief
    found = []
    if isinstance(supply, VariablePump) and supply.time > 0.0:
        found.append(Limit("variable_pump", "lag of the swash plate", supply.time, supply.time))
    if isinstance(relief, DirectRelief) and relief.time > 0.0:
        found.append(Limit("direct_relief", "lag of the poppet", relief.time, relief.time))
    return found


def _valve(circuit: Circuit) -> Limit:
    valve = circuit.parts.valve
    if isinstance(valve, SwitchingValve):
        time = 1.0 / max(valve.speed, valve.return_speed)
        return Limit("switching_valve", "switching time", time, 0.5 * time)
    if isinstance(valve, ServoValve):
        quick = valve.motion.quickness or math.sqrt(valve.motion.spring)
        return Limit("servo_valve", "spool", 1.0 / quick, FOLLOWED / quick)
    time = 1.0 / valve.natural_frequency
    return Limit("valve", "spool", time, FOLLOWED * time)


def too_coarse(circuit: Circuit) -> list[Limit]:
    """The limits that the circuit's step exceeds."""
    return [limit for limit in limits(circuit) if circuit.parts.step > limit.step * (1.0 + 1e-9)]


def _oscillator(part: str, what: str, stiffness: float, mass: float) -> Limit:
    time = math.sqrt(mass / stiffness)
    return Limit(part, what, time, FOLLOWED * time)


def _reduced_mass(circuit: Circuit) -> float:
    load = circuit.parts.load
    return load.mass * load.added / (load.mass + load.added)


def refuse_coarse_step(circuit: Circuit) -> None:
    """ValueError for a step at which a part of the scheme would have no answer or none that stays bounded."""
    load, step = circuit.parts.load, circuit.parts.step
    if load.mass < (least := stiffest_oil_spring(circuit) * step**2):
        raise ValueError(
            f"load.mass {load.mass} kg swings too fast on the oil for a step of {step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step"
        )
    if load.mass < (least := least_mass(circuit.parts.seal, 0.5 * step)):
        raise ValueError(
            f"load.mass {load.mass} kg is too light for the seal's friction at a step of {step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step or seal.limit = 0"
        )
    least = math.pi * step * math.sqrt(1.0 + load.added / load.mass)
    if load.added > 0.0 and (given := math.pi * math.sqrt(load.added / load.stiffness)) < least:
        raise ValueError(
            f"load.contact_time {given:.3g} s is too short for a step of {step} s: at least {least:.3g} s; "
            "take a smaller loop.step or a longer contact_time"
        )


def stiffest_oil_spring(circuit: Circuit) -> float:
    """Stiffness [N/m] of the oil of the chambers, the piston at the end of the stroke where it is greatest."""
    return max(oil_spring(circuit, position) for position in (0.0, circuit.parts.cylinder.stroke))


def oil_spring(circuit: Circuit, position: float) -> float:
    """Stiffness [N/m] of the oil in both chambers, the lines shut off, the piston at a position [m]."""
    cylinder = circuit.parts.cylinder
    volume = interpreted(chamber_volumes)(position, cylinder)
    areas = Chambers(cylinder.area_lower, cylinder.area_upper)
    return cylinder.bulk_modulus * sum(area**2 / v for area, v in zip(areas, volume, strict=True))


def natural_frequency(circuit: Circuit, position: float) -> float:
    """omega_h [rad/s] of the load on the oil of chambers and cylinder lines, both ends of the valve shut."""
    cylinder, lines = circuit.parts.cylinder, circuit.lines
    volume = interpreted(chamber_volumes)(position, cylinder)
    lower = volume.lower / cylinder.bulk_modulus + lines.capacity[2]
    upper = volume.upper / cylinder.bulk_modulus + lines.capacity[3]
    stiffness = cylinder.area_lower**2 / lower + cylinder.area_upper**2 / upper
    return float(np.sqrt(stiffness / circuit.parts.load.mass))
