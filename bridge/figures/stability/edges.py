"""Figures 5.20 and 5.21: the critical gain of the rig over the sampling interval, computed and found on the twin.

Source: 5.4.3. Gains in V per % of the stroke, sampling intervals of 20 ms to 1 s. The thesis looked for the gain at
which its rig began to oscillate and found two: below one it never did, above the other always; between them start and
direction decided. The twin is asked in the same way: held at 100 mm, steps of two sizes up and down. Without delay, and
with one sampling interval of it, as a controller has that puts out a command when the next sample is taken.

The axes of the thesis go to 80 V/% and 1 s. A rig of speed V at a full valve of 10 V loses an integrator's stability at
S = 2/(V t_s) times its scale, 0.1 of the stroke: some 7 V/% at 20 ms and 0.14 at 1 s for ours, so 80 V/% belong to
a tenth of our speed, or to another scale of the signal; the curves of the thesis are lost. Table 5.1 is drawn by its
linear model, scaled by our stroke: without friction its edge is that of an oil spring that nothing damps.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bridge.drawing.canvas import (
    Array,
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from bridge.scenario import Scenario, load
from bridge.studies.stability.edges import edge_points, measured_edges, theory_edges
from bridge.studies.stability.rig_loop import timing_of
from bridge.studies.stability.rig_plant import POINTS, plants
from bridge.studies.sweep.engine import ALL_CORES, Crew
from controller.law import volts_per_percent
from controller.stability import Timing, critical_gain
from controller.stability.actuator.model import TABLE_5_1, dimensionless, omega

SHORTEST, LONGEST = 20e-3, 1.0  # [s]
PLACES = 160  # of the computed edge
INTERVALS = (0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0)  # [s], of the measured one
SIZES = (2e-3, -2e-3, 20e-3, -20e-3)  # [m], of the steps
BLUE, RED, GREY, GREEN = "#2a6fbb", "#c8413b", "#8a8f98", "#3a9150"
COLOURS = {"rest": GREEN, "up": BLUE, "down": RED}
AXES = (
    "Axes of the thesis: 0 to 1 s and 0 to 80 V/%. The gain falls with the piston's speed\nat an open valve: 80 V/% "
    "belong to a rig ten times slower than ours, or to another scale of the signal."
)
NO_DELAY, ONE_SAMPLE = "no delay", "one sample of delay"
WORDS = {"rest": "about rest", "up": "about slow motion up", "down": "about slow motion down"}


def rig(changes: Sequence[str] = ()) -> Scenario:
    """The rig under a proportional controller that jumps the overlap and acts without delay."""
    return load("step", ["loop.delay=0.0", "loop.sample_period=0.1", *changes])


def computed(intervals: Array, scenario: Scenario, late: float = 0.0) -> dict[str, tuple[Array, Array]]:
    """For each point of the rig, critical gains [V/%] and frequencies [Hz] at sampling intervals [s].

    late: the delay in sampling intervals.
    """
    found, timing = plants(scenario), timing_of(scenario)
    rows = [theory_edges(found, timing._replace(period=t, delay=late * t), 0.0) for t in intervals.tolist()]
    return {
        name: (
            np.array([volts(row[name][0], scenario) for row in rows]),
            np.array([row[name][2] for row in rows]),
        )
        for name in POINTS
        if name in found
    }


def of_table(intervals: Array, scenario: Scenario, late: float = 0.0) -> Array:
    """Critical gain [V/%] of the dimensionless model of Table 5.1 at sampling intervals [s]; s = S times its length."""
    actuator = dimensionless(TABLE_5_1)
    found = critical_gain(0.0, actuator.k, actuator.gamma, Timing(intervals * omega(TABLE_5_1), late))
    rig = scenario.rig
    return volts_per_percent(1.0, rig.cylinder.stroke, rig.valve.full_scale) * np.asarray(found) / TABLE_5_1.length


def draw_computed() -> tuple[Columns, Sheet]:
    """Figure 5.20."""
    scenario, intervals = rig(), np.geomspace(SHORTEST, LONGEST, PLACES)
    edges, late = computed(intervals, scenario), computed(intervals, scenario, late=1.0)
    table = {words: of_table(intervals, scenario, delay) for words, delay in ((NO_DELAY, 0.0), (ONE_SAMPLE, 1.0))}
    columns: Columns = {"sampling interval [s]": intervals}
    for ending, found in (("", edges), (f" {ONE_SAMPLE}", late)):
        for name, (gain, frequency) in found.items():
            columns[f"critical gain {WORDS[name]}{ending} [V/%]"] = gain
            columns[f"frequency {WORDS[name]}{ending} [Hz]"] = frequency
    columns |= {f"critical gain of Table 5.1 {words} [V/%]": gain for words, gain in table.items()}
    page, (left, right) = sheet("Critical gain over the sampling interval, computed", 2)
    _draw_theory(left, right, intervals, edges)
    _draw_theory(left, right, intervals, late, late=True)
    for (words, gain), style in zip(table.items(), ("-", ":"), strict=True):
        known = np.where(gain > 0.0, gain, np.nan)  # 0: unstable at every gain
        if np.isfinite(known).any():
            left.plot(intervals, known, style, color=GREY, linewidth=1.0, label=f"model of Table 5.1, {words}")
    left.fill_between(intervals, 0.0, np.min([e[0] for e in edges.values()], axis=0), color=GREEN, alpha=0.1)
    left.text(0.025, 0.1, "stable", color=GREEN)
    _finish(left, right)
    remark(
        page,
        "Linear theory of the rig with hold, without friction: lumped lines, steady relief valve, 120 kg at 100 mm.\n"
        "Dotted: one sampling interval of delay. Between its lines the frictionless model of Table 5.1 (in V per % of\n"
        f"our stroke) is unstable at any gain. {AXES}",
    )
    return columns, page


def measured(
    intervals: Sequence[float],
    scenario: Scenario,
    cases: Sequence[tuple[float, Sequence[float]]],
    part: Path | None = None,
    crew: Crew = ALL_CORES,
) -> list[Columns]:
    """Where the twin never, and where it always oscillates [V/%], and how fast [Hz]; one interval per row.

    cases: a delay in sampling intervals and sizes of steps [m] each. part: file of what an interrupted call had found.
    """
    points = [
        [point for t in intervals for point in edge_points([t], [late * t], sizes, tolerance=0.03)]
        for late, sizes in cases
    ]
    found = iter(measured_edges(scenario, [point for one in points for point in one], "figure 5.21", part, crew))
    return [
        _columns(intervals, [[next(found) for _ in sizes] for _ in intervals], sizes, scenario) for _, sizes in cases
    ]


def _columns(
    intervals: Sequence[float], rows: Sequence[Sequence[Any]], sizes: Sequence[float], scenario: Scenario
) -> Columns:
    """The table of one delay, from the edges of all steps at each interval."""
    stable = [min(_known(edge["stable"]) for edge in row) for row in rows]
    unstable = [max(_known(edge["unstable"]) for edge in row) for row in rows]
    columns: Columns = {
        "sampling interval [s]": np.array(intervals),
        "never oscillates below [V/%]": np.array([volts(g, scenario) for g in stable]),
        "always oscillates above [V/%]": np.array([volts(g, scenario) for g in unstable]),
    }
    for i, size in enumerate(sizes):
        name = f"step of {size * 1e3:+g} mm"
        columns[f"{name}: critical gain [V/%]"] = np.array(
            [volts(np.sqrt(_known(row[i]["stable"]) * _known(row[i]["unstable"])), scenario) for row in rows]
        )
        columns[f"{name}: frequency [Hz]"] = np.array([_known(row[i]["frequency"]) for row in rows])
    return columns


def draw_measured(part: Path | None = None) -> tuple[Columns, Sheet]:
    """Figure 5.21."""
    scenario = rig()
    columns, late = measured(INTERVALS, scenario, ((0.0, SIZES), (1.0, SIZES[:2])), part)
    times, low, high = list(columns.values())[:3]
    page, (left, right) = sheet("Critical gain over the sampling interval, found on the twin", 2)
    smooth = np.geomspace(SHORTEST, LONGEST, PLACES // 4)
    _draw_theory(left, right, smooth, computed(smooth, scenario), faint=True)
    left.fill_between(times, low, high, color=GREY, alpha=0.35, label="undecided: start and direction decide")
    left.plot(times, low, "o-", color=BLUE, markersize=4, label="never oscillates below")
    left.plot(times, high, "o-", color=RED, markersize=4, label="always oscillates above")
    for words, colour in (("never oscillates below", BLUE), ("always oscillates above", RED)):
        left.plot(times, late[f"{words} [V/%]"], "s:", color=colour, markersize=3, label=f"{words}, {ONE_SAMPLE}")
    for size, marker in zip(SIZES, "^v<>", strict=True):
        name = f"step of {size * 1e3:+g} mm"
        share = 2.0 * times * columns[f"{name}: frequency [Hz]"]
        share = np.where(share > 0.0, share, np.nan)  # too irregular to have one
        right.plot(times, share, marker, color="0.25", markersize=5, fillstyle="none", label=f"twin, {name}")
    _finish(left, right)
    remark(
        page,
        "Full twin, overlap jumped; thin lines: linear theory. Steps of 2 and 20 mm up and down; with the delay 2 mm.\n"
        f"{AXES}",
    )
    later = {name.replace(" [", f" {ONE_SAMPLE} ["): values for name, values in list(late.items())[1:]}
    return columns | later, page


def _draw_theory(
    left: Any, right: Any, times: Array, edges: dict[str, tuple[Array, Array]], faint: bool = False, late: bool = False
) -> None:
    style: dict[str, Any] = {"linewidth": 0.9, "linestyle": "--", "alpha": 0.8} if faint else {"linewidth": 1.6}
    style |= {"linestyle": ":"} if late else {}
    for name, (gain, frequency) in edges.items():
        words = "" if late else f"theory {WORDS[name]}" if faint else WORDS[name]
        left.plot(times, gain, color=COLOURS[name], label=words or None, **style)
        right.plot(times, 2.0 * times * frequency, color=COLOURS[name], **style)


def _finish(left: Any, right: Any) -> None:
    label(left, "sampling interval t_s [s]", "proportional gain S [V/%]")
    label(right, "sampling interval t_s [s]", "frequency / half the sampling frequency")
    for axes in (left, right):
        axes.set(xscale="log", xlim=(0.95 * SHORTEST, 1.05 * LONGEST))
        axes.set_xticks([0.02, 0.05, 0.1, 0.2, 0.5, 1.0], labels=["0.02", "0.05", "0.1", "0.2", "0.5", "1"])
        axes.minorticks_off()
    left.set_yscale("log")
    left.set_ylim(0.02, 12.0)
    left.set_yticks([0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10], labels=["0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10"])
    right.set_ylim(0.0, 1.1)
    left.legend(fontsize=8, frameon=False)
    if right.get_legend_handles_labels()[0]:
        right.legend(fontsize=8, frameon=False, loc="lower right")


def _known(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def volts(gain: float, scenario: Scenario) -> float:
    """A gain [1/m] in V/%."""
    return volts_per_percent(float(gain), scenario.rig.cylinder.stroke, scenario.rig.valve.full_scale)
