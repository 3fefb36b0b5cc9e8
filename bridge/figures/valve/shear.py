"""Figures 3.10, 3.11, 3.13 to 3.15: viscous force on the cone by three models.

Source: 3.4, corrected. Figure 3.13 and 3.14 have a wall that slides, F0 = 0, as the thesis's curves do.
"""

import math

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    shades,
    sheet,
)
from twin.chatter.build import conical_of
from twin.rig import values
from twin.seats import conical, diverging, film

BAR, MM = 1e5, 1e-3
LIFTS = (0.1e-3, 0.2e-3, 0.3e-3, 0.4e-3, 0.5e-3)  # [m]
SPEED, LIFT = 10.0, 0.5e-3  # [m/s], [m], Figure 3.13


def draw_pressure_factor() -> tuple[Columns, Sheet]:
    """Figure 3.10."""
    return _factor(0, "3.10  Viscous force, pressure term: exact over linear, $K_p$")


def draw_speed_factor() -> tuple[Columns, Sheet]:
    """Figure 3.11."""
    return _factor(1, "3.11  Viscous force, speed term: exact over linear, $K_v$")


def _factor(which: int, title: str) -> tuple[Columns, Sheet]:
    own = conical_of(values())
    lifts, angles = np.linspace(0.02, 1.0, 50) * MM, np.linspace(2.0, 88.0, 44)
    found = np.array(
        [[conical.linearity(float(x), own._replace(angle=math.radians(a)))[which] for x in lifts] for a in angles]
    )
    page, (axes,) = sheet(title)
    levels = np.unique(np.concatenate([np.arange(0.9, 1.2, 0.01), [1.0]]))
    lines = axes.contour(lifts / MM, angles, found, levels=levels, cmap="plasma", linewidths=0.9)
    axes.clabel(lines, fontsize=7, fmt="%.2f")
    axes.axhline(math.degrees(own.angle), color="0.4", linewidth=0.8, linestyle="--")
    label(axes, "lift x [mm]", "half angle α [°]")
    remark(page, f"dashed: the pilot's {math.degrees(own.angle):.0f}°")
    grid = np.meshgrid(lifts, angles)
    return {"lift [m]": grid[0].ravel(), "angle [deg]": grid[1].ravel(), "factor [-]": found.ravel()}, page


def channel_at(x: float, speed: float) -> tuple[diverging.Channel, float]:
    """The channel in the middle of the gap, and its R = Re/xi; speed along the gap [m/s]."""
    rig = values()
    seat = conical_of(rig)
    g = conical.gap(x, seat)
    radius = g.rm / seat.sine + 0.5 * seat.length  # r of the plane channel: a + s/2
    reynolds = speed * g.H**2 * rig["oil"]["density"] / (seat.viscosity * radius)
    return diverging.solve(reynolds), reynolds


def poiseuille(channel: diverging.Channel) -> Array:
    """u/V of the flow with the same pressure gradient and no inertia."""
    eta = channel.eta
    return 1.0 - eta - 0.5 * channel.gradient * eta * (1.0 - eta)


def difference(x: float, speed: float) -> float:
    """(3.50): the greatest difference of the two profiles over the wall's speed."""
    channel, _ = channel_at(x, speed)
    return float(np.abs(channel.speed - poiseuille(channel)).max())


def draw_profiles() -> tuple[Columns, Sheet]:
    """Figure 3.13."""
    from scipy.interpolate import BarycentricInterpolator

    channel, reynolds = channel_at(LIFT, SPEED)
    gap = conical.gap(LIFT, conical_of(values())).H
    eta = np.linspace(0.0, 1.0, 121)
    own, plain = (SPEED * BarycentricInterpolator(channel.eta, u)(eta) for u in (channel.speed, poiseuille(channel)))
    page, (axes,) = sheet("3.13  Velocity across the gap: diverging channel and Poiseuille")
    axes.plot(own, eta * gap / MM, color="black", label="diverging channel, (3.46)")
    axes.plot(plain, eta * gap / MM, "--", color="tab:red", label="Poiseuille, same pressure gradient")
    axes.set_ylim(0.0, gap / MM)
    label(axes, "u [m/s]", "distance from the cone [mm]")
    axes.legend(frameon=False)
    remark(page, f"v = {SPEED:.0f} m/s, x = {LIFT / MM} mm, middle of the seat: Re/ξ = {reynolds:.2f}")
    return {"height [m]": eta * gap, "u channel [m/s]": own, "u Poiseuille [m/s]": plain}, page


def draw_difference() -> tuple[Columns, Sheet]:
    """Figure 3.14."""
    lifts, speeds = np.linspace(0.05, 1.0, 39) * MM, np.linspace(0.25, 11.0, 44)
    found = np.array([[difference(float(x), float(v)) for x in lifts] for v in speeds])
    page, (axes,) = sheet("3.14  Difference of the two profiles over the speed of the wall")
    lines = axes.contour(lifts / MM, speeds, 1e2 * found, levels=[0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 5.0], cmap="plasma")
    axes.clabel(lines, fontsize=8, fmt="%g %%")
    axes.axhspan(0.0, 2.0, xmax=0.5 / 1.0, color="0.9", zorder=0)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 11.0))
    label(axes, "lift x [mm]", "speed of the cone along the gap [m/s]")
    remark(page, "grey: the pilot's range")
    grid = np.meshgrid(lifts, speeds)
    return {"lift [m]": grid[0].ravel(), "speed [m/s]": grid[1].ravel(), "difference [-]": found.ravel()}, page


def draw_viscous() -> tuple[Columns, Sheet]:
    """Figure 3.15, and beside it what damps a moving cone: shear, and the film that the thesis leaves out."""
    seat = conical_of(values())
    drop, grid = np.linspace(0.0, 40.0 * BAR, 50), np.geomspace(0.02, 0.6, 50) * MM
    columns: Columns = {"drop [Pa]": drop}
    page, (left, right) = sheet("3.15  Viscous force on the cone at rest; damping of the moving cone", panels=2)
    for x, colour in zip(LIFTS, shades(LIFTS), strict=True):
        linear = np.array([conical.linear_shear_force(x, float(p), 0.0, seat) for p in drop])
        axial = seat.cosine * np.array([conical.shear_force(x, float(p), 0.0, seat) for p in drop])
        name = f"{x / MM:.1f} mm"
        left.plot(drop / BAR, linear, color=colour, label=name)
        left.plot(drop / BAR, axial, ":", color=colour)
        columns |= {f"linear {name} [N]": linear, f"axial {name} [N]": axial}
    left.plot([], [], ":", color="black", label="exact, axial part")
    left.set(xlim=(0.0, 40.0), ylim=(0.0, None))
    left.legend(frameon=False, title="lift, (3.32)", fontsize=8)
    label(left, "Δp [bar]", "$F_v$ [N]")
    shear = np.array([conical.shear_damping(float(x), seat) for x in grid])
    squeezed = np.array([film.film_damping(float(x), seat) for x in grid])
    right.plot(grid / MM, shear, color="tab:blue", label="shear")
    right.plot(grid / MM, squeezed, color="tab:red", label="squeeze film")
    right.axhline(_spring_drag(), color="0.5", linestyle="--", linewidth=0.9, label="oil on the spring")
    right.set(xscale="log", yscale="log")
    right.set_xticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
    right.minorticks_off()
    right.legend(frameon=False, fontsize=8)
    label(right, "lift x [mm]", "K [N s/m]")
    return columns | {"lift [m]": grid, "shear damping [N s/m]": shear, "film damping [N s/m]": squeezed}, page


def _spring_drag() -> float:
    from twin.chatter.build import pilot_of

    return pilot_of(values()).drag
