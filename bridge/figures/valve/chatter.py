"""Figures 4.3 to 4.5 and `lyapunov`: onset of chatter, and whether it is soft or hard. Source: 4.2, 4.3, corrected."""

import math

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Axes,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from twin.chatter.equilibrium import bare, onset
from twin.chatter.lyapunov import change, first_coefficient
from twin.chatter.orbit import follow, small
from twin.chatter.system import CHAMFERED, CONICAL, SEATS, System

COLOURS = {"chamfered": "tab:blue", "conical": "tab:red"}
Z = np.concatenate([np.geomspace(1e-3, 0.05, 20), np.linspace(0.06, 5.0, 200)])
PRINTED = 1.323  # 4.2.3
SOFT, HARD = bare(0.5, CONICAL), bare(4.5, CHAMFERED)
DEPTHS = np.array([0.03, 0.08, 0.15, 0.23, 0.32, 0.42, 0.52, 0.62, 0.72, 0.82, 0.91, 1.0])


def branch(s: System, depths: Array) -> tuple[Array, Array, float]:
    """Damping and depth of the orbits, and k_crit."""
    found = follow(small(s, float(depths[0])), depths, "damping", tolerance=1e-10)
    return np.array([o.system.damping for o in found]), np.array([o.depth for o in found]), onset(s).damping


def draw_loss() -> tuple[Columns, Sheet]:
    """Figure 4.3, of two real valves: the depth of the swing over the damping, which falls to the right."""
    page, panels = sheet("4.3  Soft and hard loss of stability", panels=2)
    columns: Columns = {}
    cases = (("soft", SOFT, DEPTHS, "conical, z = 0.5"), ("hard", HARD, DEPTHS, "chamfered, z = 4.5"))
    for axes, (kind, s, depths, name) in zip(panels, cases, strict=True):
        k, depth, k0 = branch(s, depths)
        stable = kind == "soft"
        spread = 1.3 * max(float(np.abs(k - k0).max()), 1e-3 * k0)
        axes.plot([k0 + spread, k0], [0.0, 0.0], color="black", label="equilibrium, stable")
        axes.plot([k0, k0 - spread], [0.0, 0.0], "--", color="black", label="equilibrium, unstable")
        style = "-" if stable else "--"
        axes.plot([k0, *k], [0.0, *depth], style, color="tab:red", label=f"swing, {'stable' if stable else 'unstable'}")
        axes.plot(k0, 0.0, "ko", markersize=5)
        axes.set_title(f"{kind}: {name}", fontsize=10)
        axes.set(xlim=(k0 + spread, k0 - spread), ylim=(-0.05, 1.05))
        label(axes, "damping k [-], falling", "depth of the swing [steady lifts]")
        axes.legend(frameon=False, fontsize=8, loc="upper left" if stable else "upper right")
        columns |= {f"{kind} damping [-]": k, f"{kind} depth [-]": depth}
    remark(page, "depth 1: the poppet touches its seat")
    return columns, page


def _over_z(axes: Axes, quantity: str) -> dict[str, Array]:
    found = {name: np.array([getattr(onset(bare(float(z), law)), quantity) for z in Z]) for name, law in SEATS.items()}
    for name, values in found.items():
        axes.plot(Z, values, color=COLOURS[name], label=name)
    axes.set_xlim(0.0, 5.0)
    axes.legend(frameon=False)
    return found


def draw_critical() -> tuple[Columns, Sheet]:
    """Figure 4.4, for both seats."""
    page, (axes,) = sheet("4.4  Critical damping without precompression")
    found = _over_z(axes, "damping")
    axes.plot([1.0, 1.0], [math.sqrt(3.0) - 1.0, 1.0], "k.", markersize=5)
    axes.text(2.6, 0.35, "sings")
    axes.text(2.6, 0.95, "calm")
    axes.set_ylim(0.0, 1.1)
    label(axes, "z [-]", "$k_{crit}$ [-]")
    remark(page, "(4.14), (4.42); z = β/2 q$^{1/3}$ chamfered, β q$^{3/4}$ conical. At work z is below 0.0035.")
    return {"z [-]": Z} | {f"k_crit {name} [-]": value for name, value in found.items()}, page


def draw_frequency() -> tuple[Columns, Sheet]:
    """Figure 4.5, for both seats."""
    page, (axes,) = sheet("4.5  Frequency of the swing that begins, without precompression")
    found = _over_z(axes, "frequency")
    for name, limit in (("chamfered", math.sqrt(3.0)), ("conical", 2.0)):
        axes.axhline(limit, color=COLOURS[name], linestyle=":", linewidth=0.9)
    axes.set_ylim(1.0, 2.05)
    label(axes, "z [-]", "ω [of poppet and spring]")
    remark(page, "(4.15), (4.43); dotted: √3 and 2, the limits for large z")
    return {"z [-]": Z} | {f"omega {name} [-]": value for name, value in found.items()}, page


def draw_lyapunov() -> tuple[Columns, Sheet]:
    """First Lyapunov coefficient of both seats: where soft turns hard."""
    z = np.linspace(0.05, 8.0, 160)
    columns: Columns = {"z [-]": z}
    page, (axes,) = sheet("First Lyapunov coefficient: below zero the loss of stability is soft")
    for name, law in SEATS.items():
        found = np.array([first_coefficient(bare(float(value), law)) for value in z])
        root = change(law)
        axes.plot(z, found, color=COLOURS[name], label=f"{name}: soft up to z = {root:.6f}")
        axes.plot(root, 0.0, "o", color=COLOURS[name], markersize=5)
        columns[f"l1 {name} [-]"] = found
    axes.axhline(0.0, color="black", linewidth=0.8)
    axes.axvline(PRINTED, color="0.5", linestyle="--", linewidth=0.9, label="1.323, printed for the chamfered seat")
    axes.set_xlim(0.0, 8.0)
    label(axes, "z [-]", "$l_1$ [-], amplitudes in steady lifts")
    axes.legend(frameon=False, loc="lower right")
    return columns, page
