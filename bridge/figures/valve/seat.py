"""Figures 3.2 to 3.4, 3.8, 3.9: pressure, flow and pressure force in the long conical seat.

Source: 3.2, 3.3, corrected. Its CFD points exist only as pictures.
"""

import math

import numpy as np

from bridge.drawing.canvas import (
    Axes,
    Columns,
    Sheet,
    label,
    remark,
    shades,
    sheet,
)
from twin.chatter.build import conical_of
from twin.rig import values
from twin.seats import conical

BAR, LITRE_PER_MINUTE, MM = 1e5, 1e-3 / 60.0, 1e-3
LIFTS = (0.1e-3, 0.2e-3, 0.3e-3, 0.4e-3, 0.5e-3)  # [m]
ANGLES = (20.0, 40.0, 60.0, 80.0)  # [deg], 3.2
SPEEDS = ((0.0, "-"), (5.0, "--"), (-5.0, ":"))  # [m/s], 3.2
LENGTHS = (5e-3, 100e-3)  # [m], 3.2
OUTLET = 1.0 * BAR  # of 3.9, assumed
INLET, LIFT = 50.0 * BAR, 0.2e-3  # of 3.2; the thesis does not print its lift: assumed


def draw_pressure() -> tuple[Columns, Sheet]:
    """Figure 3.2."""
    own = conical_of(values())
    share = np.linspace(0.0, 1.0, 101)
    columns: Columns = {"share of the length [-]": share}
    page, panels = sheet("3.2  Pressure along the conical seat", panels=2)
    for axes, length in zip(panels, LENGTHS, strict=True):
        for angle, colour in zip(ANGLES, shades(ANGLES), strict=True):
            seat = own._replace(length=length, angle=math.radians(angle))
            for speed, style in SPEEDS:
                p = np.array([conical.pressure(float(s) * length, LIFT, INLET, 0.0, speed, seat) for s in share])
                axes.plot(share * length / MM, p / BAR, style, color=colour, linewidth=1.1)
                columns[f"p L {length / MM:.0f} mm {angle:.0f} deg {speed:+.0f} m/s [Pa]"] = p
        axes.set_title(f"L = {length / MM:.0f} mm", fontsize=10)
        axes.set(xlim=(0.0, length / MM), ylim=(0.0, None))
        label(axes, "y [mm]", "p [bar]")
    for angle, colour in zip(ANGLES, shades(ANGLES), strict=True):
        panels[0].plot([], [], color=colour, label=f"α = {angle:.0f}°")
    for speed, style in SPEEDS:
        panels[0].plot([], [], style, color="black", label=f"v = {speed:+.0f} m/s" if speed else "v = 0")
    panels[0].legend(frameon=False, fontsize=8)
    remark(page, f"lift {LIFT / MM} mm (assumed); v: speed of the cone along the gap, whose widening is left out")
    return columns, page


def draw_exponent() -> tuple[Columns, Sheet]:
    """Figure 3.3: the exact law between its two powers."""
    seat = conical_of(values())
    e = np.geomspace(0.02, 0.25, 60)
    scale = conical.power_flow(seat.radius, 1.0, 3.0, seat)
    exact = np.array([conical.flow(float(x) * seat.radius, 1.0, 0.0, seat) for x in e]) / scale
    curves = {"e³, small lifts": e**3, "e^2.9, the thesis's fit to CFD": e**2.9, "exact, (3.2)": exact}
    page, (axes,) = sheet("3.3  Flow through the conical seat over the lift: Ξ(e)")
    for (name, value), style in zip(curves.items(), ("-", "--", "-."), strict=True):
        axes.plot(e, value, style, label=name, color={"-": "tab:blue", "--": "tab:green", "-.": "black"}[style])
    axes.set(xscale="log", yscale="log")
    axes.set_xticks([0.025, 0.05, 0.1, 0.2], ["0.025", "0.05", "0.1", "0.2"])
    axes.minorticks_off()
    label(axes, "e = x/$r_2$ [-]", "Ξ [-]")
    axes.legend(frameon=False)
    return {"e [-]": e, "Xi cubic [-]": e**3, "Xi 2.9 [-]": e**2.9, "Xi exact [-]": exact}, page


def draw_flow() -> tuple[Columns, Sheet]:
    """Figure 3.4."""
    seat = conical_of(values())
    drop = np.linspace(0.0, 40.0 * BAR, 81)
    columns: Columns = {"drop [Pa]": drop}
    page, (axes,) = sheet("3.4  Flow through the conical seat over the pressure drop")
    for x, colour in zip(LIFTS, shades(LIFTS), strict=True):
        exact = np.array([conical.flow(x, float(p), 0.0, seat) for p in drop])
        fitted = np.array([conical.power_flow(x, float(p), 2.9, seat) for p in drop])
        name = f"{x / MM:.1f} mm"
        axes.plot(drop / BAR, exact / LITRE_PER_MINUTE, color=colour, label=name)
        axes.plot(drop / BAR, fitted / LITRE_PER_MINUTE, "--", color=colour)
        columns |= {f"flow {name} [m^3/s]": exact, f"flow 2.9 {name} [m^3/s]": fitted}
    axes.plot([], [], "--", color="black", label="(3.11), exponent 2.9")
    axes.set(xlim=(0.0, 40.0), ylim=(0.0, None))
    label(axes, "$p_2 - p_{out}$ [bar]", "Q [l/min]")
    axes.legend(frameon=False, title="lift")
    remark(
        page,
        "Laminar throughout; beyond some 1 l/min the jet's inertia, left out here, takes a share of the drop.",
    )
    return columns, page


def draw_force() -> tuple[Columns, Sheet]:
    """Figure 3.8."""
    seat = conical_of(values())
    drop = np.linspace(0.0, 40.0 * BAR, 41)
    columns: Columns = {"drop [Pa]": drop}
    page, (axes,) = sheet("3.8  Pressure force on the cone over the pressure drop")
    for x, colour in zip(LIFTS, shades(LIFTS), strict=True):
        exact = np.array([conical.pressure_force(x, float(p), 0.0, 0.0, seat) for p in drop])
        linear = np.array([conical.linear_pressure_force(x, float(p), 0.0, seat) for p in drop])
        name = f"{x / MM:.1f} mm"
        axes.plot(drop / BAR, exact, color=colour, label=name)
        axes.plot(drop / BAR, linear, "--", color=colour)
        columns |= {f"force {name} [N]": exact, f"linear {name} [N]": linear}
    axes.plot([], [], "--", color="black", label="pressure linear along the gap")
    axes.set(xlim=(0.0, 40.0), ylim=(0.0, None))
    label(axes, "Δp [bar]", "$F_p$ [N]")
    axes.legend(frameon=False, title="lift")
    return columns, page


def draw_components() -> tuple[Columns, Sheet]:
    """Figure 3.9: nose, seat, and what the outlet pressure takes off."""
    drop = np.linspace(0.0, 40.0 * BAR, 41)
    columns: Columns = {"drop [Pa]": drop}
    page, panels = sheet("3.9  Parts of the pressure force on the cone", panels=2)
    for axes, x in zip(panels, (LIFTS[0], LIFTS[-1]), strict=True):
        _components(axes, x, drop, columns)
    panels[0].legend(frameon=False)
    remark(page, f"outlet at {OUTLET / BAR:.0f} bar (assumed), so that its part shows; at 0 bar it is none")
    return columns, page


def _components(axes: Axes, x: float, drop: np.ndarray, columns: Columns) -> None:
    seat = conical_of(values())
    g = conical.gap(x, seat)
    nose = math.pi * g.r1**2 * (drop + OUTLET)
    back = np.full_like(drop, -math.pi * (g.r1 + seat.length * seat.sine) ** 2 * OUTLET)
    whole = np.array([conical.pressure_force(x, float(p) + OUTLET, OUTLET, 0.0, seat) for p in drop])
    parts = {"inlet": nose, "along the seat": whole - nose - back, "outlet": back, "sum": whole}
    for (name, force), colour in zip(parts.items(), ("tab:blue", "tab:red", "tab:green", "tab:cyan"), strict=True):
        axes.plot(drop / BAR, force, color=colour, label=name)
        columns[f"{name} {x / MM:.1f} mm [N]"] = force
    axes.set_title(f"lift {x / MM:.1f} mm", fontsize=10)
    axes.set_xlim(0.0, 40.0)
    label(axes, "Δp [bar]", "F [N]")
