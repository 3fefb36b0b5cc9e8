"""The rig: every number of it, once, with its unit and source, and the circuit they make.

Sources: "Table 2.1" and the like are those of the thesis; "data sheet" the makers'; "assumed" is ours.
Units are SI; `unit` says which, so that a scenario may write bar, mm or l/min and be checked.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

from twin.circuit import Circuit
from twin.contact import Stops
from twin.cylinder import Cylinder, Load, chamber_volumes
from twin.lines.lumped import LumpedLine, lumped_line
from twin.oil import Oil, effective_modulus, fluid_modulus, kinematic_viscosity
from twin.orifice import Orifice, area_for
from twin.pump import Pump, displacement
from twin.relief import Relief, relief
from twin.seal import Seal, least_mass, seal
from twin.spool_valve import SpoolValve, step_matrix


class Number(NamedTuple):
    """One number of the rig."""

    value: float
    unit: str  # SI, "" for a pure number
    source: str
    low: float = 0.0  # smallest allowed value
    high: float = math.inf  # largest allowed value


Numbers = Mapping[str, Mapping[str, float]]

TINY = 1e-12  # smallest value of what must not be zero
STEEL = Number(2.1e11, "Pa", "steel; the source used 2.1e10, ten times too small", TINY)
RUBBER = Number(1.09e9, "Pa", "2.2.3, HIDOL hose", TINY)


def _pipe(length: float, hose: bool) -> dict[str, Number]:
    return {
        "length": Number(length, "m", "assumed, the figure is lost", TINY),
        "diameter": Number(11e-3, "m", "2.2.1, inner", TINY),
        "wall": Number(5e-3 if hose else 2e-3, "m", "assumed" if hose else "2.2.1, outer 15 mm", TINY),
        "young": RUBBER if hose else STEEL,
    }


RIG: dict[str, dict[str, Number]] = {
    "oil": {
        "density": Number(878.0, "kg/m^3", "2.4; 876.56 measured in 2.2.3", TINY),
        "temperature": Number(40.07, "degC", "where the valve's table has nu = 40 mm^2/s, by (2.6)", -20.0, 80.0),
        "wave_speed": Number(1137.0, "m/s", "2.2.3, measured in the steel pipe", TINY),
        "vapour_pressure": Number(-1e5, "Pa", "assumed: perfect vacuum, gauge", -math.inf, 0.0),
    },
    "pump": {
        "width": Number(63e-3, "m", "2.6, measured", TINY),
        "module": Number(2.6e-3, "m", "2.6, estimated", TINY),
        "teeth": Number(9.0, "", "2.6", 1.0),
        "pressure_angle": Number(math.radians(20.0), "rad", "2.6, estimated"),
        "speed": Number(1230.0 / 60.0, "1/s", "2.6, the fastest test"),
        "efficiency": Number(0.875, "", "2.6, volumetric, at 1230 rpm", 0.0, 1.0),
        "efficiency_speed": Number(1230.0 / 60.0, "1/s", "2.6, where it was found"),
        "efficiency_pressure": Number(35e5, "Pa", "assumed, where it was found", TINY),
    },
    "relief": {
        "setting": Number(67e5, "Pa", "2.6", TINY),
        "setting_flow": Number(26.7e-3 / 60.0, "m^3/s", "2.6, the flow it was set at: all of the pump's"),
        "override": Number(2.5e5 / (100e-3 / 60.0), "Pa s/m^3", "steady two-stage valve, 1 to 100 l/min", TINY),
        "pilot_band": Number(6.1e5, "Pa", "steady two-stage valve, cracking to knee", TINY),
        "pilot_flow": Number(0.225e-3 / 60.0, "m^3/s", "steady two-stage valve, at the knee", TINY),
    },
    "filter": {
        "drop": Number(0.5e5, "Pa", "assumed, at its flow"),
        "flow": Number(30e-3 / 60.0, "m^3/s", "assumed", TINY),
    },
    "valve": {
        "rated_flow": Number(30e-3 / 60.0, "m^3/s", "data sheet, 4WRAE 10 E 30", TINY),
        "rated_drop": Number(10e5, "Pa", "data sheet, over both lands", TINY),
        "overlap": Number(0.1, "", "assumed, E spool, share of the travel", 0.0, 0.9),
        "natural_frequency": Number(30.0, "Hz", "assumed", TINY),
        "damping": Number(0.8, "", "assumed"),
        "rate": Number(50.0, "1/s", "assumed, 20 ms for the travel", TINY),
        "discharge": Number(0.61, "", "2.4, sharp edge", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number"),
        "full_scale": Number(10.0, "V", "data sheet; the source prints mV", TINY),
    },
    "cylinder": {
        "bore": Number(50e-3, "m", "Table 2.1", TINY),
        "rod": Number(32e-3, "m", "Table 2.1", TINY),
        "stroke": Number(270e-3, "m", "Table 2.1", TINY),
        "dead_upper": Number(19.6e-6, "m^3", "Table 2.1, estimated", TINY),
        "dead_lower": Number(11.6e-6, "m^3", "Table 2.1, estimated", TINY),
        "leakage_resistance": Number(1.04e12, "Pa s/m^3", "Table 2.1, exponent from a garbled row; inf for none", TINY),
        "restitution": Number(0.2, "", "assumed, end stops", 0.0, 1.0),
        "rest_speed": Number(1e-3, "m/s", "assumed, slower impacts are dead"),
    },
    "seal": {
        "alpha": Number(3.819e-6, "", "(2.13)", TINY),
        "beta": Number(-0.5373, "", "(2.13)", -0.99, -1e-6),
        "limit": Number(0.25, "", "(2.13), g_max; 0 for no friction"),
        "width": Number(10e-3, "m", "Table 2.1, estimated", TINY),
        "diameter": Number(82e-3, "m", "named choice: bore + rod, a seal each; 50 mm if the source meant one", TINY),
    },
    "load": {
        "mass": Number(120.0, "kg", "2.6, piston included", TINY),
        "gravity": Number(9.81, "m/s^2", "2.6"),
        "force": Number(0.0, "N", "assumed, on the piston, upwards", -math.inf),
    },
    "pipe_1": _pipe(1.0, hose=False),
    "pipe_2": _pipe(2.5, hose=False),
    "pipe_3": _pipe(2.0, hose=True),
    "pipe_4": _pipe(2.0, hose=True),
    "pipe_5": _pipe(2.0, hose=False),
    "pipe_6": _pipe(1.5, hose=True),
}


def numbers(overrides: Numbers | None = None) -> dict[str, dict[str, float]]:
    """The rig's numbers as plain floats, with a scenario's own in place of some."""
    overrides = overrides or {}
    return {
        part: {name: overrides.get(part, {}).get(name, number.value) for name, number in entries.items()}
        for part, entries in RIG.items()
    }


def build(rig: Numbers, step: float) -> Circuit:
    """The circuit of a rig at an internal step [s]. Raises ValueError where the step is too coarse for a part."""
    oil = _oil(rig)
    viscosity = oil.density * oil.viscosity
    friction = rig["seal"]
    circuit = Circuit(
        step=step,
        oil=oil,
        pump=_pump(rig["pump"]),
        relief=_relief(rig["relief"]),
        valve=_valve(rig["valve"], oil, step),
        cylinder=_cylinder(rig["cylinder"]),
        seal=seal(
            friction["alpha"],
            friction["beta"],
            friction["limit"],
            friction["width"],
            math.pi * friction["diameter"],
            viscosity,
        ),
        stops=Stops(rig["cylinder"]["stroke"], rig["cylinder"]["restitution"], rig["cylinder"]["rest_speed"]),
        load=Load(rig["load"]["mass"], rig["load"]["gravity"], rig["load"]["force"]),
        line_1=_line(rig, "pipe_1", oil, 0.0),
        line_2=_line(rig, "pipe_2", oil, rig["filter"]["drop"] / rig["filter"]["flow"]),
        line_3=_line(rig, "pipe_3", oil, 0.0),
        line_4=_line(rig, "pipe_4", oil, 0.0),
        line_5=_line(rig, "pipe_5", oil, 0.0),
        line_6=_line(rig, "pipe_6", oil, 0.0),
    )
    _refuse_coarse_step(circuit, circuit.seal)
    return circuit


def _refuse_coarse_step(circuit: Circuit, friction: Seal) -> None:
    for index in range(1, 7):
        line: LumpedLine = getattr(circuit, f"line_{index}")
        longest = 0.5 * math.sqrt(line.inertance * line.end_capacity)
        if circuit.step > longest:
            raise ValueError(
                f"internal step {circuit.step} s is too coarse for pipe_{index}: at most {longest:.3g} s; "
                "take a smaller loop.step or a longer pipe"
            )
    stiffest = max(_oil_spring(circuit, x) for x in (0.0, circuit.stops.stroke))
    if circuit.load.mass < (least := stiffest * circuit.step**2):
        raise ValueError(
            f"load.mass {circuit.load.mass} kg swings too fast on the oil for a step of {circuit.step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step"
        )
    if circuit.load.mass < (least := least_mass(friction, 0.5 * circuit.step)):
        raise ValueError(
            f"load.mass {circuit.load.mass} kg is too light for the seal's friction at a step of {circuit.step} s: "
            f"at least {least:.3g} kg; take a smaller loop.step or seal.limit = 0"
        )


def _oil_spring(circuit: Circuit, position: float) -> float:
    """Stiffness [N/m] of the oil shut in at both ends of the cylinder and the line ends that open into it."""
    cylinder, modulus = circuit.cylinder, circuit.oil.bulk_modulus
    v_lower, v_upper = chamber_volumes(position, cylinder)
    lower = circuit.line_3.end_capacity + v_lower / modulus
    upper = circuit.line_4.end_capacity + v_upper / modulus
    return cylinder.area_lower**2 / lower + cylinder.area_upper**2 / upper


def _oil(rig: Numbers) -> Oil:
    """The fluid's own modulus follows from the wave speed measured in the steel pipe, (2.8), (2.9)."""
    oil, pipe = rig["oil"], RIG["pipe_1"]
    measured = oil["density"] * oil["wave_speed"] ** 2
    modulus = fluid_modulus(measured, pipe["diameter"].value, pipe["wall"].value, pipe["young"].value)
    return Oil(oil["density"], kinematic_viscosity(oil["temperature"]), modulus, oil["vapour_pressure"])


def _pump(pump: Mapping[str, float]) -> Pump:
    volume = displacement(pump["width"], pump["module"], pump["teeth"], pump["pressure_angle"])
    lost = (1.0 - pump["efficiency"]) * volume * pump["efficiency_speed"]
    return Pump(volume * pump["speed"], lost / pump["efficiency_pressure"])


def _relief(valve: Mapping[str, float]) -> Relief:
    return relief(valve["setting"], valve["setting_flow"], valve["override"], valve["pilot_band"], valve["pilot_flow"])


def _valve(valve: Mapping[str, float], oil: Oil, step: float) -> SpoolValve:
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


def _cylinder(cylinder: Mapping[str, float]) -> Cylinder:
    bore, rod = cylinder["bore"], cylinder["rod"]
    if rod >= bore:
        raise ValueError(f"cylinder.rod {rod} m must be thinner than cylinder.bore {bore} m")
    return Cylinder(
        area_lower=math.pi / 4.0 * (bore**2 - rod**2),
        area_upper=math.pi / 4.0 * bore**2,
        dead_lower=cylinder["dead_lower"],
        dead_upper=cylinder["dead_upper"],
        stroke=cylinder["stroke"],
        leakage_resistance=cylinder["leakage_resistance"],
    )


def _line(rig: Numbers, name: str, oil: Oil, fitting: float) -> LumpedLine:
    pipe = rig[name]
    modulus = effective_modulus(oil.bulk_modulus, pipe["diameter"], pipe["wall"], pipe["young"])
    return lumped_line(pipe["length"], pipe["diameter"], modulus, oil.density, oil.viscosity, fitting)
