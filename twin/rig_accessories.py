"""The rig's numbers of what may sit between the cylinder's lines and its chambers; the thesis's rig has none of it."""

from twin.quantity import TINY, Choice, Entry, Number

KINDS = ("none", "counterbalance", "pilot-check", "throttle", "throttle-check")
HOLDS = "counterbalance, pilot-check"  # the kinds that have a body


def accessory(port: str) -> dict[str, Entry]:
    """What sits in one port of the cylinder; the kinds read those numbers that are theirs."""
    return {
        "kind": Choice("none", KINDS, f"assumed: the thesis has none at {port}"),
        "setting": Number(
            100e5, "Pa", "assumed; counterbalance: cracks it alone; 1.3 times the load's pressure is usual", TINY
        ),
        "pilot_ratio": Number(3.0, "", "assumed; data sheets of counterbalance valves have 1.5 to 10", 0.0, 100.0),
        "vented": Choice("no", ("no", "yes"), "counterbalance: its spring chamber; no: back pressure counts"),
        "pilot_lag": Number(0.0, "s", f"assumed; {HOLDS}: time constant of the pilot's damping orifice; 0 for none"),
        "flow": Number(60e-3 / 60.0, "m^3/s", "assumed, rated, fully open", TINY),
        "drop": Number(10e5, "Pa", f"assumed; {HOLDS}: at the rated flow, fully open", TINY),
        "cracking": Number(0.5e5, "Pa", "assumed, of the check valve"),
        "check_drop": Number(
            4e5, "Pa", "assumed; counterbalance, throttle-check: at the rated flow, beyond cracking", TINY
        ),
        "seat_diameter": Number(8e-3, "m", f"assumed; {HOLDS}: the face of the chamber's pressure", TINY),
        "travel": Number(1e-3, "m", f"assumed; {HOLDS}", TINY),
        "stiffness": Number(40e3, "N/m", f"assumed; {HOLDS}: opens fully 8 bar above cracking", TINY),
        "dynamics": Choice("mass", ("mass", "lag"), f"{HOLDS}; lag: of first order, by its time constant"),
        "mass": Number(50e-3, "kg", f"assumed; {HOLDS}: what moves", TINY),
        "damping": Number(600.0, "N s/m", f"assumed; {HOLDS}: 6.7 of critical, by which most lines keep calm"),
        "restitution": Number(0.2, "", f"assumed; {HOLDS}: at both stops", 0.0, 1.0),
        "rest_speed": Number(1e-4, "m/s", f"assumed; {HOLDS}: slower impacts are dead"),
        "time_constant": Number(5e-3, "s", f"assumed; {HOLDS}, dynamics lag"),
        "diameter": Number(2e-3, "m", "assumed; throttle, throttle-check", TINY),
        "meters": Choice("out", ("out", "in"), "throttle-check: what its throttle meters"),
        "discharge": Number(0.61, "", "2.4, sharp edge", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number"),
    }


def cushion() -> dict[str, Entry]:
    """Cushioned ends of the cylinder."""
    return {
        "kind": Choice("none", ("none", "orifice", "spear"), "assumed: the thesis names no cushions"),
        "lower_length": Number(15e-3, "m", "assumed; 0 for none at this end"),
        "upper_length": Number(15e-3, "m", "assumed; 0 for none at this end"),
        "lower_orifice": Number(1.5e-3, "m", "assumed, diameter of the cushioning screw's edge", TINY),
        "upper_orifice": Number(1.5e-3, "m", "assumed, diameter of the cushioning screw's edge", TINY),
        "lower_spear": Number(36e-3, "m", "assumed, diameter", TINY),
        "upper_spear": Number(20e-3, "m", "assumed, diameter", TINY),
        "lower_clearance": Number(0.1e-3, "m", "assumed, radial", TINY),
        "upper_clearance": Number(0.1e-3, "m", "assumed, radial", TINY),
        "discharge": Number(0.61, "", "2.4, sharp edge; of the orifice and of the spear's entry", TINY),
        "transition": Number(9.33, "", "2.4, transition Reynolds number"),
    }


ACCESSORIES: dict[str, dict[str, Entry]] = {
    "accessory_a": accessory("A"),
    "accessory_b": accessory("B"),
    "cushion": cushion(),
}
ACCESSORIES_BUILT = (  # what cannot change while the rig runs
    *(f"accessory_{port}.{name}" for port in "ab" for name in ("seat_diameter", "travel")),
    *(f"cushion.{end}_{name}" for end in ("lower", "upper") for name in ("length", "spear", "clearance")),
)
