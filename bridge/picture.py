"""One picture of a run: position and reference, pressures, valve, and in real time how late the ticks were."""

from pathlib import Path
from typing import Any

import numpy as np

from bridge.recording.columns import reference_at
from bridge.recording.reader import Recording
from bridge.scenario import Scenario
from controller.sampling import NS

MOST_POINTS = 20_000


def draw(recording: Recording, scenario: Scenario, path: Path) -> Path:
    """Draw a recording to a PNG and return its path."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    state = recording.columns("state")
    thin = slice(None, None, max(1, len(state["stamp"]) // MOST_POINTS))
    timing = recording.columns("timing")
    rows = 4 if len(timing["tick"]) else 3
    figure = Figure(figsize=(10, 2.4 * rows), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, 1, sharex=rows == 3)
    time = state["stamp"][thin] / NS
    _position(axes[0], time, state["position"][thin], reference_at(time, scenario))
    _pressures(axes[1], time, {name: state[name][thin] for name in ("p1", "p_lower", "p_upper")})
    _valve(axes[2], time, state["reference"][thin], state["spool"][thin])
    axes[2].set_xlabel("time [s]")
    for axis in axes[:3]:
        axis.set_xlim(0.0, time[-1])
        axis.grid(alpha=0.3)
    if rows == 4:
        _lateness(axes[3], timing)
    figure.suptitle(scenario.title or scenario.name)
    figure.savefig(path)
    return path


def _position(axis: Any, time: Any, position: Any, reference: Any) -> None:
    if np.isfinite(reference).any():
        axis.plot(time, reference * 1e3, color="0.4", linestyle="--", linewidth=1.2, label="reference")
    axis.plot(time, position * 1e3, color="C0", label="piston")
    axis.set_ylabel("position [mm]")
    axis.legend(loc="best", fontsize="small")


def _pressures(axis: Any, time: Any, pressures: dict[str, Any]) -> None:
    labels = {"p1": "p1 relief valve", "p_lower": "p2 lower chamber", "p_upper": "p3 upper chamber"}
    for name, values in pressures.items():
        axis.plot(time, values / 1e5, linewidth=1.0, label=labels[name])
    axis.set_ylabel("pressure [bar]")
    axis.legend(loc="best", fontsize="small", ncols=3)


def _valve(axis: Any, time: Any, command: Any, spool: Any) -> None:
    axis.plot(time, command, color="0.4", linewidth=0.8, drawstyle="steps-post", label="command")
    axis.plot(time, spool, color="C3", linewidth=1.0, label="spool")
    axis.set_ylabel("valve [of travel]")
    axis.set_ylim(-1.05, 1.05)
    axis.legend(loc="best", fontsize="small", ncols=2)


def _lateness(axis: Any, timing: Any) -> None:
    late = np.maximum(timing["lateness"], 1) / 1e3
    trips = timing["round_trip"][timing["round_trip"] > 0] / 1e3
    edges = np.logspace(-2, 5, 85)
    axis.hist(late, edges, histtype="step", color="C0", label="lateness of the ticks")
    if len(trips):
        axis.hist(trips, edges, histtype="step", color="C1", label="measurement to command")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("wall time [us]")
    axis.set_ylabel("ticks")
    axis.grid(alpha=0.3)
    axis.legend(loc="best", fontsize="small")
