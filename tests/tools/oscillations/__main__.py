"""Try the limit-cycle metric on the labelled set, or on random runs.

`python -m tests.tools.oscillations [--random N --seed S] [--sheets FOLDER]` prints a line for every run whose label is
doubtful or differs from the metric, and the confusion table; exit code 1 for a miss or a false alarm. The runs are
those of the rig of today: run it again when the rig's numbers have changed.
"""

import argparse
import sys
from pathlib import Path

from tests.tools.oscillations.cases import labelled_cases, random_cases
from tests.tools.oscillations.trials import Judged, confusion, judged

COLUMNS = ("limit cycle", "none", "not applicable")


def main() -> int:
    """Run, print, draw."""
    asked = argparse.ArgumentParser(description="Try the limit-cycle metric on runs whose label is measured.")
    asked.add_argument("--random", type=int, default=0, help="So many random runs in place of the set")
    asked.add_argument("--seed", type=int, default=1, help="Of the random runs")
    asked.add_argument("--sheets", type=Path, help="Folder for contact sheets of all runs")
    options = asked.parse_args()
    cases = random_cases(options.random, options.seed) if options.random else labelled_cases()
    runs = []
    for run in judged(cases):
        runs.append(run)
        if run.verdict != "right" or run.label.doubtful:
            print(line(run), flush=True)
    print(table(runs))
    if options.sheets:
        from tests.tools.oscillations.sheets import draw_sheets

        for path in draw_sheets(runs, options.sheets):
            print(path)
    return 1 if any(run.verdict in ("miss", "false alarm") for run in runs) else 0


def line(run: Judged) -> str:
    """A run in one line, lengths in mm peak to peak."""
    parts = " ".join(f"{1e3 * part:.2f}" for part in run.label.parts)
    measured = f"middle third {1e3 * run.label.middle:.2f}, last {1e3 * run.label.last:.2f} ({parts})"
    found = f"{2e3 * run.cycle.amplitude:.2f} at {run.cycle.frequency:.2f} Hz"
    doubt = " doubtful" if run.label.doubtful else ""
    return f"{run.verdict}: {run.case.name}: {run.label.word}{doubt}, {measured}; metric {found}"


def table(runs: list[Judged]) -> str:
    """The confusion table as Markdown."""
    counts = confusion(runs)
    rows = sorted({row for row, _ in counts})
    lines = [f"| {len(runs)} runs | {' | '.join(COLUMNS)} |", "|---|---|---|---|"]
    lines += [f"| {row} | {' | '.join(str(counts.get((row, column), 0)) for column in COLUMNS)} |" for row in rows]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
