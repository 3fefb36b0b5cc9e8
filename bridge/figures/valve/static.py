"""Figures 2.14, 2.15, 2.18, 2.20: orifice 2, the pressure force on the pilot, the static curve of the relief valve.

Source: 2.4. Its CFD points exist only as pictures; curves are the theory alone.
"""

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
from bridge.studies.valve.static import oil_of, valve_of
from twin.chatter.build import chamfered_of
from twin.orifice import Orifice, quadratic_flow, resistance
from twin.relief.sensitivity import curve, knee
from twin.rig import values
from twin.seats.chamfered import loss_coefficient, momentum_force

BAR, LITRE_PER_MINUTE = 1e5, 1e-3 / 60.0
MEAN_DISCHARGE = 0.78  # 2.4.1, mean of the thesis's CFD
WIDE = 0.8e-3  # [m], the nozzle that the axis of Fig. 2.15 asks for; that of Fig. 2.18 asks for the rig's
LIFTS = (0.2e-3, 0.3e-3, 0.4e-3, 0.5e-3)  # [m]
PRECOMPRESSIONS = (0.2e-3, 0.4e-3, 0.6e-3, 0.8e-3, 1.0e-3)  # [m]
TUBE_EDGE = 50.0  # Re at which Merritt's two laws meet, (2.22)


def tube_discharge(reynolds: np.ndarray) -> np.ndarray:
    """C_d of a short tube as long as wide, after Merritt, (2.22)."""
    slow = (2.28 + 64.0 / reynolds) ** -0.5
    return np.where(reynolds < TUBE_EDGE, slow, (1.5 + 13.74 / np.sqrt(reynolds)) ** -0.5)


def draw_discharge() -> tuple[Columns, Sheet]:
    """Figure 2.14."""
    rig = values()["relief"]
    re = np.concatenate([[0.5, 1.0, 2.0, 5.0], np.arange(10.0, 1501.0, 10.0)])

    def borutzky(c: float, transition: float) -> np.ndarray:
        return c * np.sqrt(re / (re + transition))

    laws = {
        "orifice 2": borutzky(rig["nozzle_discharge"], rig["nozzle_transition"]),
        "sharp edge (1 and 3)": borutzky(rig["orifice_discharge"], rig["orifice_transition"]),
        "short tube after Merritt": tube_discharge(re),
    }
    page, (axes,) = sheet("2.14  Discharge coefficient over the Reynolds number")
    for (name, law), style in zip(laws.items(), ("-", "--", ":"), strict=True):
        axes.plot(re, law, style, color="black", label=name)
    axes.axhline(MEAN_DISCHARGE, color="tab:red", linewidth=0.9, label="0.78, the thesis's mean")
    axes.set(xlim=(0.0, 1500.0), ylim=(0.0, 0.95))
    label(axes, "Re [-]", "$C_d$ [-]")
    axes.legend(frameon=False, loc="lower right")
    return {"Re [-]": re} | {f"Cd {name} [-]": law for name, law in laws.items()}, page


def nozzle(diameter: float) -> tuple[float, float]:
    """a, b of the rig's orifice 2 with a diameter [m]: drop = a Q|Q| + b Q."""
    rig = values()
    part = rig["relief"]
    orifice = Orifice(part["nozzle_discharge"], part["nozzle_transition"])
    return resistance(math.pi / 4.0 * diameter**2, orifice, oil_of(rig))


def draw_orifice_flow() -> tuple[Columns, Sheet]:
    """Figure 2.15."""
    rig = values()
    part, oil = rig["relief"], oil_of(rig)
    area = math.pi / 4.0 * part["nozzle_diameter"] ** 2
    a, b = nozzle(part["nozzle_diameter"])
    drop = np.linspace(0.0, 40.0 * BAR, 201)
    flow = np.array([quadratic_flow(float(p), a, b) for p in drop])
    mean = MEAN_DISCHARGE * area * np.sqrt(2.0 * drop / oil.density)
    page, (axes,) = sheet("2.15  Flow through orifice 2 over its pressure drop")
    axes.plot(drop / BAR, flow / LITRE_PER_MINUTE, color="tab:blue", label="$C_d$ after Borutzky, (2.24)")
    axes.plot(drop / BAR, mean / LITRE_PER_MINUTE, color="tab:red", label="$C_d$ = 0.78")
    axes.set(xlim=(0.0, 40.0), ylim=(0.0, None))
    label(axes, "$p_1 - p_2$ [bar]", "Q [l/min]")
    axes.legend(frameon=False, loc="lower right")
    wide = quadratic_flow(float(drop[-1]), *nozzle(WIDE)) / LITRE_PER_MINUTE
    remark(
        page,
        f"Nozzle {part['nozzle_diameter'] * 1e3:.3g} mm, as Fig. 2.18 asks for. The thesis's axis ends at 2.5 l/min, "
        f"which fits {WIDE * 1e3:.1f} mm ({wide:.2f} l/min): the two figures contradict each other.",
    )
    return {"drop [Pa]": drop, "flow Borutzky [m^3/s]": flow, "flow mean Cd [m^3/s]": mean}, page


def draw_pilot_force() -> tuple[Columns, Sheet]:
    """Figure 2.18: the law (2.34), and with the momentum of the jet; orifice 2 in series with the pilot's seat."""
    rig = values()
    part, oil, seat = rig["relief"], oil_of(rig), chamfered_of(rig)
    a, b = nozzle(part["nozzle_diameter"])
    p_in = np.linspace(0.0, 100.0 * BAR, 101)
    columns: Columns = {"inlet pressure [Pa]": p_in}
    page, (axes,) = sheet("2.18  Pressure force on the pilot over the pressure before orifice 2")
    for x, colour in zip(LIFTS, shades(LIFTS), strict=True):
        per_square = 0.5 * oil.density * loss_coefficient(x, seat) / seat.area**2
        flow = np.array([quadratic_flow(float(p), a + per_square, b) for p in p_in])
        force = seat.area * per_square * flow**2
        jet = np.array([momentum_force(x, float(q), seat) for q in flow])
        name = f"{x * 1e3:.1f} mm"
        axes.plot(p_in / BAR, force, color=colour, label=name)
        axes.plot(p_in / BAR, force + jet, "--", color=colour)
        columns |= {f"pressure force {name} [N]": force, f"with momentum {name} [N]": force + jet}
    axes.plot([], [], "--", color="black", label="with (2.33), momentum")
    axes.set(xlim=(0.0, 100.0))
    label(axes, "$p_{in}$ [bar]", "F [N]")
    axes.legend(frameon=False, title="lift")
    name, own = f"{LIFTS[0] * 1e3:.1f} mm", f"{part['nozzle_diameter'] * 1e3:.3g} mm"
    most, bare = columns[f"pressure force {name} [N]"][-1], seat.area * p_in[-1]
    per_square = 0.5 * oil.density * loss_coefficient(LIFTS[0], seat) / seat.area**2
    a, b = nozzle(WIDE)
    wide = seat.area * per_square * quadratic_flow(float(p_in[-1]), a + per_square, b) ** 2
    behind = f"{most:.1f} N behind a nozzle of {own}, {wide:.1f} N behind {WIDE * 1e3:.1f} mm, which Fig. 2.15 asks for"
    remark(
        page,
        f"(2.34): $p_2$ over the whole inlet. {name} at 100 bar: {behind}, {bare:.0f} N without one;\n"
        "the thesis's axis ends at 25 N: the two figures contradict each other.",
    )
    return columns, page


def draw_static() -> tuple[Columns, Sheet]:
    """Figure 2.20, with the openings of both stages and the knee."""
    rig = values()
    flows = np.concatenate([np.geomspace(1e-3, 1.0, 25), np.geomspace(1.25, 200.0, 45)]) * LITRE_PER_MINUTE
    columns: Columns = {"flow [m^3/s]": flows}
    page, (left, right) = sheet("2.20  Static curve of the relief valve", panels=2)
    for precompression, colour in zip(PRECOMPRESSIONS, shades(PRECOMPRESSIONS), strict=True):
        valve = valve_of(rig, precompression)
        found, bend = curve(flows, valve), knee(valve)
        name = f"{precompression * 1e3:.1f} mm"
        left.plot(flows / LITRE_PER_MINUTE, found.pressure / BAR, color=colour, label=name)
        left.plot(bend.flow / LITRE_PER_MINUTE, bend.pressure / BAR, "o", color=colour, markersize=4)
        right.plot(flows / LITRE_PER_MINUTE, found.pilot_lift * 1e6, color=colour)
        right.plot(flows / LITRE_PER_MINUTE, found.spool_lift * 1e6, "--", color=colour)
        columns |= {
            f"pressure {name} [Pa]": found.pressure,
            f"pilot lift {name} [m]": found.pilot_lift,
            f"spool lift {name} [m]": found.spool_lift,
        }
    left.set(xlim=(0.0, 200.0), ylim=(0.0, 350.0))
    left.plot([], [], "o", color="black", markersize=4, label="main stage opens")
    page.legend(
        *left.get_legend_handles_labels(), title="precompression", loc="outside lower center", ncols=6, frameon=False
    )
    label(left, "Q [l/min]", "$p_{in} - p_{out}$ [bar]")
    right.plot([], [], color="black", label="pilot")
    right.plot([], [], "--", color="black", label="main spool")
    right.set(xscale="log", yscale="log", xlim=(1e-3, 200.0), ylim=(0.1, 2000.0))
    right.legend(frameon=False, loc="upper left")
    label(right, "Q [l/min]", "opening [µm]")
    return columns, page
