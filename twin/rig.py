"""The rig: every number and every choice of it, once, with its unit and source.

Sources: "Table 2.1" and the like are those of the thesis; "data sheet" the makers'; "assumed" is ours.
Units are SI; `unit` says which, so that a scenario may write bar, mm or l/min and be checked. `build` makes a circuit
of them.
"""

import math
from collections.abc import Mapping
from typing import Any

from twin.quantity import TINY, Choice, Entry, Number
from twin.rig_accessories import ACCESSORIES, ACCESSORIES_BUILT
from twin.rig_mechanics import AXIS, BARREL, LOADS, MECHANICS, MECHANICS_BUILT, STEEL
from twin.rig_servo import SERVO_BUILT, SERVO_VALVE

Values = Mapping[str, Mapping[str, Any]]  # part -> name -> number or word

RUBBER = Number(1.09e9, "Pa", "2.2.3, HIDOL hose", TINY)
FITTED = "fitted to the facts of 2.3 and 2.6, docs/calibration.md"
MODELS = ("ends", "nodes", "lumped", "volume", "none")
FRICTIONS = ("unsteady", "quasi-steady", "steady", "none")


def _pipe(length: float, hose: bool) -> dict[str, Entry]:
    return {
        "length": Number(length, "m", f"the figure is lost; {FITTED}", TINY),
        "diameter": Number(11e-3, "m", "2.2.1, inner", TINY),
        "wall": Number(3e-3 if hose else 2e-3, "m", FITTED if hose else "2.2.1, outer 15 mm", TINY),
        "young": RUBBER if hose else STEEL,
        "model": Choice(
            "ends",
            MODELS,
            "ends: waves, end to end; nodes: pressure and cavities inside; lumped: no waves; volume: no inertia and "
            "friction either; none: no pipe, a manifold",
        ),
        "friction": Choice("unsteady", FRICTIONS, "2.5.2; in turbulent flow quasi-steady"),
        "creep": Number(0.0, "", "assumed: elastic wall; strain that follows over that at once"),
        "retardation": Number(20e-3, "s", "assumed: time in which it follows", TINY),
        "creep_2": Number(0.0, "", "assumed: elastic wall; of a second Kelvin-Voigt element"),
        "retardation_2": Number(0.5, "s", "assumed: of a second Kelvin-Voigt element", TINY),
        "manifold": Number(20e-6, "m^3", "assumed: oil between both ends where model is none", TINY),
    }


RIG: dict[str, dict[str, Entry]] = {
    "oil": {
        "kind": Choice(
            "thesis",
            ("thesis", "numbers", "iso-vg"),
            "thesis: density, temperature, wave_speed; numbers: density, viscosity, bulk_modulus; iso-vg: grade, "
            "temperature, bulk_modulus",
        ),
        "density": Number(878.0, "kg/m^3", "2.4; 876.56 measured in 2.2.3", TINY),
        "temperature": Number(40.07, "degC", "where the valve's table has nu = 40 mm^2/s, by (2.6)", -20.0, 80.0),
        "wave_speed": Number(
            1137.0,
            "m/s",
            "2.2.3, measured in steel: 1.135e9 Pa; 1329 m/s makes chapter 4's 1.55e9, 1132 m/s chapter 5's 1.125e9",
            TINY,
        ),
        "bulk_modulus": Number(1.6e9, "Pa", "assumed: mineral oil at 40 degC, without air", TINY),
        "viscosity": Number(46e-6, "m^2/s", "assumed: VG 46 at 40 degC", TINY),
        "grade": Choice("46", ("22", "32", "46", "68", "100"), "ISO 3448, viscosity index 100"),
        "air": Number(0.0, "", "assumed: none; entrained, share of the volume at atmospheric pressure", 0.0, 0.5),
        "air_exponent": Number(1.4, "", "assumed: adiabatic bubbles; 1: isothermal", 1.0, 1.4),
        "air_pressure": Number(50e5, "Pa", "assumed: where lines take their modulus of oil with air"),
        "cavitation": Choice("vapour", ("vapour", "none"), "vapour: discrete cavities; none: oil bears any tension"),
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
        "efficiency_pressure": Number(40e5, "Pa", f"where it was found; {FITTED}", TINY),
        "run_up": Number(0.0, "s", "assumed: time from standstill to full speed at the start; 0: it runs already"),
        "ripple": Choice("teeth", ("teeth", "none"), "(2.104); none: the mean flow"),
    },
    "supply": {
        "kind": Choice(
            "gear",
            ("gear", "fixed", "variable", "pressure"),
            "2.6: pump; fixed: fixed_pump; variable: variable_pump, pressure-compensated; pressure: pressure_source",
        ),
    },
    "fixed_pump": {
        "displacement": Number(20e-6, "m^3", "assumed, per revolution", TINY),
        "speed": Number(25.0, "1/s", "assumed"),
        "leakage": Number(1e-12, "m^3/(s Pa)", "assumed, to the tank, in proportion to pressure"),
        "run_up": Number(0.0, "s", "assumed: time from standstill to full speed at the start; 0: it runs already"),
    },
    "variable_pump": {
        "displacement": Number(28e-6, "m^3", "assumed, the greatest, per revolution", TINY),
        "least_displacement": Number(0.0, "m^3", "assumed, the least, per revolution"),
        "speed": Number(25.0, "1/s", "assumed"),
        "leakage": Number(3e-12, "m^3/(s Pa)", "assumed, to the tank, in proportion to pressure"),
        "cut_off": Number(200e5, "Pa", "assumed: pressure from which the swash plate swings back", TINY),
        "droop": Number(4e5, "Pa", "assumed: rise of pressure from there to the least displacement", 1.0),
        "time_constant": Number(20e-3, "s", "assumed, of swash plate and compensator, first order"),
        "run_up": Number(0.0, "s", "assumed: time from standstill to full speed at the start; 0: it runs already"),
    },
    "pressure_source": {
        "pressure": Number(210e5, "Pa", "assumed, at no flow", TINY),
        "resistance": Number(6e8, "Pa s/m^3", "assumed, internal: 0.1 bar per l/min", 1e6),
        "run_up": Number(0.0, "s", "assumed: time from no pressure to all of it at the start; 0: it is there"),
    },
    "accumulator": {
        "kind": Choice("none", ("none", "bladder"), "2.2.1 has none; bladder: gas behind oil"),
        "at": Choice("tee", ("tee", "p"), "assumed: at the tee of the relief valve, or at port P"),
        "volume": Number(2.5e-3, "m^3", "assumed, of the gas, bladder expanded", TINY),
        "precharge": Number(90e5, "Pa", "assumed, of the gas then", 0.0),
        "exponent": Number(1.4, "", "polytropic: 1 for slow changes, about 1.4 for fast ones of nitrogen", 1.0, 3.0),
        "inlet_diameter": Number(8e-3, "m", "assumed, orifice between bladder and line", TINY),
        "inlet_discharge": Number(0.7, "", "assumed", TINY),
        "inlet_transition": Number(9.33, "", "2.4, transition Reynolds number"),
    },
    "relief": {
        "kind": Choice(
            "two-stage", ("two-stage", "direct", "none"), "2.4; direct: direct_relief; none: the tee has no valve"
        ),
        "place": Choice("tee", ("tee", "pipe_7"), "2.2.1; pipe_7: at the end of a line of its own"),
        "setting": Number(67e5, "Pa", "2.6; the pilot spring is precompressed for it", TINY),
        "setting_flow": Number(26.7e-3 / 60.0, "m^3/s", "2.6, the flow it was set at: all of the pump's", TINY),
        "orifice_diameter": Number(0.6e-3, "m", "2.4, orifices 1 and 3", TINY),
        "orifice_discharge": Number(0.61, "", "2.4, orifices 1 and 3", TINY),
        "orifice_transition": Number(9.33, "", "2.4, orifices 1 and 3: Reynolds number", 0.1),
        "nozzle_diameter": Number(0.65e-3, "m", f"orifice 2; {FITTED}: the axis of Fig. 2.18", TINY),
        "nozzle_discharge": Number(0.86, "", "2.4, orifice 2", TINY),
        "nozzle_transition": Number(30.0, "", "2.4, orifice 2: Reynolds number", 0.1),
        "seat_diameter": Number(5.6e-3, "m", "Table 2.4, pilot; its 2.8 mm is a radius", TINY),
        "cone_angle": Number(math.radians(21.0), "rad", "Table 2.4, pilot, half the angle of the cone", TINY, 1.57),
        "loss_factor": Number(0.369, "", "(2.26), pilot seat", TINY),
        "loss_exponent": Number(2.3, "", "(2.26), pilot seat", 1.0, 4.0),
        "pilot_mass": Number(10.6e-3, "kg", "Table 2.4, with a third of the spring", TINY),
        "pilot_stiffness": Number(811e3, "N/m", "Table 2.4", TINY),
        "pilot_travel": Number(6e-3, "m", "Table 2.4", TINY),
        "pilot_restitution": Number(0.2, "", "assumed; chapter 4 takes 0.8 for this poppet", 0.0, 1.0),
        "pilot_spring_diameter": Number(13e-3, "m", "Table 2.4, outer; printed drag takes it as the mean", TINY),
        "pilot_spring_turns": Number(10.0, "", "Table 2.4", TINY),
        "spool_mass": Number(65.3e-3, "kg", "Table 2.3", TINY),
        "spool_diameter": Number(26e-3, "m", "named choice: 2.4.2 has A = 5.31e-4 m^2; Table 2.3 prints 22 mm", TINY),
        "spool_angle": Number(math.radians(45.0), "rad", "Table 2.3", TINY, 1.57),
        "spool_length": Number(40e-3, "m", "Table 2.3", TINY),
        "spool_gap": Number(0.1e-3, "m", "Table 2.3", TINY),
        "spool_stiffness": Number(27.3e3, "N/m", "Table 2.3", TINY),
        "spool_precompression": Number(5e-3, "m", "assumed: 2.57 bar"),
        "spool_travel": Number(4e-3, "m", "Table 2.3", TINY),
        "spool_restitution": Number(0.2, "", "assumed", 0.0, 1.0),
        "spool_discharge": Number(0.61, "", "named choice: stated in 2.4; all numbers of the thesis use 0.8", TINY),
        "damping_length": Number(10e-3, "m", "named choice: the printed 32.74 N s/m needs 10 mm; 20 mm is stated"),
        "rest_speed": Number(1e-4, "m/s", "assumed, slower impacts of both stages are dead"),
        "pilot_seat": Choice("chamfered", ("chamfered", "conical"), "2.4; conical: the long one of chapter 3"),
        "seat_length": Number(3.21e-3, "m", "Figure 3.1, of the conical seat, along the gap", TINY),
        "film_floor": Number(5e-6, "m", "assumed: lift below which its squeeze film grows no stiffer", TINY),
        "channel_volume": Number(0.0, "m^3", "oil before the pilot seat; 0: incompressible, as in the thesis"),
    },
    "direct_relief": {
        "cracking_pressure": Number(100e5, "Pa", "assumed, at rising pressure", TINY),
        "rated_flow": Number(30e-3 / 60.0, "m^3/s", "assumed, where the override is stated", TINY),
        "override": Number(8e5, "Pa", "assumed: rise of pressure from cracking to the rated flow", 1.0),
        "flow_force_share": Number(0.6, "", "assumed, of the override; the rest is the spring", 0.0, 1.0),
        "hysteresis": Number(0.0, "Pa", "assumed: how much lower it shuts than it cracks"),
        "time_constant": Number(5e-3, "s", "assumed, of the opening, first order"),
    },
    "chatter": {
        "volume": Number(2.356e-4, "m^3", "4.2.1, before the pilot: 3 m of a pipe of 10 mm", TINY),
        "modulus": Number(1.55e9, "Pa", "4.2.1, reduced; 1.135e9 measured in 2.2.3", TINY),
        "discharge": Number(0.8, "", "named choice: the printed 9.14 l/min of (4.8) needs 0.8; 0.61 is stated", TINY),
        "reference_lift": Number(0.23e-3, "m", "(4.6); the unit of lifts in chapter 4", TINY),
        "restitution": Number(0.8, "", "chapter 4, poppet on its seat", 0.0, 1.0),
        "housing_mass": Number(8.0, "kg", "assumed, of the relief valve: what its accelerometer sat on", TINY),
        "line_diameter": Number(10e-3, "m", "assumed, of an inlet line: 4.2.1's volume is 3 m of it", TINY),
    },
    "filter": {
        "drop": Number(0.5e5, "Pa", "assumed, at its flow, in proportion to it"),
        "flow": Number(30e-3 / 60.0, "m^3/s", "assumed", TINY),
    },
    "two_position_valve": {
        "drop": Number(0.5e5, "Pa", "assumed, at its flow, as its square"),
        "flow": Number(30e-3 / 60.0, "m^3/s", "assumed", TINY),
    },
    "check_valve": {
        "kind": Choice("none", ("none", "fitted"), "2.2.1 has none; fitted: in line 2, behind the filter"),
        "cracking_pressure": Number(0.5e5, "Pa", "assumed"),
        "drop": Number(1e5, "Pa", "assumed, beyond cracking, at its flow, as its square"),
        "flow": Number(30e-3 / 60.0, "m^3/s", "assumed", TINY),
    },
    "return_end": {
        "kind": Choice(
            "open",
            ("open", "orifice", "check"),
            "of line 6, at the tank; check: a back-pressure check valve with the orifice in series",
        ),
        "diameter": Number(12e-3, "m", "assumed, of the orifice", TINY),
        "discharge": Number(0.67, "", "assumed", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number; 0: turbulent at any flow"),
        "cracking_pressure": Number(3e5, "Pa", "assumed, of the check valve"),
    },
    "valve": {
        "kind": Choice("proportional", ("proportional", "switching", "servo"), "2.2.1: 4WRAE 10 E 30 or 4WE 10 G"),
        "rated_flow": Number(30e-3 / 60.0, "m^3/s", "data sheet, 4WRAE 10 E 30", TINY),
        "rated_drop": Number(10e5, "Pa", "data sheet, over both lands", TINY),
        "overlap": Number(0.1, "", "assumed, E spool, share of the travel", 0.0, 0.9),
        "natural_frequency": Number(30.0, "Hz", "assumed", TINY),
        "damping": Number(0.8, "", "assumed"),
        "rate": Number(50.0, "1/s", "assumed, 20 ms for the travel", TINY),
        "discharge": Number(0.61, "", "2.4, sharp edge", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number"),
        "full_scale": Number(10.0, "V", "data sheet; the thesis prints mV", TINY),
    },
    "switching_valve": {
        "rated_flow": Number(60e-3 / 60.0, "m^3/s", "assumed, 4WE 10 G", TINY),
        "rated_drop": Number(5e5, "Pa", f"over one land; {FITTED}", TINY),
        "switching_time": Number(50e-3, "s", f"{FITTED}; the thesis takes it as zero and finds that wrong", TINY),
        "return_time": Number(20e-3, "s", f"by the springs; {FITTED}", TINY),
        "cylinder_opens": Number(0.34, "", f"share of the travel; {FITTED}", 0.0, 0.9),
        "idle_shuts": Number(0.54, "", f"share of the travel; {FITTED}", 0.1, 1.0),
        "discharge": Number(0.61, "", "2.4, sharp edge", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number"),
    },
    "servo_valve": SERVO_VALVE,
    "cylinder": {
        "bore": Number(50e-3, "m", "Table 2.1", TINY),
        "rod": Number(32e-3, "m", "Table 2.1", TINY),
        "stroke": Number(270e-3, "m", "Table 2.1; of a motor the range of its arc, without stops", TINY),
        "dead_upper": Number(19.6e-6, "m^3", "Table 2.1, estimated", TINY),
        "dead_lower": Number(11.6e-6, "m^3", "Table 2.1, estimated", TINY),
        "leakage_resistance": Number(
            1.04e13, "Pa s/m^3", f"Table 2.1, its garbled exponent {FITTED}; inf for none", TINY
        ),
        "counting": Choice(
            "mass", ("mass", "volume"), "oil of the chambers; volume: (2.11), (2.12) as printed, and most simulators"
        ),
        "restitution": Number(0.2, "", "assumed, end stops", 0.0, 1.0),
        "rest_speed": Number(1e-3, "m/s", "assumed, slower impacts are dead"),
        **BARREL,
        "angle": AXIS,
    },
    **MECHANICS,
    "seal": {
        "alpha": Number(3.819e-6, "", "(2.13)", TINY),
        "beta": Number(-0.5373, "", "(2.13)", -0.99, -1e-6),
        "limit": Number(0.25, "", "(2.13), g_max; 0 for no friction"),
        "width": Number(10e-3, "m", "Table 2.1, estimated", TINY),
        "diameter": Number(40.5e-3, "m", f"effective; {FITTED}; a seal each on bore and rod is 82 mm", TINY),
        "downward": Number(0.7, "", f"friction down over up; {FITTED}; 1 for none", TINY),
    },
    "load": {
        "mass": Number(120.0, "kg", "2.6, piston included", TINY),
        "gravity": Number(9.81, "m/s^2", "2.6"),
        "force": Number(0.0, "N", "assumed, on the load, upwards", -math.inf),
        "added": Number(0.0, "kg", "2.6: 183 kg in the load-change test; 0 for none"),
        "added_at": Number(138e-3, "m", "2.6, position of the piston where it meets the weight"),
        "contact_time": Number(3e-3, "s", "2.6, by trial and error: half-period of the weight on its buffer", TINY),
        **LOADS,
    },
    "minor_losses": {
        "kind": Choice("fitted", ("fitted", "none"), "2.7: elbows, tees and mouths, at both ends of each line"),
        "pipe_1": Number(3.0, "", "assumed, zeta: two elbows of 1.2 (Idelchik, sharp), run of a tee 0.6"),
        "pipe_2": Number(3.7, "", "assumed, zeta: branch of a tee 1.3, two elbows of 1.2"),
        "pipe_3": Number(2.4, "", "assumed, zeta: two elbows of 1.2"),
        "pipe_4": Number(2.4, "", "assumed, zeta: two elbows of 1.2"),
        "pipe_5": Number(3.0, "", "assumed, zeta: two elbows of 1.2, run of a tee 0.6"),
        "pipe_6": Number(2.2, "", "assumed, zeta: an elbow of 1.2, mouth into the tank 1.0"),
    },
    "amplifier": {
        "kind": Choice("lag", ("lag", "none"), "2.2.2: HB MGC between transducers and card; first order, assumed"),
        "position": Number(1600.0, "Hz", "assumed: a third of the usual carrier of 4.8 kHz; -3 dB", TINY),
        "pressure": Number(1600.0, "Hz", "assumed: a third of the usual carrier of 4.8 kHz; -3 dB", TINY),
    },
    **ACCESSORIES,
    "pipe_1": _pipe(1.35, hose=False),
    "pipe_2": _pipe(2.05, hose=False),
    "pipe_3": _pipe(2.05, hose=True),
    "pipe_4": _pipe(2.1, hose=True),
    "pipe_5": _pipe(2.05, hose=False),
    "pipe_6": _pipe(1.4, hose=True),
    "pipe_7": _pipe(1.0, hose=False),
}

BUILT_PIPE = ("length", "diameter", "wall", "young", "creep", "retardation", "creep_2", "retardation_2", "manifold")
PIPES_BUILT = [f"pipe_{i}.{name}" for i in range(1, 8) for name in BUILT_PIPE]
STARTING = ("pump", "fixed_pump", "variable_pump", "pressure_source")
BUILT_IN = {  # numbers that stay while the rig runs: why
    **dict.fromkeys(("oil.density", "oil.vapour_pressure"), "the oil in the circuit is counted by it"),
    **dict.fromkeys(("load.added", "load.added_at", "load.contact_time"), "change load.mass or load.force instead"),
    **dict.fromkeys(("cylinder.bore", "cylinder.rod", "cylinder.stroke"), "it is the rig's geometry"),
    **dict.fromkeys(("cylinder.dead_upper", "cylinder.dead_lower"), "it is the rig's geometry"),
    **dict.fromkeys(PIPES_BUILT, "it is the rig's geometry"),
    **dict.fromkeys(("oil.air", "oil.air_exponent", "oil.air_pressure"), "the oil in the circuit is counted by it"),
    "valve.full_scale": "the volts of the controller's gains are counted by it",
    **SERVO_BUILT,
    **dict.fromkeys(("pump.width", "pump.module", "pump.teeth", "pump.pressure_angle"), "it is the rig's geometry"),
    **dict.fromkeys((f"{name}.run_up" for name in STARTING), "it says how the run starts"),
    **dict.fromkeys(
        ("fixed_pump.displacement", "variable_pump.displacement", "variable_pump.least_displacement"),
        "it is the rig's geometry",
    ),
    **dict.fromkeys(("accumulator.volume", "accumulator.exponent"), "the gas in it is counted by it"),
    "relief.channel_volume": "it is the rig's geometry",
    **dict.fromkeys(ACCESSORIES_BUILT, "it is the valve's or the cylinder's geometry"),
    **MECHANICS_BUILT,
    **{f"chatter.{name}": "only the valve's theory reads it" for name in RIG["chatter"]},
}


def rig_number(part: str, name: str) -> float:
    """A number of the rig, SI. Raises TypeError for a word or a table."""
    entry = RIG[part][name]
    if not isinstance(entry, Number):
        raise TypeError(f"{part}.{name} is not a number: {entry.value!r}")
    return entry.value


def rig_words(part: str, name: str) -> tuple[str, ...]:
    """The words that a choice of the rig may take. Raises TypeError for a number or a table."""
    entry = RIG[part][name]
    if not isinstance(entry, Choice):
        raise TypeError(f"{part}.{name} is not a choice of words: {entry.value!r}")
    return entry.options


def values(overrides: Values | None = None) -> dict[str, dict[str, Any]]:
    """The rig's numbers and words, with a scenario's own in place of some."""
    overrides = overrides or {}
    return {
        part: {name: overrides.get(part, {}).get(name, entry.value) for name, entry in entries.items()}
        for part, entries in RIG.items()
    }
