"""Own figures `equal-flow`, `precompression`, `inlet-line`: both seats in physical numbers. Source: 4.4, pages lost."""

import math

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    remark,
    shades,
    sheet,
)
from bridge.figures.valve.chatter import COLOURS
from twin.chatter.build import pilot_of
from twin.chatter.equilibrium import onset
from twin.chatter.inlet_line import FAR_ENDS, InletLine, critical_damping
from twin.chatter.physical import Pilot, compare, reference, system
from twin.chatter.system import CONICAL, SEATS, SeatLaw, System
from twin.rig import Values, values

LITRE_PER_MINUTE = 1e-3 / 60.0
FLOWS = np.geomspace(0.001, 30.0, 60) * LITRE_PER_MINUTE
PARTS = {"spring": ("spring",), "and shear": ("spring", "shear"), "and film": ("spring", "shear", "film")}
STYLES = dict(zip(PARTS, (":", "--", "-"), strict=True))


def draw_equal_flow() -> tuple[Columns, Sheet]:
    """Critical damping of both seats at one flow, and how much of it each has."""
    pilot = pilot_of(values())
    columns: Columns = {"flow [m^3/s]": FLOWS}
    page, (left, right) = sheet("Both seats at equal flow", panels=2)
    for e, style, name in ((0.0, "-", "no precompression"), (pilot.reference_lift, "--", "0.23 mm")):
        for seat, law in SEATS.items():
            found = [compare(law, float(q), e, pilot) for q in FLOWS]
            critical = np.array([c.critical for c in found])
            left.plot(FLOWS / LITRE_PER_MINUTE, critical, style, color=COLOURS[seat], label=f"{seat}, {name}")
            columns[f"K_crit {seat} {name} [N s/m]"] = critical
            if e:
                continue
            for part, kinds in PARTS.items():
                if seat == "chamfered" and part != "spring":
                    continue
                safety = np.array([c.safety(*kinds) for c in found])
                words = "spring's oil" if part == "spring" else part
                right.plot(
                    FLOWS / LITRE_PER_MINUTE, safety, STYLES[part], color=COLOURS[seat], label=f"{seat}: {words}"
                )
                columns[f"K over K_crit {seat} {part} [-]"] = safety
    left.set(xscale="log", yscale="log", xlim=(1e-3, 30.0))
    left.legend(frameon=False, fontsize=8)
    label(left, "Q [l/min]", "$K_{crit}$ [N s/m]")
    right.axhline(1.0, color="black", linewidth=0.8)
    right.set(xscale="log", yscale="log", xlim=(1e-3, 30.0), ylim=(1e-3, 1e5))
    right.legend(frameon=False, fontsize=8)
    label(right, "Q [l/min]", "$K/K_{crit}$ [-]: below 1 it sings")
    return columns, page


def draw_precompression() -> tuple[Columns, Sheet]:
    """k_crit over the flow for e = 0 .. 2, both seats."""
    pilot = pilot_of(values())
    q = np.geomspace(1e-3, 0.5, 60)
    columns: Columns = {"q [-]": q}
    page, panels = sheet("Precompression raises the need for damping", panels=2)
    levels = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)
    for axes, (name, law) in zip(panels, SEATS.items(), strict=True):
        beta = reference(law, pilot).beta
        for e, colour in zip(levels, shades(levels), strict=True):
            k = np.array([onset(System(law, beta, float(f), e, 0.0, 1.0)).damping for f in q])
            axes.plot(q, k, color=colour, label=f"e = {e:g}")
            columns[f"k_crit {name} e {e:g} [-]"] = k
        own = system(law, 1e-3, 0.0, pilot).damping
        axes.axhline(own, color="0.5", linestyle="--", linewidth=0.9)
        axes.set_title(f"{name}, β = {beta:.5f}", fontsize=10)
        axes.set(xlim=(0.0, 0.5), ylim=(0.0, None))
        label(axes, "q [-]", "$k_{crit}$ [-]")
    panels[1].legend(frameon=False, fontsize=8)
    remark(page, "dashed: the damping of the oil on the spring alone, 2.32·10⁻⁴")
    return columns, page


def inlet_line(law: SeatLaw, length: float, far_end: str, pilot: Pilot, rig: Values) -> InletLine:
    """A line of the rig's own bore in the valve's units."""
    r, oil, diameter = reference(law, pilot), rig["oil"], rig["chatter"]["line_diameter"]
    speed = math.sqrt(pilot.modulus / oil["density"])
    impedance = oil["density"] * speed / (math.pi / 4.0 * diameter**2)
    viscosity = pilot.conical.viscosity / oil["density"]
    return InletLine(
        travel_time=r.omega * length / speed,
        viscous_time=r.omega * diameter**2 / (4.0 * viscosity),
        impedance=impedance * r.flow / r.pressure,
        losses="unsteady",
        far_end=far_end,
        volume=0.0,
    )


def draw_inlet_line() -> tuple[Columns, Sheet]:
    """k_crit over the length of a line that takes the place of the volume."""
    rig = values()
    pilot = pilot_of(rig)
    flow = 0.3 * LITRE_PER_MINUTE
    lengths = np.concatenate([np.linspace(0.02, 0.96, 48), np.linspace(1.0, 3.0, 41)])
    columns: Columns = {"length [m]": lengths}
    names = {"pressure": "a large vessel at its other end", "flow": "a constant flow into its other end"}
    page, panels = sheet("A line before the valve: critical damping over its length", panels=2)
    speed = math.sqrt(pilot.modulus / rig["oil"]["density"])
    quarter = speed / (4.0 * reference(CONICAL, pilot).omega / (2.0 * math.pi))
    for axes, far_end in zip(panels, FAR_ENDS, strict=True):
        for seat, law in SEATS.items():
            s = system(law, flow, 0.0, pilot)
            k = np.array([critical_damping(s, inlet_line(law, float(x), far_end, pilot, rig)) for x in lengths])
            axes.plot(lengths, k, color=COLOURS[seat], label=seat)
            axes.axhline(onset(s).damping, color=COLOURS[seat], linestyle=":", linewidth=1.0)
            columns[f"k_crit {seat} {far_end} [-]"] = k
        axes.set_title(names[far_end], fontsize=10)
        axes.axvline(quarter, color="0.6", linestyle="--", linewidth=0.9)
        axes.set(xlim=(0.0, 3.0), ylim=(0.0, 0.8))
        label(axes, "length [m]", "$k_{crit}$ [-]")
    panels[0].legend(frameon=False)
    remark(
        page,
        f"0.3 l/min; dashed: a quarter wave at the poppet's own frequency, {1e3 * quarter:.0f} mm; "
        "dotted: all of the oil in one volume",
    )
    return columns, page
