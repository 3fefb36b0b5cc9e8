"""Own figures `impact`, `impact-chart`, `basin`: the poppet on its seat. Source: 4.4.3, pages lost."""

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from bridge.figures.valve.chatter import COLOURS
from bridge.studies.valve.chart import patches, patches_legend
from twin.chatter.basin import basin, bifurcation, chart
from twin.chatter.build import pilot_of
from twin.chatter.equilibrium import bare, onset, rest
from twin.chatter.impact import tops
from twin.chatter.lyapunov import change
from twin.chatter.orbit import follow, small
from twin.chatter.physical import reference, system
from twin.chatter.system import CHAMFERED, SEATS, SeatLaw, System
from twin.rig import values

COUNT = 24  # tops per flow; as many flows in each diagram


def of_rig(law: SeatLaw, e: float, damping: float | None = None) -> System:
    """The pilot's system; without a damping with that of the oil on its spring."""
    pilot = pilot_of(values())
    s = system(law, reference(law, pilot).flow, e * pilot.reference_lift, pilot)
    return s if damping is None else s._replace(damping=damping)


# one stage before a large vessel, stiff: period two, chaos and complete chatter (Licsko, Champneys, Hos 2009)
WILD = System(CHAMFERED, 20.0, 1.0, 10.0, 1.25, 0.8)


def draw_impact() -> tuple[Columns, Sheet]:
    """Bifurcation diagram over the flow: highest lifts, how hard the seat is hit, and a valve that does more."""
    flows, wild = np.linspace(0.01, 0.5, 34), np.linspace(0.6, 8.5, 34)
    columns: Columns = {}
    page, panels = sheet("Motion with impacts over the flow; section: y₂ = 0 from above", panels=3)
    for name, law in SEATS.items():
        for e, mark in ((0.0, "o"), (1.0, "^")):
            flow, top, impact = bifurcation(of_rig(law, e), flows, 800, COUNT)
            for axes, value in zip(panels[:2], (top, impact), strict=True):
                axes.plot(flow, value, mark, color=COLOURS[name], markersize=2.5, label=f"{name}, e = {e:g}", alpha=0.6)
            columns |= {
                "q [-]": flow, f"top {name} e {e:g} [-]": top, f"impact speed {name} e {e:g} [-]": impact,
            }  # fmt: skip
    flow, top, _ = bifurcation(WILD, wild, 300, COUNT)
    panels[2].plot(flow, top, ".", color="black", markersize=2)
    panels[2].set_title("chamfered, β = 20, e = 10, k = 1.25", fontsize=10)
    panels[2].set(xlim=(0.0, 9.0), ylim=(0.0, None))
    label(panels[2], "q [-]", "highest lift $y_1$ [-]")
    columns |= {"q wild [-]": flow, "top wild [-]": top}
    for axes, words in zip(panels[:2], ("highest lift $y_1$ [-]", "impact speed [-]"), strict=True):
        axes.set(xlim=(0.0, 0.51), ylim=(0.0, None))
        label(axes, "q [-]", words)
    panels[0].legend(frameon=False, fontsize=8)
    remark(page, "left, middle: the pilot, k = 2.32·10⁻⁴; restitution 0.8 throughout")
    return columns, page


def draw_chart() -> tuple[Columns, Sheet]:
    """Flow and damping, both seats, e = 0 and 1: what a push of 1 % ends in. 20 x 20 here; the verb draws any size."""
    flows, dampings = np.linspace(0.01, 0.5, 20), np.linspace(1e-4, 0.02, 20)
    q, k = np.meshgrid(flows, dampings)
    columns: Columns = {"q [-]": q.ravel(), "k [-]": k.ravel()}
    page, panels = sheet("What a push of 1 % ends in, e = 1", panels=2)
    for axes, (name, law) in zip(panels, SEATS.items(), strict=True):
        kind, top = chart(of_rig(law, 1.0), flows, dampings, shut=False)
        patches(axes, flows, dampings, kind)
        critical = [onset(of_rig(law, 1.0)._replace(flow=float(f))).damping for f in flows]
        axes.plot(flows, critical, color="black", linewidth=1.0)
        axes.set_title(name, fontsize=10)
        axes.set_ylim(0.0, 0.02)
        label(axes, "q [-]", "k [-]")
        columns |= {f"kind {name} [0 calm; 1 swings; 2 hits]": kind.ravel(), f"top {name} [-]": top.ravel()}
    patches_legend(panels[1])
    remark(page, "line: $k_{crit}$ by linear theory")
    return columns, page


def draw_basin() -> tuple[Columns, Sheet]:
    """Where the loss is hard: which starts end calm, for a chamfered seat above the change, and a Poincare section."""
    z = 1.6 * change(CHAMFERED)
    edge = follow(small(bare(z, CHAMFERED), 0.02), np.array([0.02, 0.06, 0.12, 0.18, 0.24, 0.3]), "damping")[-1]
    s = edge.system._replace(restitution=0.8)
    lifts, speeds = np.linspace(0.0, 2.0, 32), np.linspace(-1.2, 1.2, 32)
    kind = basin(s, lifts, speeds, 600)
    page, (left, right) = sheet(f"Hard loss: chamfered, z = {z:.3f}, k = {s.damping:.5f}", panels=2)
    patches(left, lifts, speeds, kind)
    label(left, "start: lift [steady lifts]", "start: speed [steady lifts per 1/ω]")
    patches_legend(left)
    at = rest(s)
    for push, style, name in ((1.02, "tab:blue", "2 % pushed"), (1.9, "tab:red", "90 % pushed")):
        rows = tops(push * at.lift, 0.0, at.pressure, 0, 400, 1e-8, at.lift, s)
        right.plot(rows[:, 0] / at.lift, rows[:, 1] / at.pressure, ".", color=style, markersize=3, label=name)
    right.plot(1.0, 1.0, "k+", markersize=9, label="equilibrium")
    right.legend(frameon=False, fontsize=8)
    label(right, "top of the lift [steady lifts]", "pressure there [steady]")
    x, v = np.meshgrid(lifts, speeds)
    share = float((kind != 0).mean())
    remark(
        page,
        f"k_crit = {onset(s).damping:.5f}: calm by linear theory; {100 * share:.0f} % of these starts end otherwise",
    )
    return {"lift [-]": x.ravel(), "speed [-]": v.ravel(), "kind [0 calm; 1 swings; 2 hits]": kind.ravel()}, page
