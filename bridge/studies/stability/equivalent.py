"""The symmetric drive of chapter 5 that stands for a scenario's rig, and its loop in dimensionless numbers.

The rig has unequal areas, hoses, and a relief valve in place of a constant supply. Its drive has the mean area;
chambers of the length that gives the rig's oil spring B (A_l^2/V_l + A_u^2/V_u) = 2 A B/L at the scenario's start,
the hoses included; the supply's pressure with the valve shut; and the flow of one land, opened as far as the valve
goes, at that pressure, although the rig's pump delivers less. The drive has no friction unless one is given: the
seal's falls with speed, so it has no slope that damps.
"""

from typing import NamedTuple

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.controllers import Relay, WithGains
from bridge.scenario.gains import scale_of
from controller.stability.actuator.model import Drive
from controller.stability.actuator.scaling import Numbers, SampledGains, to_numbers
from twin.actuator import moduli
from twin.circuit.equilibrium import supply_at_rest
from twin.circuit.limits import held_oil_spring
from twin.circuit.step import Circuit
from twin.kernel import interpreted
from twin.load_at_rest import rigid_mass
from twin.orifice import flow
from twin.servo_valve import ServoValve


class Scaled(NamedTuple):
    """A scenario's loop, in SI and without dimensions."""

    scenario: str
    drive: Drive
    loop: SampledGains
    numbers: Numbers
    notes: tuple[str, ...]  # what the model does not have


def scaled(scenario: Scenario, friction: float = 0.0) -> Scaled:
    """The loop of a scenario, with a slope of the friction [N s/m]. Raises ScenarioError for one that has none."""
    drive = drive_of(scenario, friction)
    loop, notes = _loop(scenario, drive)
    return Scaled(scenario.name, drive, loop, to_numbers(drive, loop), notes)


def drive_of(scenario: Scenario, friction: float = 0.0) -> Drive:
    """The symmetric drive of the scenario's rig at its start."""
    circuit = circuit_of(scenario)
    parts, cylinder = circuit.parts, circuit.parts.cylinder
    modulus = interpreted(moduli)(cylinder).lower
    area, supply = 0.5 * (cylinder.area_lower + cylinder.area_upper), supply_at_rest(circuit_of(_shut(scenario))).tee
    return Drive(
        mass=rigid_mass(parts.load, scenario.start.position),
        area=area,
        length=2.0 * area * modulus / held_oil_spring(circuit, scenario.start.position),
        modulus=modulus,
        supply=supply,
        relief=0.0,
        flow=_open_flow(circuit, supply),
        friction=friction,
    )


def _shut(scenario: Scenario) -> Scenario:
    """The rig with a valve that is shut at rest: the centre of a switching one lets the pump run to the tank."""
    valve = scenario.rig.valve.model_copy(update={"kind": "proportional"})
    return scenario.model_copy(update={"rig": scenario.rig.model_copy(update={"valve": valve})})


def _open_flow(circuit: Circuit, drop: float) -> float:
    """Flow [m^3/s] of one land of the wide open valve at a pressure drop [Pa]."""
    valve = circuit.parts.valve
    area = valve.p_a.area if isinstance(valve, ServoValve) else valve.area
    return float(flow(drop, area, valve.orifice, circuit.parts.oil))


def _loop(scenario: Scenario, drive: Drive) -> tuple[SampledGains, tuple[str, ...]]:
    own, times = scenario.controller, (scenario.loop.sample_period, scenario.loop.delay)
    if isinstance(own, Relay):
        note = (
            f"a relay knows the sign alone, so d/s only: s = 1 stands for any; its limit is {own.limit:g} of the travel"
        )
        return SampledGains(*times, 1.0 / drive.length, own.derivative_time / drive.length), (note,)
    if not isinstance(own, WithGains):
        raise ScenarioError(f"controller.kind {own.kind!r} has no gain; set controller.kind = 'pd' or 'relay'")
    scale = scale_of(scenario)
    without = {"pd": "", "pid": "integral and feed-forward are left out: "}.get(own.kind, "of your law ")
    notes = (f"{without}the gains count alone",) if without else ()
    return SampledGains(*times, scale.per_metre(own.gain), scale.per_metre(own.derivative)), notes
