"""From the numbers of a rig to what feeds it, relieves it and takes its oil back."""

import math
from collections.abc import Mapping
from typing import Any

from twin.accumulator import Accumulator, AnyAccumulator, NoAccumulator
from twin.check_valve import AnyCheck, CheckValve, NoCheck
from twin.fitting import Fitting
from twin.fixed_pump import FixedPump
from twin.lag import lag_over
from twin.oil import Oil
from twin.orifice import Orifice, resistance
from twin.pressure_source import PressureSource
from twin.pump import Pump, displacement, ripple_volume
from twin.return_end import AnyEnd, CheckedEnd, OpenEnd, OrificeEnd
from twin.rig import Values
from twin.supply import Supply
from twin.variable_pump import VariablePump

Entries = Mapping[str, Any]


def supply(rig: Values, step: float) -> Supply:
    """What feeds line 1."""
    kind = rig["supply"]["kind"]
    if kind == "fixed":
        return _fixed_pump(rig["fixed_pump"])
    if kind == "variable":
        return _variable_pump(rig["variable_pump"], step)
    if kind == "pressure":
        return PressureSource(**rig["pressure_source"])
    return _gear_pump(rig["pump"])


def _gear_pump(pump: Entries) -> Pump:
    gear = pump["width"], pump["module"], pump["teeth"], pump["pressure_angle"]
    lost = (1.0 - pump["efficiency"]) * displacement(*gear) * pump["efficiency_speed"]
    ripple = ripple_volume(*gear) if pump["ripple"] == "teeth" and pump["speed"] > 0.0 else 0.0
    return Pump(
        delivery=displacement(*gear) * pump["speed"],
        leakage=lost / pump["efficiency_pressure"],
        tooth_frequency=pump["teeth"] * pump["speed"],
        ripple=ripple,
        run_up=pump["run_up"],
    )


def _fixed_pump(pump: Entries) -> FixedPump:
    return FixedPump(pump["displacement"] * pump["speed"], pump["leakage"], pump["run_up"])


def _variable_pump(pump: Entries, step: float) -> VariablePump:
    greatest, least = pump["displacement"], pump["least_displacement"]
    if least > greatest:
        raise ValueError(
            f"variable_pump.least_displacement {least} m^3 must not exceed variable_pump.displacement {greatest} m^3"
        )
    return VariablePump(
        delivery=greatest * pump["speed"],
        least=least / greatest,
        cut_off=pump["cut_off"],
        droop=pump["droop"],
        leakage=pump["leakage"],
        time=pump["time_constant"],
        swash=lag_over(pump["time_constant"] / step),
        run_up=pump["run_up"],
    )


def accumulators(rig: Values, oil: Oil) -> dict[str, AnyAccumulator]:
    """Fields of Parts: the accumulator where it sits, and none where it could sit."""
    numbers = rig["accumulator"]
    fields: dict[str, AnyAccumulator] = {"tee_accumulator": NoAccumulator(), "p_accumulator": NoAccumulator()}
    if numbers["kind"] == "bladder":
        fields[f"{numbers['at']}_accumulator"] = _accumulator(numbers, oil)
    return fields


def _accumulator(numbers: Entries, oil: Oil) -> Accumulator:
    inlet = Orifice(numbers["inlet_discharge"], numbers["inlet_transition"])
    losses = resistance(area(numbers["inlet_diameter"]), inlet, oil)
    return Accumulator(numbers["volume"], numbers["precharge"], numbers["exponent"], *losses)


def fitting(rig: Values) -> Fitting:
    """Filter, two-position valve and, beyond its cracking pressure, the check valve, in series."""
    strainer, two_position, check = rig["filter"], rig["two_position_valve"], rig["check_valve"]
    quadratic = two_position["drop"] / two_position["flow"] ** 2
    if check["kind"] == "fitted":
        quadratic += check["drop"] / check["flow"] ** 2
    return Fitting(strainer["drop"] / strainer["flow"], quadratic)


def check_valve(rig: Values) -> AnyCheck:
    """The check valve of line 2."""
    check = rig["check_valve"]
    return CheckValve(check["cracking_pressure"]) if check["kind"] == "fitted" else NoCheck()


def return_end(rig: Values, oil: Oil) -> AnyEnd:
    """What line 6 ends in."""
    end = rig["return_end"]
    if end["kind"] == "open":
        return OpenEnd()
    losses = resistance(area(end["diameter"]), Orifice(end["discharge"], end["transition"]), oil)
    return OrificeEnd(*losses) if end["kind"] == "orifice" else CheckedEnd(end["cracking_pressure"], *losses)


def area(diameter: float) -> float:
    """Area [m^2] of a round hole."""
    return math.pi / 4.0 * diameter**2
