"""Figures 5.7 to 5.19: where the sampled actuator is stable, over the sampling interval and the proportional gain.

Source: 5.4.3. The dimensionless actuator, linear about its middle, sampled and held without delay, gamma 0.23; alpha
(0.0043 there, 0.00467 in 5.7) drops out. 5.7 is the closed curves alone, d = 1, k = 0. 5.8 to 5.13 have d = 0 and
rising damping k, 5.14 to 5.19 have k = 0 and rising derivative gain d; each cell is coloured by how many of the three
multipliers are stable. `areas` is how much of each chart has 0, 1, 2 and 3.
"""

from textwrap import fill
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from bridge.figures.stability.damped import CHARTS, Damped
from bridge.scenario import load
from bridge.studies.stability.chart_drawing import COLOURS, GOOD, WIDE
from bridge.studies.stability.equivalent import scaled
from bridge.studies.stability.mark import draw_mark, mark_words
from controller.stability import Timing, linear_actuator, sampled_loop
from controller.stability.actuator.analogue import analogue_edge
from controller.stability.chart import Counts, stable_multipliers
from controller.stability.curves import flip_curve, flip_gain, fold_intervals, neimark_sacker_curve, pair_gains

GAMMA = 0.23
LONGEST, HIGHEST = 20.0, 5.0  # tau, s
CELLS = 200  # a side; numbers are those of their middles
FINE = 4000  # places along a curve
NEAR = 1e-3  # relative step in s and in tau to either side of a curve, to see whether stability ends there
JUMP, HALVINGS = 0.01 * HIGHEST, 14  # in s between neighbours on a damped curve, and how often their gap is halved
FLIP, PAIR, FOLD = "#b3261e", "#1f4e9c", "0.35"
CURVES = Damped(0.0, 1.0)  # of 5.7


def middles(top: float) -> Array:
    """Middles of the cells from 0 to the top of an axis."""
    return (np.arange(CELLS) + 0.5) * top / CELLS


def counts(of: Damped) -> Counts:
    """Stable multipliers of each cell, (s, tau)."""
    return stable_multipliers(middles(HIGHEST)[:, None], of.d, of.k, GAMMA, Timing(middles(LONGEST)))


def shares(of: Damped) -> Array:
    """Shares of the chart's area with 0, 1, 2, 3 stable multipliers."""
    return np.bincount(counts(of).ravel(), minlength=4) / CELLS**2


def flips(tau: Array, of: Damped) -> Array:
    """s at which a multiplier is -1: closed without damping, of the matrix at -1 with it."""
    if of.k == 0.0:
        return flip_curve(tau, GAMMA)
    plant = linear_actuator(of.k, GAMMA)
    return np.array([flip_gain(sampled_loop(plant, Timing(t)), of.d) for t in tau.tolist()])


def pairs(tau: Array, of: Damped) -> list[Array]:
    """s at which a pair of multipliers is on the circle: closed without damping, of the loop's cubic with it."""
    if of.k == 0.0:
        return [neimark_sacker_curve(tau, of.d, GAMMA)] if of.d > 0.0 else []
    plant = linear_actuator(of.k, GAMMA)
    return list(np.array([pair_gains(sampled_loop(plant, Timing(t)), of.d) for t in tau.tolist()]).T)


def damped_curves(of: Damped) -> tuple[Array, Array, list[Array]]:
    """tau, flip curve and pair curves of a damped loop, closer together where they are steep, begin or end."""
    tau = (np.arange(FINE // 8) + 0.5) * LONGEST / (FINE // 8)
    rows = np.array([flips(tau, of), *pairs(tau, of)])
    for _ in range(HALVINGS):
        new = 0.5 * (tau[1:] + tau[:-1])[_apart(rows)]
        if not new.size:
            break
        order = np.argsort(np.append(tau, new))
        found = np.array([flips(new, of), *pairs(new, of)])
        tau, rows = np.append(tau, new)[order], np.append(rows, found, axis=1)[:, order]
    return tau, rows[0], list(rows[1:])


def _apart(rows: Array) -> NDArray[np.bool_]:
    """Between which neighbours a curve in view begins, ends or jumps."""
    seen = (rows > 0.0) & (rows < 1.02 * HIGHEST)
    either, jump = seen[:, 1:] | seen[:, :-1], np.abs(np.diff(np.nan_to_num(rows, nan=-HIGHEST, posinf=99.0), axis=1))
    return np.asarray((either & (jump > JUMP)).any(axis=0))


def edges(tau: Array, curve: Array, of: Damped) -> NDArray[np.bool_]:
    """Where stability ends on a curve s(tau): one side has three stable multipliers and the other fewer."""
    out = np.zeros(len(tau), bool)
    at = np.flatnonzero((curve > 0.0) & (curve < 1.1 * HIGHEST))
    steps = ((1.0, 1.0 - NEAR), (1.0, 1.0 + NEAR), (1.0 - NEAR, 1.0), (1.0 + NEAR, 1.0))
    stable = [
        stable_multipliers(curve[at] * up, of.d, of.k, GAMMA, Timing(tau[at] * across)) == 3 for across, up in steps
    ]
    out[at] = np.any(stable, axis=0) & ~np.all(stable, axis=0)
    return out


def draw_chart(number: str) -> tuple[Columns, Sheet]:
    """One of CHARTS."""
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    of = CHARTS[number]
    found, tau, s = counts(of), middles(LONGEST), middles(HIGHEST)
    page, (axes,) = sheet(f"Stable multipliers of the sampled loop, k = {of.k:g}, d = {of.d:g}")
    norm = BoundaryNorm(np.arange(5) - 0.5, 4)
    colours = ListedColormap(COLOURS[3::-1])
    axes.imshow(found, cmap=colours, norm=norm, origin="lower", aspect="auto", extent=(0, LONGEST, 0, HIGHEST))
    keys: list[Any] = [
        Patch(color=COLOURS[3 - n], label=f"{n} stable{'' if n < 3 else ': the loop is'}, {share:.1%} of the area")
        for n, share in reversed(list(enumerate(shares(of))))
        if share > 0.0
    ]
    keys += _draw_curves(axes, of)
    keys += _draw_limit(axes, of)
    _finish(axes, keys)
    remark(page, f"Linear theory: gamma = {GAMMA:g}, hold, no delay. Curves that do not bound stability are thin.")
    across, up = np.meshgrid(tau, s)
    return {"tau [-]": across.ravel(), "s [-]": up.ravel(), "stable multipliers [-]": found.ravel().astype(float)}, page


def draw_curves() -> tuple[Columns, Sheet]:
    """Figure 5.7; in the table s = 0 where a curve has none above."""
    tau = (np.arange(FINE) + 0.5) * LONGEST / FINE
    flip, pair = flips(tau, CURVES), neimark_sacker_curve(tau, CURVES.d, GAMMA)
    page, (axes,) = sheet(f"Closed curves of the sampled loop, k = {CURVES.k:g}, d = {CURVES.d:g}")
    keys = _draw_curves(axes, CURVES)
    stable = counts(CURVES) == 3
    axes.contourf(middles(LONGEST), middles(HIGHEST), stable, levels=[0.5, 1.5], colors=[COLOURS[0]])
    for x, y in ((4.1, 1.6), (8.6, 0.9), (13.2, 0.6)):
        axes.text(x, y, "stable", color=GOOD, fontsize=9, ha="center")
    _finish(axes, keys)
    remark(page, f"Linear theory: gamma = {GAMMA:g}, hold, no delay. Shaded: three stable multipliers.")
    columns: Columns = {"tau [-]": tau}
    for name, curve in (("flip", flip), ("Neimark-Sacker", pair)):
        columns[f"{name} s [-]"] = np.nan_to_num(curve)
        columns[f"{name} bounds stability [0 or 1]"] = edges(tau, curve, CURVES).astype(float)
    return columns, page


def add_mark(page: Sheet, number: str, name: str) -> None:
    """Mark the rig of a scenario on a chart that is drawn."""
    marked, of, (axes, *_) = scaled(load(name)), CHARTS.get(number, CURVES), page.axes
    numbers = {"gamma": GAMMA, "delay": 0.0, "derivative": of.d, "damping": of.k}
    words = mark_words(marked, "period", "gain", ((0.0, LONGEST), (0.0, HIGHEST)), numbers)
    legend = axes.get_legend()
    keys = [*legend.legend_handles, draw_mark(axes, marked, "period", "gain")] if legend else []
    _finish(axes, keys)
    remark(page, f"{page.get_supxlabel()}\n{fill(words, WIDE)}.")


def _draw_curves(axes: Any, of: Damped) -> list[Any]:
    """Curves of the closed forms, strong where stability ends on them; their keys."""
    tau = (np.arange(FINE) + 0.5) * LONGEST / FINE
    at, flip, pair = (tau, flips(tau, of), pairs(tau, of)) if of.k == 0.0 else damped_curves(of)
    curves = [("flip, mu = -1", FLIP, flip), *(("Neimark-Sacker, a pair of size 1", PAIR, curve) for curve in pair)]
    keys: dict[str, Any] = {}
    for name, colour, curve in curves:
        seen = np.where((curve > 0.0) & (curve < 1.02 * HIGHEST), curve, np.nan)
        axes.plot(at, seen, color=colour, linewidth=0.6, alpha=0.7)
        strong = axes.plot(at, np.where(edges(at, seen, of), seen, np.nan), color=colour, linewidth=1.8, label=name)
        keys |= {name: strong[0]} if np.isfinite(seen).any() else {}
    return [*keys.values()] + (_draw_intervals(axes, of) if of.k == 0.0 else [])


def _draw_intervals(axes: Any, of: Damped) -> list[Any]:
    """Sampling intervals at which multipliers are on the circle whatever s."""
    whole = fold_intervals(LONGEST)
    rows = [("fold, mu = 1: whole periods of the oil spring", FOLD, whole)]
    if of.d == 0.0:
        rows.append(("a pair of size 1: half periods", PAIR, np.append(whole, whole[-1] + whole[0]) - 0.5 * whole[0]))
    keys = []
    for name, colour, intervals in rows:
        lines = [axes.axvline(t, color=colour, linewidth=0.9, linestyle=":") for t in intervals if t < LONGEST]
        lines[0].set_label(name)
        keys.append(lines[0])
    return keys


def _draw_limit(axes: Any, of: Damped) -> list[Any]:
    """Where the edge of the loop without sampling meets tau = 0."""
    edge = float(analogue_edge(of.d, of.k, GAMMA))
    if not 0.0 < edge < HIGHEST:
        return []
    words = f"analogue edge k (d + sqrt2/gamma) = {edge:.4g}"
    return axes.plot([0.0], [edge], "k>", markersize=7, clip_on=False, linestyle="", label=words)


def _finish(axes: Any, keys: list[Any]) -> None:
    label(axes, "sampling interval tau", "proportional gain s")
    axes.set(xlim=(0.0, LONGEST), ylim=(0.0, HIGHEST))
    axes.legend(handles=keys, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def draw_areas() -> tuple[Columns, Sheet]:
    """Areas of all charts."""
    table = np.array([shares(of) for of in CHARTS.values()])
    page, (axes,) = sheet("Area of the charts by number of stable multipliers")
    names = [f"{number}\nk {of.k:g}\nd {of.d:g}" for number, of in CHARTS.items()]
    left = np.zeros(len(table))
    for n in (3, 2, 1, 0):
        axes.bar(names, 100.0 * table[:, n], bottom=left, color=COLOURS[3 - n], label=f"{n} stable", width=0.75)
        left = left + 100.0 * table[:, n]
    for i, share in enumerate(table[:, 3]):
        axes.text(i, 1.0, f"{share:.1%}", ha="center", fontsize=8, color=GOOD)
    label(axes, "", "share of the area [%]")
    axes.tick_params(axis="x", labelsize=8)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    remark(page, f"tau from 0 to {LONGEST:g}, s from 0 to {HIGHEST:g}, {CELLS} x {CELLS} cells, gamma = {GAMMA:g}.")
    columns: Columns = dict(zip(("k [-]", "d [-]"), np.array(list(CHARTS.values())).T, strict=True))
    return columns | {f"{n} stable [-]": table[:, n] for n in range(4)}, page
