"""Contact sheets of the labelled set: the last two thirds of the liveliest stretch of each run, to be looked at."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from tests.tools.oscillations.labels import judged
from tests.tools.oscillations.trials import Judged

ROWS, COLUMNS = 5, 5
COLOURS = {"right": "tab:blue", "doubtful": "tab:orange", "miss": "tab:red", "false alarm": "tab:red"}


def draw_sheets(runs: Sequence[Judged], folder: Path) -> list[Path]:
    """One picture for every 25 runs."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, first in enumerate(range(0, len(runs), ROWS * COLUMNS), 1):
        some = runs[first : first + ROWS * COLUMNS]
        figure = Figure(figsize=(22, 16), layout="constrained")
        for axes, run in zip(np.ravel(figure.subplots(ROWS, COLUMNS)), some, strict=False):
            _draw(axes, run)
        paths.append(folder / f"oscillations-{number}.png")
        figure.savefig(paths[-1], dpi=70)
    return paths


def _draw(axes: Any, run: Judged) -> None:
    stretches = judged(run.trace.time, run.reference)
    lively = max(
        stretches, key=lambda s: np.ptp(run.trace.position[s.stop - (s.stop - s.start) // 3 : s.stop]), default=None
    )
    begin, stop = (0, len(run.trace.time)) if lively is None else (lively.start, lively.stop)
    shown = slice(begin + (0 if lively is None else (stop - begin) // 3), stop)
    axes.plot(run.trace.time[shown], 1e3 * run.trace.position[shown], lw=0.6, color=COLOURS[run.verdict])
    parts = " ".join(f"{1e3 * part:.2f}" for part in run.label.parts)
    found = f"{2e3 * run.cycle.amplitude:.2f} mm, {run.cycle.frequency:.1f} Hz"
    mark = "?" if run.label.doubtful else ""
    axes.set_title(
        f"{run.case.name[:70]}\n{run.label.word}{mark} {1e3 * run.label.middle:.2f}, {parts} mm | {found}", fontsize=7
    )
