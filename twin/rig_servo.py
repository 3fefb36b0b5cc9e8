"""The rig's numbers of a servo valve; the thesis's rig has none."""

from twin.quantity import TINY, Choice, Entry, Number, Table

LANDS = ("p_a", "b_t", "p_b", "a_t")
OVERLAP = Number(0.0, "", "data sheet: lap, share of the travel; negative: underlap, open at null", -0.9, 0.9)
RATIO = Number(1.0, "", "data sheet: area of the land over that of the rated flow, 0.5 for a spool 2:1", TINY)

SERVO_VALVE: dict[str, Entry] = {
    "rated_flow": Number(38e-3 / 60.0, "m^3/s", "assumed, as of a two-stage servo valve for 38 l/min", TINY),
    "rated_drop": Number(70e5, "Pa", "ISO 10770-1: over both lands, no load", TINY),
    **{f"overlap_{land}": OVERLAP for land in LANDS},
    **{f"ratio_{land}": RATIO for land in LANDS},
    "opening": Choice("linear", ("linear", "table"), "assumed; table: share of the area over the travel"),
    "table": Table(((0.0, 0.0), (1.0, 1.0)), ("", ""), "assumed; from the edge to the end of the travel"),
    "null_bias": Number(0.0, "", "data sheet: null shift; position of the spool where the lands are alike", -0.5, 0.5),
    "dynamics": Choice("second-order", ("second-order", "first-order"), "data sheet: frequency response"),
    "natural_frequency": Number(100.0, "Hz", "assumed; data sheet: where the phase is -90 deg", TINY),
    "damping": Number(0.9, "", "assumed; 1 over twice the amplitude where the phase is -90 deg"),
    "time_constant": Number(2e-3, "s", "assumed, of first order", TINY),
    "delay": Number(0.0, "s", "assumed, before the spool moves"),
    "rate": Number(200.0, "1/s", "assumed: 5 ms for the travel, data sheet: step response", TINY),
    "hysteresis": Number(0.0, "", "data sheet, usually below 3 %; width of the loop, share of the command", 0.0, 0.5),
    "threshold": Number(0.0, "", "data sheet, usually below 0.5 %; a command that turns round", 0.0, 0.5),
    "hysteresis_share": Number(0.2, "", "assumed: of the command that runs through the wide play", 0.01, 1.0),
    "leakage": Number(0.6e-3 / 60.0, "m^3/s", "assumed, P to T at null if no land had a lap; 0 for none"),
    "leakage_pressure": Number(140e5, "Pa", "assumed, where the leakage was found", TINY),
    "leakage_viscosity": Number(32e-6, "m^2/s", "ISO 10770-1: oil of the data sheet, where it was found", TINY),
    "clearance": Number(3e-6, "m", "assumed, radial: how fast the leak of a land falls with its overlap", TINY),
    "travel": Number(0.5e-3, "m", "assumed, of the spool to either side", TINY),
    "flow_force": Number(
        0.0, "", "assumed: share of the command that it takes at rated drop, fully open; 0: none", 0.0, 1.0
    ),
    "discharge": Number(0.61, "", "2.4, sharp edge", TINY),
    "transition": Number(9.33, "", "2.4, transition Reynolds number; 0: purely turbulent"),
    "power_off": Number(0.0, "", "data sheet: where the spool goes without power", -1.0, 1.0),
}
SERVO_BUILT = {  # numbers that stay while the rig runs: why
    "servo_valve.power_off": "the safe state is planned with it",
    **dict.fromkeys(
        (f"servo_valve.{name}" for name in ("hysteresis", "threshold", "hysteresis_share")),
        "the plays keep what the command has done",
    ),
    "servo_valve.delay": "commands are under way",
}
