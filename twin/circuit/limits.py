"""How fast each part of a circuit is, which step still follows it, and which steps are refused."""

import math
from typing import NamedTuple

from twin.accessory import between
from twin.actuator import areas, moduli, volumes
from twin.circuit.step import Circuit
from twin.compliant import Compliant
from twin.counterbalance import Counterbalance
from twin.kernel import interpreted
from twin.load import Load
from twin.load_at_rest import inertia_at, rigid_mass, surroundings
from twin.load_slot import AnyLoad
from twin.lugre import LuGre
from twin.pilot_check import PilotCheck
from twin.pump import Pump
from twin.relief.direct import DirectRelief
from twin.seal import Seal, least_mass
from twin.servo_valve import ServoValve
from twin.switching_valve import SwitchingValve
from twin.topology import PIPES, RELIEF_LINE
from twin.valve_body import MOST_SUBSTEPS, TURN, Mass
from twin.variable_pump import VariablePump

FOLLOWED = 0.5  # omega h up to which the leapfrog keeps a frequency within (omega h)^2/24 = 1 %
STEPS_PER_TRAVEL = 8.0  # of a line, for its stated accuracy
STEPS_PER_TOOTH = 10.0  # of the pump
PLACES_TRIED = 16  # over the stroke, for the lightest one


class Limit(NamedTuple):
    """The fastest thing in a part, and the longest step that still follows it."""

    part: str
    what: str
    time: float  # its own: 1/omega, travel or period [s]
    step: float  # [s]


def limits(circuit: Circuit) -> list[Limit]:
    """One or more for each part that has a time of its own. Stages of the relief valve have substeps of their own."""
    parts, stiffest = circuit.parts, stiffest_oil_spring(circuit) + surroundings(circuit.parts.load).stiffness
    found = [
        Limit(pipe, "wave travel time", float(time), float(time) / STEPS_PER_TRAVEL)
        for pipe, time in zip((*PIPES, RELIEF_LINE), circuit.lines.travel_time, strict=False)
        if time > 0.0
    ]
    found.append(_oscillator("load", "on the oil shut in, stiffest place", stiffest, least_inertia(circuit)))
    found += _second_body(parts.load)
    if isinstance(parts.seal, LuGre):
        found.append(_oscillator("friction", "on its bristles", parts.seal.stiffness, least_inertia(circuit)))
    if isinstance(parts.supply, Pump) and parts.supply.ripple > 0.0:
        tooth = 1.0 / parts.supply.tooth_frequency
        found.append(Limit("pump", "period of a tooth", tooth, tooth / STEPS_PER_TOOTH))
    return [*found, *_lags(circuit), *_bodies(circuit), _valve(circuit)]


def _bodies(circuit: Circuit) -> list[Limit]:
    """Bodies of the accessories on their springs, by substeps; those of first order are exact at any step."""
    necks = between(circuit.parts.necks)
    found = []
    for name, valve in (("accessory_a", necks.accessory_a), ("accessory_b", necks.accessory_b)):
        if isinstance(valve, Counterbalance | PilotCheck) and isinstance(body := valve.body, Mass):
            time = math.sqrt(body.mass / body.stiffness)
            found.append(Limit(name, "body on its spring, by substeps", time, MOST_SUBSTEPS * TURN * time))
    return found


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


def _second_body(load: AnyLoad) -> list[Limit]:
    """Two masses on what is between them."""
    if isinstance(load, Load) and load.added > 0.0:
        reduced = load.mass * load.added / (load.mass + load.added)
        return [_oscillator("load", "weight on its buffer", load.stiffness, reduced)]
    if isinstance(load, Compliant):
        reduced = load.near * load.far / (load.near + load.far)
        return [_oscillator("load", "two masses on their link", load.link_stiffness, reduced)]
    return []


def least_inertia(circuit: Circuit) -> float:
    """Smallest mass [kg] that moves with the piston, over the stroke."""
    stroke = circuit.parts.cylinder.stroke
    return min(inertia_at(circuit.parts.load, i / PLACES_TRIED * stroke) for i in range(PLACES_TRIED + 1))


def refuse_coarse_step(circuit: Circuit) -> None:
    """ValueError for a step at which a part of the scheme would have no answer or none that stays bounded."""
    load, step, mass = circuit.parts.load, circuit.parts.step, least_inertia(circuit)
    if mass < (least := _stiffness_on_piston(circuit) * step**2):
        raise ValueError(
            f"load.mass {mass} kg swings too fast on the oil for a step of {step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step"
        )
    if isinstance(circuit.parts.seal, Seal) and mass < (least := least_mass(circuit.parts.seal, 0.5 * step)):
        raise ValueError(
            f"load.mass {mass} kg is too light for the seal's friction at a step of {step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step or seal.limit = 0"
        )
    if isinstance(load, Load):
        _refuse_short_contact(load, step)
    if isinstance(load, Compliant):
        _refuse_light_load(load, step)


def _stiffness_on_piston(circuit: Circuit) -> float:
    """Stiffness [N/m] of all springs that act on the piston."""
    load = circuit.parts.load
    own = load.link_stiffness if isinstance(load, Compliant) else surroundings(load).stiffness
    return stiffest_oil_spring(circuit) + own


def _refuse_light_load(load: Compliant, step: float) -> None:
    if load.far < (least := (load.link_stiffness + load.around.stiffness) * step**2):
        raise ValueError(
            f"load.far_mass {load.far} kg swings too fast on its link for a step of {step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step or load.link_stiffness"
        )


def _refuse_short_contact(load: Load, step: float) -> None:
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
    return _on_oil(circuit, position, (0.0, 0.0))


def _on_oil(circuit: Circuit, position: float, hoses: tuple[float, float]) -> float:
    """Stiffness [N/m] of the oil in both chambers and in what is joined to them [m^3/Pa]."""
    cylinder = circuit.parts.cylinder
    volume, b = interpreted(volumes)(cylinder, position), interpreted(moduli)(cylinder)
    area = interpreted(areas)(cylinder, position)
    return sum(a**2 / (v / modulus + hose) for a, v, modulus, hose in zip(area, volume, b, hoses, strict=True))


def held_oil_spring(circuit: Circuit, position: float) -> float:
    """Stiffness [N/m] of the oil in chambers and cylinder lines, the valve shut; without air in chambers."""
    return _on_oil(circuit, position, (float(circuit.lines.capacity[2]), float(circuit.lines.capacity[3])))


def natural_frequency(circuit: Circuit, position: float) -> float:
    """omega_h [rad/s] of the load on the oil of chambers and cylinder lines, both ends of the valve shut.

    With the spring around the load; of a compliant load, as if its link were rigid.
    """
    stiffness = held_oil_spring(circuit, position) + surroundings(circuit.parts.load).stiffness
    return math.sqrt(stiffness / rigid_mass(circuit.parts.load, position))
