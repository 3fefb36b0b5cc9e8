"""Why the twin's edge of stability is not that of its linear theory: one cause at a time, and all of them.

Not in the thesis, which names the causes only. Each case has its own rig and so its own theory, at the point where it
rests, or between slow motion up and down without a leak. Left over the sampling interval, right over the delay.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bridge.drawing.canvas import (
    Columns,
    Sheet,
    label,
    remark,
    sheet,
)
from bridge.figures.stability.edges import rig
from bridge.studies.stability.edges import cases_of_causes, edge_points, measured_edges
from bridge.studies.sweep.engine import ALL_CORES, Crew
from controller.law import volts_per_percent

INTERVALS = (0.02, 0.05, 0.1, 0.2, 0.4)  # [s], without delay
DELAYS = (0.0, 0.03, 0.06, 0.1, 0.15)  # [s], at 100 ms
INTERVAL = 0.1  # [s], of the delays
SIZE = 2e-3  # [m]
SHOWN = {
    "none": "o",
    "leak": "s",
    "friction": "v",
    "overlap": "^",
    "dead band": ">",
    "areas": "D",
    "waves": "P",
    "all": "*",
}


def causes(
    places: Sequence[tuple[float, float]],
    cases: dict[str, list[str]],
    size: float = SIZE,
    part: Path | None = None,
    crew: Crew = ALL_CORES,
) -> Columns:
    """Critical gains [V/%] and frequencies [Hz], twin and theory, of each case at places (interval, delay) [s].

    part: file of what an interrupted call had found.
    """
    scenario = rig()
    found: Columns = {
        "sampling interval [s]": np.array([interval for interval, _ in places]),
        "delay [s]": np.array([delay for _, delay in places]),
    }
    points = [
        point
        for case in cases.values()
        for interval, delay in places
        for point in edge_points([interval], [delay], [size], [case], 0.03)
    ]
    edges = iter(measured_edges(scenario, points, "causes", part, crew))
    for name in cases:
        rows = [next(edges) for _ in places]
        columns = zip(*(_numbers(row) for row in rows), strict=True)
        heads = ("twin [V/%]", "theory [V/%]", "twin [Hz]", "theory [Hz]")
        found |= {f"{name}: {head}": np.array(column) for head, column in zip(heads, columns, strict=True)}
    return found


def _numbers(edge: dict[str, Any]) -> tuple[float, float, float, float]:
    """Twin and theory: gains [V/%], frequencies [Hz]; NaN where the twin did not oscillate."""
    theory = edge["theory"]
    expected = [theory["rest"]] if "rest" in theory else [theory["up"], theory["down"]]
    gain = len(expected) / sum(1.0 / entry[0] for entry in expected)  # of the mean of the valve's two gains
    known = edge["stable"] is not None
    critical = np.sqrt(edge["stable"] * edge["unstable"]) if known else np.nan
    frequency = edge["frequency"] if known else np.nan
    return volts_per_percent(critical, 0.27, 10.0), volts_per_percent(gain, 0.27, 10.0), frequency, expected[0][2]


def draw_causes(part: Path | None = None) -> tuple[Columns, Sheet]:
    """The figure."""
    cases = cases_of_causes()
    places = [(interval, 0.0) for interval in INTERVALS] + [(INTERVAL, delay) for delay in DELAYS[1:]]
    columns = causes(places, cases, part=part)
    page, (left, right) = sheet("Critical gain of the twin over that of its own linear theory, by cause", 2)
    over = range(len(INTERVALS))
    late = [places.index((INTERVAL, delay)) for delay in DELAYS]
    for i, name in enumerate(cases):
        ratio = columns[f"{name}: twin [V/%]"] / columns[f"{name}: theory [V/%]"]
        style: dict[str, Any] = {
            "linewidth": 1.8 if name in ("none", "all") else 1.0,
            "color": "k" if name == "all" else f"C{i % 10}",
        }
        mark = SHOWN.get(name, ".")
        left.plot(INTERVALS, ratio[list(over)], marker=mark, label=_words(name), **style)
        right.plot([d * 1e3 for d in DELAYS], ratio[late], marker=mark, **style)
    label(left, "sampling interval [s], no delay", "critical gain, twin over theory")
    label(right, f"delay [ms], sampled every {INTERVAL * 1e3:g} ms", "")
    left.set_xscale("log")
    left.set_xticks(INTERVALS, labels=[f"{t:g}" for t in INTERVALS])
    left.minorticks_off()
    for axes in (left, right):
        axes.axhline(1.0, color="0.5", linewidth=0.8)
        axes.set(yscale="log", ylim=(0.03, 15.0))
        axes.set_yticks([0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10], labels=["0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10"])
        axes.minorticks_off()
    left.legend(fontsize=7, frameon=False, ncols=2, loc="lower right")
    remark(
        page,
        f"Steps of {SIZE * 1e3:g} mm. 1 is the theory about rest, or between up and down where nothing leaks.",
    )
    return {name: np.nan_to_num(column) for name, column in columns.items()}, page


def _words(name: str) -> str:
    return {"none": "none of the causes", "all": "all", "overlap": "overlap, jumped"}.get(name, f"{name} alone")
