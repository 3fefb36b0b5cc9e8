"""What follows from the numbers of supply, accumulator, relief valve and return end, in words and numbers."""

import math
from typing import Any, NamedTuple

from bridge.scenario.model import Scenario
from bridge.scenario.relief_swing import below_rest, in_numbers, swing_of
from twin.accumulator import ATMOSPHERE, Accumulator, AnyAccumulator, oil_at_rest
from twin.check_valve import CheckValve
from twin.circuit.equilibrium import SupplyAtRest, behind_check
from twin.circuit.step import Circuit
from twin.pressure_source import PressureSource
from twin.pump import Pump
from twin.relief.direct import DirectRelief
from twin.relief.poppet import cracking_pressure
from twin.relief.valve import Relief
from twin.return_end import CheckedEnd, OrificeEnd
from twin.supply import Supply
from twin.variable_pump import VariablePump


class Fact(NamedTuple):
    """Something that follows from the values."""

    what: str
    value: str


def supply_facts(circuit: Circuit, at: SupplyAtRest) -> list[Fact]:
    """Supply, accumulator, check valve and return end."""
    parts = circuit.parts
    at_rest = f"p1 = {_bar(at.tee)}, {_flow(at.relieved)} over the relief valve"
    found = [*_source(parts.supply), Fact("supply with the valve at rest", at_rest)]
    found += _accumulator("tee", parts.tee_accumulator, at.tee)
    found += _accumulator("P", parts.p_accumulator, behind_check(at.tee, circuit))
    if isinstance(parts.check, CheckValve):
        found.append(Fact("check valve in line 2", f"opens at {_bar(parts.check.cracking_pressure)}"))
    if isinstance(parts.return_end, CheckedEnd):
        found.append(Fact("end of line 6", f"check valve, opens at {_bar(parts.return_end.cracking_pressure)}"))
    if isinstance(parts.return_end, OrificeEnd | CheckedEnd):
        flow = math.sqrt(1e5 / parts.return_end.quadratic)
        found.append(Fact("end of line 6: orifice", f"{_flow(flow)} at 1 bar, turbulent"))
    return found


def _source(supply: Supply) -> list[Fact]:
    if isinstance(supply, PressureSource):
        resistance = supply.resistance / 6e9
        return [Fact("pressure source", f"{_bar(supply.pressure)}, {resistance:.4g} bar/(l/min) within")]
    found = [Fact("pump: mean flow at no pressure", _flow(supply.delivery))]
    if isinstance(supply, Pump) and supply.ripple > 0.0:
        found.append(Fact("pump: frequency of the teeth", f"{supply.tooth_frequency:.4g} Hz"))
    if isinstance(supply, VariablePump):
        span = f"{_bar(supply.cut_off)} to {_bar(supply.cut_off + supply.droop)}"
        found.append(Fact("pump: swings back", f"from {span}, to {_flow(supply.delivery * supply.least)}"))
    return found


def _accumulator(place: str, accumulator: AnyAccumulator, pressure: float) -> list[Fact]:
    if not isinstance(accumulator, Accumulator):
        return []
    oil = oil_at_rest(pressure, accumulator)
    gas = accumulator.volume - oil
    text = f"{oil * 1e3:.4g} l of oil, {gas * 1e3:.4g} l of gas at {_bar(pressure)}"
    if oil > 0.0:
        per_bar = 1e5 * gas / (accumulator.exponent * (pressure + ATMOSPHERE))
        text += f", {per_bar * 1e6:.4g} cm^3/bar"
    return [Fact(f"accumulator at {place}, valve at rest", text if oil > 0.0 else "shut: below its precharge")]


def relief_facts(circuit: Circuit, scenario: Scenario) -> list[Fact]:
    """What sets the relief valve, and how its bodies swing."""
    valve = circuit.parts.relief
    if isinstance(valve, DirectRelief):
        shuts = valve.cracking_pressure - valve.hysteresis
        return [Fact("relief valve: cracks, shuts", f"{_bar(valve.cracking_pressure)}, {_bar(shuts)}")]
    return _two_stages(valve, scenario) if isinstance(valve, Relief) else []


def _two_stages(valve: Relief, scenario: Scenario) -> list[Fact]:
    pilot, main = valve.pilot, valve.main
    found = swing_of(scenario)
    numbers = below_rest(scenario) if found is None else in_numbers(found)
    words = "relief valve: its pilot oscillates by itself (linear theory)"
    return [
        *([Fact(words, numbers)] if numbers else []),
        Fact("relief valve: cracking pressure", _bar(cracking_pressure(pilot))),
        Fact("relief valve: pilot, spool without oil", f"{_hertz(pilot):.4g} Hz, {_hertz(main):.4g} Hz"),
    ]


def _hertz(stage: Any) -> float:
    return math.sqrt(stage.stiffness / stage.mass) / (2.0 * math.pi)


def _bar(pressure: float) -> str:
    return f"{pressure / 1e5:.4g} bar"


def _flow(flow: float) -> str:
    return f"{flow * 6e4:.4g} l/min"
