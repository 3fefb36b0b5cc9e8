"""The verb sweep."""

import shlex
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCENARIO, SCHEDULER, WORKERS
from bridge.cli.outputs import own_folder, print_json
from bridge.cli.streams import said_when_interrupted
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.runs.sweep.sweep import Found, Wanted
    from bridge.runs.sweep.theory import TheoryEdge

AXES = Annotated[
    list[str],
    typer.Argument(
        metavar="NAME=VALUES...",
        help="What is varied: controller.gain=0.5:4:8 (FROM:TO:COUNT, or ...:log), loop.delay='0 ms,10 ms'.",
    ),
]
METRICS = Annotated[
    list[str] | None,
    typer.Option("--metrics", "-m", help="What bands can name: 'peak p_lower, overshoot'. [default: rms error]"),
]
JUDGE = Annotated[bool, typer.Option("--judge", help="Also say whether each run keeps the scenario's own bands.")]
KEEP = Annotated[bool, typer.Option("--keep", help="Keep the recordings, in the folder recordings.")]
FOLDER = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Folder of the files. [default: runs/sweep-TIME]", show_default=False),
]
USUAL = ["rms error"]
MOST_ROWS = 40  # that a terminal shows
MARK = " *"


def sweep(
    scenario: SCENARIO,
    axes: AXES,
    metrics: METRICS = None,
    changes: CHANGES = None,
    judge: JUDGE = False,
    keep: KEEP = False,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: FOLDER = None,
    as_json: AS_JSON = False,
) -> None:
    """Run a scenario at every combination of some of its values: a table, CSV and a picture.

    All runs take place without a clock, on all cores. The smallest value of each metric is marked. A run that fails
    has no values but a reason, and does not stop the others. An interrupted sweep continues with the same command and
    -o FOLDER. See docs/sweeps.md.
    """
    from bridge.runs.sweep.axes import axes_of
    from bridge.scenario import load
    from bridge.scenario.measures import measures_of, refuse_outside

    loaded = load(scenario, changes)
    asked = measures_of(metrics or USUAL)
    along = axes_of(axes, loaded)
    refuse_set_twice([axis.name for axis in along], changes)
    if all(axis.name != "duration" for axis in along):
        refuse_outside(asked, loaded)
    from bridge.runs.sweep.sweep import Wanted, refuse

    wanted = Wanted(loaded, along, asked, judge, keep)
    refuse(wanted)
    folder = output or own_folder("sweep")
    try:
        found = _swept(wanted, folder, workers, scheduler)
    finally:
        if output is None:
            with suppress(OSError):
                folder.rmdir()  # where nothing was found
    _write_and_show(found, folder, as_json)
    raise typer.Exit(found.ran == 0)


def refuse_set_twice(names: list[str], changes: list[str] | None) -> None:
    """Raises UsageError for a value that is to be varied and set."""
    for change in changes or []:
        if (name := change.partition("=")[0].strip()) in names:
            raise UsageError(f"--set {change}: {name} is varied; leave one of the two out")


def _swept(wanted: "Wanted", folder: Path, workers: int, scheduler: str | None) -> "Found":
    from bridge.runs.sweep.sweep import part_of, run_sweep
    from bridge.studies.sweep.engine import Crew

    with said_when_interrupted(continuation(folder, part_of(folder))):
        return run_sweep(wanted, folder, Crew(workers, scheduler))


def continuation(output: Path, part: Path) -> Callable[[], str]:
    """What is said when somebody interrupts: how much is kept, and how to continue.

    Where nothing is kept the folder that the call has made for itself goes.
    """

    def words() -> str:
        done = max(0, part.read_bytes().count(b"\n") - 1) if part.is_file() else 0
        command = [word for word in sys.argv[1:] if not word.startswith("--output=")]
        own = any(word in ("-o", "--output") or word.startswith(("-o", "--output=")) for word in sys.argv[1:])
        where = [] if own else ["-o", str(output)]
        again = shlex.join(["hydrotwin", *(sys.argv[1:] if own else command), *where])
        if not done:
            with suppress(OSError):
                if not own:
                    (output if output.is_dir() else output.parent).rmdir()
            return "interrupted; nothing is kept"
        return f"interrupted; {done} run{'s' * (done != 1)} kept in {part}; to continue: {again}"

    return words


def _write_and_show(found: "Found", folder: Path, as_json: bool) -> None:
    from bridge.runs.sweep.drawing import TOO_MANY, can_draw, write_picture
    from bridge.runs.sweep.table import plain, write_csv
    from bridge.runs.sweep.theory import theory_edge

    edge = theory_edge(found.wanted)
    files = [write_csv(found, folder / "sweep.csv")]
    drawn = can_draw(found.wanted.axes)
    if drawn:
        files.append(write_picture(found, edge, folder / "sweep.png"))
    if as_json:
        theory = edge and edge._asdict()
        print_json(plain(found) | {"theory": theory, "files": [str(path) for path in files]})
        return
    _print(found, edge)
    print("\n".join([*([] if drawn else [TOO_MANY]), *map(str, files)]))


def _print(found: "Found", edge: "TheoryEdge | None") -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.sweep.table import headers

    asked = found.wanted.measures
    best = [found.best(column) for column in range(len(asked))]
    shown = range(len(found.rows))
    if len(found.rows) > MOST_ROWS:
        shown = sorted({index for index in best if index is not None})
    heads = headers(found)
    reasons = any(found.rows[index].reason for index in shown)
    print_table(heads if reasons else heads[:-1], [_row(found, index, best, reasons) for index in shown])
    print("* the smallest of its column")
    if len(shown) < len(found.rows):
        print(f"These {len(shown)} of {len(found.rows)} runs are the best; sweep.csv has all.")
    if failed := len(found.rows) - found.ran:
        print(f"{failed} of {len(found.rows)} runs failed; {_first_reason(found)}")
    for column, one in enumerate(asked):
        if found.ran and best[column] is None:
            print(f"{one.words} has no value: {one.why_undefined}")
    if edge is not None and not edge.places and edge.gains[0] == edge.gains[0]:
        print(f"{edge.words}: {edge.gains[0]:.4g} {found.wanted.axes[edge.gain].unit}")


def _first_reason(found: "Found") -> str:
    return "the first: " + next(row.reason for row in found.rows if row.reason)


def _row(found: "Found", index: int, best: list[int | None], reasons: bool) -> list[str]:
    from bridge.runs.sweep.sweep import KEPT_NAME
    from bridge.runs.sweep.table import axis_cells, judgement

    wanted, row = found.wanted, found.rows[index]
    cells = axis_cells(found, row)
    for column, (asked, value) in enumerate(zip(wanted.measures, row.values, strict=True)):
        shown = "-" if value is None else f"{value * asked.factor:.4g}"
        cells.append(shown + MARK if best[column] == index else shown)
    cells += [judgement(row), "; ".join(row.failed)] if wanted.judge else []
    cells += [KEPT_NAME.format(index + 1)] if wanted.keep else []
    return [*cells, row.reason] if reasons else cells
