"""From the numbers of a rig to its circuit, or one line that says why there is none."""

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from twin.amplifier import Amplifiers, Direct, lag
from twin.circuit.limits import refuse_coarse_step
from twin.circuit.step import Circuit, Fitted, Parts
from twin.contact import Stops
from twin.cylinder import Cylinder
from twin.fitting import Fitting
from twin.lines.bank import Bank, LineSpec, bank_of
from twin.load import Load, buffer_stiffness
from twin.minor_losses import Losses, MinorLosses, NoLosses, loss_per_flow_squared
from twin.oil import Oil, effective_modulus, fluid_modulus, kinematic_viscosity
from twin.orifice import Orifice, area_for
from twin.pump import Pump, displacement, ripple_volume
from twin.relief.steady import precompression_for
from twin.relief.valve import Relief, relief
from twin.rig import Values, values
from twin.seal import Seal, seal
from twin.spool_valve import SpoolValve, step_matrix
from twin.switching_valve import SwitchingValve
from twin.topology import PIPES

Entries = Mapping[str, Any]
BOTTOMLESS = -1e12  # [Pa], vapour pressure of oil that bears any tension
REMEMBERED = 8  # fits, in a process: rigs that differ in other numbers have these in common


def build(rig: Values, step: float) -> Circuit:
    """The circuit of a rig at an internal step [s]. Raises ValueError where the step is too coarse for a part."""
    oil, pipes = _oil(rig), [rig[name] for name in PIPES]
    parts = Parts(
        step=step,
        fitted=Fitted(float(rig["relief"]["kind"] != "none"), float(rig["valve"]["kind"] == "switching")),
        oil=oil,
        pump=_pump(rig["pump"]),
        relief=_relief(rig["relief"], oil),
        fitting=_fitting(rig["filter"], rig["two_position_valve"]),
        valve=_valve(rig["valve"], oil, step),
        switching=_switching(rig["switching_valve"], oil),
        cylinder=_cylinder(rig["cylinder"], oil),
        seal=_seal(rig["seal"], oil),
        stops=Stops(rig["cylinder"]["stroke"], rig["cylinder"]["restitution"], rig["cylinder"]["rest_speed"]),
        load=_load(rig["load"]),
        losses=_losses(rig["minor_losses"], pipes, oil.density),
        amplifiers=_amplifiers(rig["amplifier"], step),
        line_volume=sum(math.pi / 4.0 * pipe["diameter"] ** 2 * pipe["length"] for pipe in pipes),
    )
    lines = _lines(tuple(_line(pipe, oil) for pipe in pipes), step, oil.vapour_pressure)
    circuit = Circuit(parts, lines)
    refuse_coarse_step(circuit)
    return circuit


def _oil(rig: Values) -> Oil:
    """The fluid's own modulus follows from the wave speed measured in the steel pipe, (2.8), (2.9)."""
    oil, measured = rig["oil"], values()["pipe_1"]
    bore, wall, young = (measured[name] for name in ("diameter", "wall", "young"))
    modulus = fluid_modulus(oil["density"] * oil["wave_speed"] ** 2, bore, wall, young)
    if not 0.0 < modulus < math.inf:
        raise ValueError(
            f"oil.wave_speed {oil['wave_speed']} m/s is more than the steel pipe allows: its wall alone makes it "
            f"{math.sqrt(wall * young / (bore * oil['density'])):.0f} m/s; take a smaller one"
        )
    vapour = oil["vapour_pressure"] if oil["cavitation"] == "vapour" else BOTTOMLESS
    return Oil(oil["density"], kinematic_viscosity(oil["temperature"]), modulus, vapour)


def _pump(pump: Entries) -> Pump:
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


def _relief(valve: Entries, oil: Oil) -> Relief:
    """The valve whose pilot spring is precompressed for its setting."""
    unset = relief(relief_sizes(valve, 0.0), oil)
    if valve["kind"] == "none":
        return unset
    return relief(relief_sizes(valve, _precompression(valve["setting"], valve["setting_flow"], unset)), oil)


@lru_cache(REMEMBERED)
def _precompression(setting: float, flow: float, unset: Relief) -> float:
    return precompression_for(setting, flow, unset)


def relief_sizes(valve: Entries, precompression: float) -> dict[str, Any]:
    """What `relief` takes: a rig's numbers, but for the setting, and the precompression [m] of the pilot spring."""
    sizes = {name: value for name, value in valve.items() if name not in ("kind", "setting", "setting_flow")}
    return sizes | {"pilot_precompression": precompression}


def _fitting(strainer: Entries, two_position: Entries) -> Fitting:
    return Fitting(strainer["drop"] / strainer["flow"], two_position["drop"] / two_position["flow"] ** 2)


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
        *step_matrix(omega, valve["damping"], step),
    )


def _switching(valve: Entries, oil: Oil) -> SwitchingValve:
    orifice = Orifice(valve["discharge"], valve["transition"])
    area = area_for(valve["rated_flow"], valve["rated_drop"], orifice, oil)
    speeds = 1.0 / valve["switching_time"], 1.0 / valve["return_time"]
    return SwitchingValve(*speeds, valve["cylinder_opens"], valve["idle_shuts"], area, orifice)


def _cylinder(cylinder: Entries, oil: Oil) -> Cylinder:
    bore, rod = cylinder["bore"], cylinder["rod"]
    if rod >= bore:
        raise ValueError(f"cylinder.rod {rod} m must be thinner than cylinder.bore {bore} m")
    return Cylinder(
        area_lower=math.pi / 4.0 * (bore**2 - rod**2),
        area_upper=math.pi / 4.0 * bore**2,
        dead_lower=cylinder["dead_lower"],
        dead_upper=cylinder["dead_upper"],
        stroke=cylinder["stroke"],
        leakage=1.0 / cylinder["leakage_resistance"],
        bulk_modulus=oil.bulk_modulus,
        vapour_pressure=oil.vapour_pressure,
    )


def _seal(friction: Entries, oil: Oil) -> Seal:
    perimeter, viscosity = math.pi * friction["diameter"], oil.density * oil.viscosity
    law = friction["alpha"], friction["beta"], friction["limit"], friction["width"]
    return seal(*law, perimeter, friction["downward"], viscosity)


def _losses(losses: Entries, pipes: Sequence[Entries], density: float) -> Losses:
    if losses["kind"] == "none":
        return NoLosses()
    zetas = [losses[name] for name in PIPES]
    return MinorLosses(
        *(0.5 * loss_per_flow_squared(z, pipe["diameter"], density) for z, pipe in zip(zetas, pipes, strict=True))
    )


def _amplifiers(amplifier: Entries, step: float) -> Amplifiers | Direct:
    if amplifier["kind"] == "none":
        return Direct()
    return Amplifiers(lag(amplifier["position"], step), lag(amplifier["pressure"], step))


def _load(load: Entries) -> Load:
    stiffness = buffer_stiffness(load["added"], load["contact_time"])
    return Load(load["mass"], load["gravity"], load["force"], load["added"], load["added_at"], stiffness)


@lru_cache(REMEMBERED)
def _lines(specs: tuple[LineSpec, ...], step: float, vapour_pressure: float) -> Bank:
    return bank_of(specs, step, vapour_pressure)


def _line(pipe: Entries, oil: Oil) -> LineSpec:
    modulus = effective_modulus(oil.bulk_modulus, pipe["diameter"], pipe["wall"], pipe["young"])
    return LineSpec(
        pipe["length"], pipe["diameter"], modulus, oil.density, oil.viscosity, pipe["model"], pipe["friction"]
    )
