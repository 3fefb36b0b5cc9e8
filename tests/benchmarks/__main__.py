"""Print the table of `make bench`; `python -m tests.benchmarks WORD` runs the rows whose section has the word."""

import sys
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.benchmarks import (
    drives,
    environment,
    lines,
    lines_lab,
    loop,
    panel,
    pilot,
    plant,
    recorder,
    relief,
    replay,
    rigs,
    simulated_loops,
    stability,
    start,
    sweeps,
    timing,
    tuning,
    valves,
    view,
)

SECTIONS = {
    "plant": plant.rows,
    "drives": drives.rows,
    "lines": lines.rows,
    "lines_lab": lines_lab.rows,
    "relief": relief.rows,
    "valves": valves.rows,
    "pilot": pilot.rows,
    "loop": loop.rows,
    "timing": timing.rows,
    "rigs": rigs.rigs,
    "rates": rigs.rates,
    "tuning": tuning.rows,
    "recorder": recorder.rows,
    "replay": replay.rows,
    "start": start.rows,
    "view": view.rows,
    "panel": panel.rows,
    "stability": stability.rows,
    "sweeps": sweeps.rows,
    "simulated": simulated_loops.rows,
    "environment": environment.rows,
}


def main() -> None:
    """Run the sections asked for."""
    wanted = sys.argv[1:] or list(SECTIONS)
    table = Table("what", "ours", "beside", "ratio", box=None, pad_edge=False)
    for name in wanted:
        with tempfile.TemporaryDirectory() as folder:
            for row in SECTIONS[name](Path(folder)):
                table.add_row(*row)
    Console(width=120).print(table)


main()
