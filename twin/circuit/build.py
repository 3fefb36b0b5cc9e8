"""From the numbers of a rig to its circuit, or one line that says why there is none."""

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

from twin.amplifier import Amplifiers, Direct, lag
from twin.circuit.build_mechanics import actuator_of, friction_of, load_of, same_kind, stops_of
from twin.circuit.build_servo import servo_valve
from twin.circuit.build_supply import accumulators, check_valve, fitting, return_end, supply
from twin.circuit.fit_accessories import necks
from twin.circuit.limits import refuse_coarse_step
from twin.circuit.oil import air_of, line_spec, oil_of, pipe_volume
from twin.circuit.step import AtTee, Circuit, OwnLine, Parts
from twin.directional_valve import Valve
from twin.lines.bank import Bank, LineSpec, bank_of
from twin.minor_losses import Losses, MinorLosses, NoLosses, loss_per_flow_squared
from twin.oil import Oil
from twin.orifice import Orifice, area_for
from twin.relief.direct import direct_relief
from twin.relief.slot import AnyRelief, NoRelief
from twin.relief.steady import precompression_for
from twin.relief.valve import Relief, relief
from twin.rig import Values
from twin.spool_valve import SpoolValve, step_matrix
from twin.switching_valve import SwitchingValve
from twin.topology import PIPES, RELIEF_LINE

Entries = Mapping[str, Any]
REMEMBERED = 1000  # lines and screws of what was built before: both take some 40 ms


def build(rig: Values, step: float) -> Circuit:
    """The circuit of a rig at an internal step [s]. Raises ValueError where the step is too coarse for a part."""
    oil = oil_of(rig)
    parts = Parts(
        step=step,
        oil=oil,
        supply=supply(rig, step),
        **accumulators(rig, oil),
        relief=_relief(rig, oil, step),
        relief_place=_relief_place(rig),
        fitting=fitting(rig),
        check=check_valve(rig),
        return_end=return_end(rig, oil),
        valve=_directional_valve(rig, oil, step),
        necks=necks(rig, oil, step),
        cylinder=actuator_of(rig, oil),
        seal=friction_of(rig, oil),
        stops=stops_of(rig),
        load=load_of(rig),
        losses=_losses(rig, oil),
        amplifiers=_amplifiers(rig["amplifier"], step),
        line_volume=sum(pipe_volume(rig[name]) for name in fitted_pipes(rig)),
    )
    lines = _lines(_specs(rig, oil), step, oil.vapour_pressure)
    circuit = Circuit(parts, lines)
    refuse_coarse_step(circuit)
    return circuit


def fitted_pipes(rig: Values) -> tuple[str, ...]:
    """The lines of a rig: the six, and that of the relief valve if it has one."""
    return (*PIPES, RELIEF_LINE) if rig["relief"]["place"] == RELIEF_LINE else tuple(PIPES)


def rebuild(circuit: Circuit, rig: Values, name: str) -> Circuit:
    """The circuit after one number of its rig, "load.force", has changed while it runs; the rest is taken as it is.

    Only a change of the setting turns the screw of the relief valve's pilot, and the areas of the valves stay when the
    oil becomes warmer. Raises ValueError where the step is too coarse for the new number.
    """
    part = name.partition(".")[0]
    if part == "oil":
        then = _with_oil(circuit, rig)
    elif name in SCREW:
        then = _with_parts(circuit, {"relief": _relief(rig, circuit.parts.oil, circuit.parts.step)})
    else:
        then = _with_parts(circuit, MADE[part](rig, circuit.parts))
    refuse_coarse_step(then)
    return then


SUPPLIES = ("pump", "fixed_pump", "variable_pump", "pressure_source")
FITTINGS = ("filter", "two_position_valve", "check_valve")
SCREW = ("relief.setting", "relief.setting_flow")
MADE: dict[str, Callable[[Values, Parts], dict[str, Any]]] = {  # fields of Parts that one part of the rig makes
    **dict.fromkeys(SUPPLIES, lambda rig, parts: {"supply": supply(rig, parts.step)}),
    "accumulator": lambda rig, parts: accumulators(rig, parts.oil),
    "direct_relief": lambda rig, parts: {"relief": _as_screwed(rig, parts, parts.oil)},
    "relief": lambda rig, parts: {"relief": _as_screwed(rig, parts, parts.oil)},
    **dict.fromkeys(FITTINGS, lambda rig, _: {"fitting": fitting(rig), "check": check_valve(rig)}),
    "return_end": lambda rig, parts: {"return_end": return_end(rig, parts.oil)},
    "valve": lambda rig, parts: {"valve": _directional_valve(rig, parts.oil, parts.step)},
    "switching_valve": lambda rig, parts: {"valve": _directional_valve(rig, parts.oil, parts.step)},
    "accessory_a": lambda rig, parts: {"necks": necks(rig, parts.oil, parts.step)},
    "accessory_b": lambda rig, parts: {"necks": necks(rig, parts.oil, parts.step)},
    "cushion": lambda rig, parts: {"necks": necks(rig, parts.oil, parts.step)},
    "servo_valve": lambda rig, parts: {"valve": _directional_valve(rig, parts.oil, parts.step)},
    "cylinder": lambda rig, parts: {"cylinder": same_kind(actuator_of(rig, parts.oil), parts), "stops": stops_of(rig)},
    "motor": lambda rig, parts: {"cylinder": actuator_of(rig, parts.oil), "load": load_of(rig)},
    "seal": lambda rig, parts: {"seal": friction_of(rig, parts.oil)},
    "friction": lambda rig, parts: {"seal": friction_of(rig, parts.oil)},
    "load": lambda rig, _: {"load": load_of(rig)},
    "minor_losses": lambda rig, parts: {"losses": _losses(rig, parts.oil)},
    "amplifier": lambda rig, parts: {"amplifiers": _amplifiers(rig["amplifier"], parts.step)},
}


def _with_parts(circuit: Circuit, fields: dict[str, Any]) -> Circuit:
    return circuit._replace(parts=circuit.parts._replace(**fields))


def _with_oil(circuit: Circuit, rig: Values) -> Circuit:
    oil, step = oil_of(rig), circuit.parts.step
    fields = {
        "oil": oil,
        "relief": _as_screwed(rig, circuit.parts, oil),
        "return_end": return_end(rig, oil),
        **accumulators(rig, oil),
        "necks": necks(rig, oil, step),
        "cylinder": actuator_of(rig, oil),
        "seal": friction_of(rig, oil),
    }
    lines = _specs(rig, oil)
    return _with_parts(circuit, fields)._replace(lines=_lines(lines, step, oil.vapour_pressure))


def _as_screwed(rig: Values, parts: Parts, oil: Oil) -> AnyRelief:
    """The relief valve with the screw where it is."""
    if not isinstance(parts.relief, Relief):
        return _relief(rig, oil, parts.step)
    pilot = parts.relief.pilot
    return relief(relief_sizes(rig["relief"], pilot.preload / pilot.stiffness), oil)


def _relief(rig: Values, oil: Oil, step: float) -> AnyRelief:
    """The relief valve; if it has two stages, with its pilot spring precompressed for its setting."""
    valve = rig["relief"]
    if valve["kind"] == "none":
        return NoRelief()
    if valve["kind"] == "direct":
        return direct_relief(rig["direct_relief"], step)
    unset = relief(relief_sizes(valve, 0.0), oil)
    return relief(relief_sizes(valve, _precompression(valve["setting"], valve["setting_flow"], unset)), oil)


@lru_cache(REMEMBERED)
def _precompression(setting: float, flow: float, unset: Relief) -> float:
    return precompression_for(setting, flow, unset)


def relief_sizes(valve: Entries, precompression: float) -> dict[str, Any]:
    """What `relief` takes: a rig's numbers, but for the setting, and the precompression [m] of the pilot spring."""
    sizes = {name: value for name, value in valve.items() if name not in ("kind", "place", "setting", "setting_flow")}
    return sizes | {"pilot_precompression": precompression}


def _relief_place(rig: Values) -> AtTee | OwnLine:
    if rig["relief"]["place"] == "tee":
        return AtTee()
    return OwnLine(pipe_volume(rig[RELIEF_LINE]))


def _directional_valve(rig: Values, oil: Oil, step: float) -> Valve:
    if rig["valve"]["kind"] == "switching":
        return _switching(rig["switching_valve"], oil)
    if rig["valve"]["kind"] == "servo":
        return servo_valve(rig["servo_valve"], oil, step)
    return _valve(rig["valve"], oil, step)


def _valve(valve: Entries, oil: Oil, step: float) -> SpoolValve:
    orifice = Orifice(valve["discharge"], valve["transition"])
    omega = 2.0 * math.pi * valve["natural_frequency"]
    return SpoolValve(
        omega,
        valve["damping"],
        valve["rate"],
        valve["overlap"],
        area_for(valve["rated_flow"], 0.5 * valve["rated_drop"], orifice, oil),
        orifice,
        *_spool(omega, valve["damping"], step),
    )


_spool = lru_cache(REMEMBERED)(step_matrix)


def _switching(valve: Entries, oil: Oil) -> SwitchingValve:
    orifice = Orifice(valve["discharge"], valve["transition"])
    area = area_for(valve["rated_flow"], valve["rated_drop"], orifice, oil)
    speeds = 1.0 / valve["switching_time"], 1.0 / valve["return_time"]
    return SwitchingValve(*speeds, valve["cylinder_opens"], valve["idle_shuts"], area, orifice)


def _losses(rig: Values, oil: Oil) -> Losses:
    losses = rig["minor_losses"]
    if losses["kind"] == "none":
        return NoLosses()
    sizes = [(0.0 if rig[name]["model"] == "none" else losses[name], rig[name]["diameter"]) for name in PIPES]
    return MinorLosses(*(0.5 * loss_per_flow_squared(zeta, diameter, oil.density) for zeta, diameter in sizes))


def _amplifiers(amplifier: Entries, step: float) -> Amplifiers | Direct:
    if amplifier["kind"] == "none":
        return Direct()
    return Amplifiers(lag(amplifier["position"], step), lag(amplifier["pressure"], step))


@lru_cache(REMEMBERED)
def _lines(specs: tuple[LineSpec, ...], step: float, vapour_pressure: float) -> Bank:
    return bank_of(specs, step, vapour_pressure)


def _specs(rig: Values, oil: Oil) -> tuple[LineSpec, ...]:
    air, pressure = air_of(rig, oil), rig["oil"]["air_pressure"]
    return tuple(line_spec(rig[name], oil, air, pressure) for name in fitted_pipes(rig))
