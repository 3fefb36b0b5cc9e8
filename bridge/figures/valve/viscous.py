"""Three models of the viscous force on the cone, side by side: equivalent cylinder, conical gap, diverging channel.

Source: 3.4, (3.18) to (3.49), corrected. The part by pressure is drawn over the drop that makes it, the part by speed
over the speed; both are so of the two closed models at any drop and speed, and of the channel at the ones shown. Forces
are along the gap; the axial ones are cos a of them.
"""

import numpy as np

from bridge.drawing.canvas import Axes, Columns, Sheet, label, remark, shades, sheet
from twin.chatter.build import conical_of
from twin.rig import values
from twin.seats import viscous

BAR, MM = 1e5, 1e-3
LIFTS = np.geomspace(0.02, 0.6, 25) * MM  # [m]
SPEED = 1.0  # [m/s], of the channel's parts
SPEEDS = np.linspace(0.5, 10.0, 20)  # [m/s]
SHOWN = (0.1 * MM, 0.3 * MM, 0.5 * MM)  # [m]
STYLES = {
    "equivalent cylinder, $r_1$": ("--", "tab:red"),
    "conical gap, exact": ("-", "black"),
    f"diverging channel, {SPEED:g} m/s": (":", "tab:blue"),
}


def parts_over_lift() -> Columns:
    """Force over drop [N/Pa] and over speed [N s/m] of each model."""
    rig = values()
    seat, density = conical_of(rig), rig["oil"]["density"]
    closed = [(viscous.by_cylinder(x, 1.0, 1.0, seat), viscous.by_cone(x, 1.0, 1.0, seat)) for x in map(float, LIFTS)]
    channel = [viscous.by_channel(x, SPEED, density, seat) for x in map(float, LIFTS)]
    table: Columns = {"lift [m]": LIFTS}
    for index, name in enumerate(("cylinder", "cone")):
        table[f"{name} by pressure [N/Pa]"] = np.array([row[index].by_pressure for row in closed])
        table[f"{name} by speed [N s/m]"] = np.array([row[index].by_speed for row in closed])
    table["channel by pressure [N/Pa]"] = np.array([found.force.by_pressure / found.drop for found in channel])
    table["channel by speed [N s/m]"] = np.array([found.force.by_speed / SPEED for found in channel])
    return table


def inertia(x: float) -> np.ndarray:
    """(3.49) over SPEEDS, less the exact cone at the same drop and speed, over the part by speed [-]."""
    rig = values()
    seat, density = conical_of(rig), rig["oil"]["density"]
    out = []
    for wall in map(float, SPEEDS):
        found = viscous.by_channel(x, wall, density, seat)
        cone = viscous.by_cone(x, found.drop, wall, seat)
        out.append((found.force.total - cone.total) / abs(cone.by_speed))
    return np.array(out)


def draw_models() -> tuple[Columns, Sheet]:
    """Part by pressure, part by speed, and what the channel's inertia changes."""
    table = parts_over_lift()
    page, (left, middle, right) = sheet("Viscous force on the cone by three models", panels=3)
    for (name, (style, colour)), key in zip(STYLES.items(), ("cylinder", "cone", "channel"), strict=True):
        pressure, speed = table[f"{key} by pressure [N/Pa]"], table[f"{key} by speed [N s/m]"]
        left.plot(LIFTS / MM, BAR * pressure, style, color=colour, linewidth=1.8, label=name)
        middle.plot(LIFTS / MM, -speed, style, color=colour, linewidth=1.8)
    left.legend(frameon=False, fontsize=9)
    label(left, "lift x [mm]", "part by pressure: force over drop [N/bar]")
    label(middle, "lift x [mm]", "part by speed: − force over speed [N s/m]")
    for axes in (left, middle):
        _logarithmic(axes)
    for x, colour in zip(SHOWN, shades(SHOWN), strict=True):
        off = inertia(x)
        right.plot(SPEEDS, 100.0 * off, color=colour, label=f"{x / MM:.1f} mm")
        table |= {f"channel less cone at {x / MM:.1f} mm {SPEEDS[-1]:g} m/s [-]": np.full(len(LIFTS), off[-1])}
    right.axhline(0.0, color="0.5", linewidth=0.8)
    right.legend(frameon=False, title="lift")
    label(right, "speed of the wall along the gap [m/s]", "(3.49) less the cone, over its part by speed [%]")
    remark(
        page,
        "Along the gap. Right: at the drop that (3.46) needs for that speed; without inertia and in a narrow gap the "
        "difference would be zero.",
    )
    return table, page


def _logarithmic(axes: Axes) -> None:
    axes.set(xscale="log", yscale="log")
    axes.set_xticks([0.02, 0.05, 0.1, 0.2, 0.5], ["0.02", "0.05", "0.1", "0.2", "0.5"])
    axes.minorticks_off()
