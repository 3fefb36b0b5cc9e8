"""Numbers of actuators, frictions and loads that the rig of the thesis does not have; its own are in `twin/rig.py`.

Positive is the direction in which the chamber of port A pushes: of the rig upwards.
"""

import math

from twin.quantity import TINY, Choice, Entry, Number, Table

STEEL = Number(2.1e11, "Pa", "steel; the thesis used 2.1e10, ten times too small", TINY)
AXIS = Number(0.5 * math.pi, "rad", "2.6: upright; of the positive direction to the horizontal", -1.58, 1.58)
TIGHT = "inf for none; assumed"
GEOMETRY = "it is the rig's geometry"

BARREL: dict[str, Entry] = {  # of the cylinder
    "rod_at": Choice("a", ("a", "b", "both"), "2.2.1: rod in the chamber of port A; both: two rods of one diameter"),
    "outside_lower": Number(math.inf, "Pa s/m^3", f"leak of the lower chamber to the outside; {TIGHT}", TINY),
    "outside_upper": Number(math.inf, "Pa s/m^3", f"leak of the upper chamber to the outside; {TIGHT}", TINY),
    "holes": Choice("none", ("none", "fitted"), "fitted: there may be holes to the outside, as a burst tears them"),
    "hole_lower": Number(0.0, "m", "assumed: diameter of a hole in the lower chamber, or at its end of the line"),
    "hole_upper": Number(0.0, "m", "assumed: diameter of a hole in the upper chamber, or at its end of the line"),
    "hole_discharge": Number(0.61, "", "2.4, sharp edge", TINY),
    "hole_transition": Number(9.33, "", "2.4, transition Reynolds number"),
    "stiffness": Number(
        1.0, "", "assumed: bulk modulus in the chambers over that of the oil; below 1, air is trapped there", TINY, 1.0
    ),
    "wall": Number(0.0, "m", "of the barrel, assumed rigid: 0; it widens as a thin pipe, (2.8)"),
    "young": STEEL,
}
MECHANICS: dict[str, dict[str, Entry]] = {
    "actuator": {"kind": Choice("cylinder", ("cylinder", "motor"), "2.2.1; motor: position is the arc at its radius")},
    "motor": {
        "displacement": Number(50e-6, "m^3", "assumed, per turn: a small orbital or axial piston motor", TINY),
        "inertia": Number(0.1, "kg m^2", "assumed, of shaft and all that turns with it, besides load.mass"),
        "radius": Number(1.0, "m", "assumed: where position, speed and force are counted; 1 m: rad, rad/s, N m", TINY),
        "dead_lower": Number(50e-6, "m^3", "assumed, oil between the line of port A and the shaft", TINY),
        "dead_upper": Number(50e-6, "m^3", "assumed, oil between the line of port B and the shaft", TINY),
        "leakage_resistance": Number(5e12, "Pa s/m^3", "assumed, from port to port; inf for none", TINY),
        "case_resistance": Number(1e13, "Pa s/m^3", "assumed, of each port into the case, drained; inf for none", TINY),
        "ripple": Number(0.0, "", "assumed, of displacement and torque, share of the mean", 0.0, 0.9),
        "waves": Number(9.0, "", "assumed, of the ripple per turn: pistons or teeth", 1.0),
        "angle": Number(0.0, "rad", "assumed; 90 deg: load.mass hangs on a rope at the radius, a winch", -1.58, 1.58),
    },
    "friction": {
        "kind": Choice(
            "seal", ("seal", "stribeck", "lugre", "none"), "2.3, section seal; stribeck: Coulomb, Stribeck, viscous"
        ),
        "coulomb": Number(300.0, "N", "assumed, sliding, at no pressure; stribeck, lugre", TINY),
        "static": Number(400.0, "N", "assumed, at rest, at no pressure; stribeck, lugre", TINY),
        "stribeck_speed": Number(0.01, "m/s", "assumed: how fast static falls to sliding friction; 0: at once"),
        "viscous": Number(1000.0, "N s/m", "assumed; stribeck, lugre"),
        "pressure_area": Number(0.0, "m^2", "assumed: growth of friction with the pressure difference of the chambers"),
        "negative": Number(1.0, "", "assumed: friction in the negative direction over that in the positive", TINY),
        "stiffness": Number(1e7, "N/m", "assumed, lugre: of the bristles, static friction at 40 um", TINY),
        "damping": Number(2e4, "N s/m", "assumed, lugre: of the bristles"),
    },
}
LOADS: dict[str, Entry] = {  # of the load
    "kind": Choice(
        "mass",
        ("mass", "environment", "compliant", "lever"),
        "2.6; others: in springs and dampers, on a link, by tables",
    ),
    "stiffness": Number(0.0, "N/m", "assumed, spring around the load; all kinds but mass"),
    "neutral": Number(0.0, "m", "assumed, position at which this spring is slack", -math.inf),
    "viscous": Number(0.0, "N s/m", "assumed, damper around the load; all kinds but mass"),
    "quadratic": Number(0.0, "N s^2/m^2", "assumed, damper of the square of the speed; all kinds but mass"),
    "far_mass": Number(100.0, "kg", "assumed, compliant: behind the link; load.mass is before it", TINY),
    "link_stiffness": Number(2e6, "N/m", "assumed, compliant", TINY),
    "link_damping": Number(1e3, "N s/m", "assumed, compliant"),
    "inertia": Table(
        ((0.0, 1500.0), (0.135, 1000.0), (0.27, 1500.0)),
        ("m", "kg"),
        "assumed, lever: moment of inertia over the arm squared, by position; load.mass is the piston's own",
    ),
    "lift": Table(
        ((0.0, -8000.0), (0.135, -7000.0), (0.27, -4000.0)),
        ("m", "N"),
        "assumed, lever: force of gravity on the piston, by position",
    ),
}
MECHANICS_BUILT = {  # numbers that stay while the rig runs: why
    **dict.fromkeys(("cylinder.wall", "cylinder.young", "cylinder.angle"), GEOMETRY),
    **{f"motor.{name}": GEOMETRY for name in ("displacement", "radius", "dead_lower", "dead_upper")},
    **{f"motor.{name}": GEOMETRY for name in ("ripple", "waves", "angle", "inertia")},
    "load.far_mass": "change load.force instead",
}
