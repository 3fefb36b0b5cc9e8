"""A search as a picture: how the best came about, and the runs over what was varied."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bridge.drawing.canvas import Axes, label, remark, sheet
from bridge.errors import writing
from bridge.runs.tune.tune import Found

GOOD, BAD, REST = "#1f6b39", "#a3231f", "0.6"


def write_picture(found: Found, path: Path) -> Path:
    """Progress on the left; on the right the objective over one number, or the runs over the first two."""
    wanted = found.wanted
    page, (progress, over) = sheet(f"tune {wanted.scenario.name}: {wanted.goal.objective.words}", 2)
    trials = found.trials[1:]
    feasible = np.array([wanted.goal.feasible(trial.result) for trial in trials])
    factor = wanted.goal.objective.factor
    objective = np.array([np.nan if (v := t.result["values"][0]) is None else v * factor for t in trials])
    _progress(progress, objective, feasible, wanted.goal.objective.label)
    values = np.array([trial.values for trial in trials])
    if len(wanted.varied) == 1:
        _curve(over, found, values[:, 0], objective, feasible)
    else:
        _places(over, found, values, objective, feasible)
    limits = "; ".join(limit.text for limit in wanted.goal.limits)
    within = f" Within: {limits}." if limits else ""
    remark(page, f"Green: the bands are kept; red crosses: not, or the run failed. Ring: the result.{within}")
    with writing(path):
        page.savefig(path)
    return path


def _progress(axes: Axes, objective: np.ndarray, feasible: np.ndarray, words: str) -> None:
    runs, good = np.arange(1, len(objective) + 1), np.where(feasible, objective, np.nan)
    axes.plot(runs[~feasible], objective[~feasible], "x", color=BAD, markersize=3, alpha=0.5)
    axes.plot(runs[feasible], objective[feasible], ".", color=GOOD, markersize=4)
    axes.step(runs, np.fmin.accumulate(good), where="post", color=GOOD)
    label(axes, "run", words)


def _curve(axes: Axes, found: Found, x: np.ndarray, y: np.ndarray, feasible: np.ndarray) -> None:
    varied, best = found.wanted.varied[0], found.best
    axes.plot(x[~feasible], y[~feasible], "x", color=BAD, markersize=4)
    axes.plot(x[feasible], y[feasible], ".", color=GOOD)
    if (value := best.result["values"][0]) is not None:
        at = value * found.wanted.goal.objective.factor
        axes.plot(best.values[0], at, "o", color=GOOD, fillstyle="none", markersize=10)
    axes.set_xscale("log" if varied.even_ratios else "linear")
    label(axes, varied.label, found.wanted.goal.objective.label)


def _places(axes: Axes, found: Found, at: np.ndarray, objective: np.ndarray, feasible: np.ndarray) -> None:
    first, second = found.wanted.varied[:2]
    axes.plot(at[~feasible, 0], at[~feasible, 1], "x", color=BAD, markersize=4, alpha=0.6)
    if feasible.any():
        dots = axes.scatter(at[feasible, 0], at[feasible, 1], c=objective[feasible], s=14, cmap="viridis")
        axes.figure.colorbar(dots, ax=axes, label=found.wanted.goal.objective.label)
    axes.plot(*found.best.values[:2], "o", color=GOOD, fillstyle="none", markersize=11)
    axes.set_xscale("log" if first.even_ratios else "linear")
    axes.set_yscale("log" if second.even_ratios else "linear")
    label(axes, first.label, second.label)
