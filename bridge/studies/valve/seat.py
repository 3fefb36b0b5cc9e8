"""A seat at a lift and a pressure drop: flow, loss, forces, damping, and where the law holds."""

from typing import Any

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    sheet,
)
from twin.chatter.build import chamfered_of, conical_of
from twin.rig import Values
from twin.seats import chamfered, conical, film, validity, viscous

BAR, LITRE_PER_MINUTE, MM = 1e5, 1e-3 / 60.0, 1e-3


def facts(kind: str, x: float, drop: float, rig: Values, speed: float = 0.0) -> dict[str, Any]:
    """Numbers in SI, and warnings; x [m], drop [Pa]; speed of a conical poppet [m/s], > 0 opens.

    Raises ValueError for a lift that leaves no gap, and for a speed of the other seat.
    """
    density = rig["oil"]["density"]
    if drop == 0.0:
        raise ValueError("drop 0.0 Pa: without a pressure drop nothing flows; take another one")
    if kind == "chamfered":
        if speed:
            raise ValueError(f"--speed {speed:g} m/s: only the conical seat has a viscous force; leave it out")
        edge = chamfered_of(rig)
        if not 0.0 < x < edge.diameter:
            raise ValueError(f"lift {x} m: take one above 0 and below the seat's diameter, {edge.diameter} m")
        flow = chamfered.loss_flow(x, drop, edge)
        return {
            "flow": flow,
            "flow_constant_discharge": chamfered.discharge_flow(x, drop, edge),
            "loss_coefficient": chamfered.loss_coefficient(x, edge),
            "pressure_force": chamfered.pressure_force(x, drop, 0.0, edge),
            "momentum_force": chamfered.momentum_force(x, flow, edge),
            "warnings": list(validity.of_chamfered(x, edge).warnings),
        }
    seat = conical_of(rig)
    wall = speed * seat.cosine  # along the gap
    return {
        "flow": conical.flow(x, drop, wall, seat),
        "flow_fit": conical.power_flow(x, drop, 2.9, seat),
        "loss_coefficient": conical.loss_coefficient(x, drop, density, seat),
        "pressure_force": conical.pressure_force(x, drop, 0.0, wall, seat),
        "linear_pressure_force": conical.linear_pressure_force(x, drop, 0.0, seat),
        **{name: seat.cosine * part for name, part in _shear(x, drop, wall, density, seat).items()},
        "shear_damping": conical.shear_damping(x, seat),
        "film_damping": film.film_damping(x, seat),
        "warnings": list(validity.of_conical(x, drop, density, seat).warnings),
    }


def _shear(x: float, drop: float, wall: float, density: float, seat: conical.ConicalSeat) -> dict[str, float]:
    """The viscous force along the gap [N] by the models of 3.4; the diverging channel only of a wall that moves."""
    cone, cylinder = viscous.by_cone(x, drop, wall, seat), viscous.by_cylinder(x, drop, wall, seat)
    found = {
        "shear_force": cone.total,
        "shear_force_by_pressure": cone.by_pressure,
        "shear_force_by_speed": cone.by_speed,
        "cylinder_force": cylinder.total,
        "cylinder_force_middle": viscous.by_cylinder(x, drop, wall, seat, viscous.mean_radius(x, seat)).total,
    }
    if wall:
        found["channel_force_by_speed"] = viscous.by_channel(x, wall, density, seat).force.by_speed
    return found


WORDS = {
    "flow": ("flow", LITRE_PER_MINUTE, "l/min"),
    "flow_constant_discharge": ("flow with a constant discharge coefficient", LITRE_PER_MINUTE, "l/min"),
    "flow_fit": ("flow with the exponent 2.9 of the thesis's CFD", LITRE_PER_MINUTE, "l/min"),
    "loss_coefficient": ("loss coefficient, on the inlet's area", 1.0, ""),
    "pressure_force": ("pressure force, axial", 1.0, "N"),
    "linear_pressure_force": ("the same, pressure linear along the gap", 1.0, "N"),
    "momentum_force": ("momentum force", 1.0, "N"),
    "shear_force": ("viscous force, axial", 1.0, "N"),
    "shear_force_by_pressure": ("its part by pressure", 1.0, "N"),
    "shear_force_by_speed": ("its part by speed", 1.0, "N"),
    "channel_force_by_speed": ("the part by speed of the diverging channel, (3.49)", 1.0, "N"),
    "cylinder_force": ("viscous force of an equivalent cylinder, (3.23)", 1.0, "N"),
    "cylinder_force_middle": ("the same with the radius of the seat's middle", 1.0, "N"),
    "shear_damping": ("damping by shear", 1.0, "N s/m"),
    "film_damping": ("damping by the squeeze film", 1.0, "N s/m"),
}


def rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    """The facts for people."""
    named = [(WORDS[key], found[key]) for key in WORDS if key in found]
    return [(words, f"{value / scale:.5g} {unit}".rstrip()) for (words, scale, unit), value in named]


def draw(kind: str, x: float, drop: float, rig: Values) -> tuple[Columns, Sheet]:
    """Flow and pressure force over the lift at the drop, the asked lift marked; for a conical seat the pressure too."""
    lifts = np.linspace(0.05, 2.0, 79) * x
    found = [facts(kind, float(lift), drop, rig) for lift in lifts if kind == "conical" or lift < _most(rig)]
    lifts = lifts[: len(found)]
    flow, force = (np.array([row[key] for row in found]) for key in ("flow", "pressure_force"))
    page, panels = sheet(f"{kind} seat at {drop / BAR:.4g} bar", panels=3 if kind == "conical" else 2)
    marked = facts(kind, x, drop, rig)
    for axes, values, key, scale, words in (
        (panels[0], flow, "flow", LITRE_PER_MINUTE, "Q [l/min]"),
        (panels[1], force, "pressure_force", 1.0, "$F_p$ [N]"),
    ):
        axes.plot(lifts / MM, values / scale, color="tab:blue")
        axes.plot(x / MM, marked[key] / scale, "o", color="tab:red")
        label(axes, "lift [mm]", words)
        axes.set_xlim(0.0, None)
    columns: Columns = {"lift [m]": lifts, "flow [m^3/s]": flow, "pressure force [N]": force}
    if kind == "conical":
        seat = conical_of(rig)
        y = np.linspace(0.0, seat.length, len(lifts))
        p = np.array([conical.pressure(float(s), x, drop, 0.0, 0.0, seat) for s in y])
        panels[2].plot(y / MM, p / BAR, color="tab:blue")
        panels[2].plot([0.0, seat.length / MM], [drop / BAR, 0.0], ":", color="0.5")
        label(panels[2], "along the gap [mm]", f"p [bar] at a lift of {x / MM:.4g} mm")
        columns |= {"place along the gap [m]": y, "pressure [Pa]": p}
    return columns, page


def _most(rig: Values) -> float:
    return float(rig["relief"]["seat_diameter"])
