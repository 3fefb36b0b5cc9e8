"""The verb campaign."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, SCHEDULER, WORKERS, there
from bridge.cli.outputs import own_folder, print_json
from bridge.cli.streams import said_when_interrupted
from bridge.cli.sweep import continuation

if TYPE_CHECKING:
    from bridge.runs.campaign.campaign import Found, Pace
    from bridge.runs.campaign.matrix import Matrix, Run

CAMPAIGN = Annotated[Path, typer.Argument(metavar="FILE", help="A campaign, .toml: docs/campaigns.md.")]
SHRINK = Annotated[
    list[str] | None,
    typer.Option(
        "--shrink", metavar="FAULT.NUMBER", help="Find the smallest that breaks a band: push.timeline.1.to. Repeatable."
    ),
]
FOLDER = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Folder of the files. [default: runs/campaign-TIME]", show_default=False),
]
LIST = Annotated[bool, typer.Option("--list", help="Print the runs, and run nothing.")]
MOST_ROWS = 20  # of one table on a terminal


def campaign(
    file: CAMPAIGN,
    shrink: SHRINK = None,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: FOLDER = None,
    listed: LIST = False,
    as_json: AS_JSON = False,
) -> None:
    """Run a matrix of scenarios, faults, parameters and seeds, and judge every run by its bands.

    Leaves a page of what failed, worst first (.html), all runs (.csv) and JUnit XML (.xml). An interrupted campaign
    continues with the same command and -o FOLDER. Exit code 1: fewer runs passed than the file accepts, which is all
    if it does not say. See docs/campaigns.md.
    """
    there(file)
    from bridge.runs.campaign.file import read_campaign

    read = read_campaign(file)
    from bridge.runs.campaign.margins import margin_axes
    from bridge.runs.campaign.matrix import matrix_of, refuse, runs_of
    from bridge.runs.campaign.shrink import wishes_of

    matrix = matrix_of(read)
    wishes = wishes_of([*read.shrink, *(shrink or [])], matrix)
    margin_axes(matrix)
    runs = runs_of(matrix)
    refuse(matrix, runs)
    if listed:
        _list(matrix, runs)
        return
    folder = output or own_folder("campaign")
    try:
        found = _ran(matrix, runs, wishes, folder, workers, scheduler, as_json)
    finally:
        if output is None:
            with suppress(OSError):
                folder.rmdir()  # where nothing was found
    raise typer.Exit(not found.accepted)


def _ran(
    matrix: "Matrix",
    runs: "list[Run]",
    wishes: list[Any],
    folder: Path,
    workers: int,
    scheduler: str | None,
    as_json: bool,
) -> "Found":
    """Run, and write what was found before what an interruption would leave is removed."""
    from bridge.runs.campaign.campaign import PART, Pace, Watch, rounds_of, run_campaign
    from bridge.studies.sweep.crew import cores
    from bridge.studies.sweep.engine import Crew

    watch = Watch()
    with (
        said_when_interrupted(continuation(folder, folder / PART)),
        rounds_of(matrix, folder, Crew(workers, scheduler), len(runs)) as ask,
    ):
        found = run_campaign(matrix, runs, wishes, ask)
        pace = Pace(ask.computed, watch.seconds, workers or cores())
        files = _write(found, folder)
    if as_json:
        from bridge.runs.campaign.table import plain

        print_json(plain(found) | {"files": [str(path) for path in files]})
    else:
        _print(found, pace, files)
    return found


def _write(found: "Found", folder: Path) -> list[Path]:
    from bridge.errors import writing
    from bridge.report.campaign import write_page
    from bridge.runs.campaign.table import junit, write_csv, write_margins

    files = [write_page(found, folder / "campaign.html"), write_csv(found, folder / "campaign.csv")]
    if found.margins:
        files.append(write_margins(found, folder / "margins.csv"))
    with writing(folder / "campaign.xml") as path:
        path.write_text(junit(found), encoding="utf-8")
    return [*files, folder / "campaign.xml"]


def _list(matrix: "Matrix", runs: "list[Run]") -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.campaign.matrix import counted

    names = [axis.name for axis in matrix.parameters] + [draw.place for draw in matrix.file.draws]
    rows = [[str(r.number), r.scenario, r.fault, *r.parameters, *r.drawn, str(r.seed)] for r in runs]
    print_table(["run", "scenario", "fault", *names, "seed"], rows)
    print(f"{len(runs)} runs: {counted(matrix)[1]}")


def _print(found: "Found", pace: "Pace", files: list[Path]) -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.campaign.table import cells_of, margin_words, name_of, quantile_words

    matrix = found.matrix
    print_table(["passed", *matrix.scenarios], _overview(found))
    if found.failures:
        print("\nwhat failed, worst first")
        rows = [
            [str(f.worst.run.number), name_of(found, f.worst.run), f.worst.broken[0], f"{len(f.runs)} of {f.of}"]
            for f in found.failures[:MOST_ROWS]
        ]
        print_table(("run", "worst of its kind", "not kept", "runs"), rows)
        _cut(len(found.failures))
    cells = cells_of(found)
    if any(cell.share.runs > 1 for cell in cells):
        print("\nshares of passed runs, and medians; in brackets intervals of 95 %")
        heads = [
            "scenario",
            "fault",
            *(a.name for a in matrix.parameters),
            "passed",
            *(m.label for m in matrix.measures),
        ]
        rows = []
        for cell in cells[:MOST_ROWS]:
            pairs = zip(cell.quantiles, matrix.measures, strict=True)
            shown = ["-" if own is None else quantile_words(own[len(own) // 2], m) for own, m in pairs]
            rows.append([cell.scenario, cell.fault, *cell.parameters, cell.share.words, *shown])
        print_table(heads, rows)
        _cut(len(cells))
    for margin in found.margins:
        print(f"\nmargin: {margin_words(margin)}", end="")
    print("\n" * bool(found.margins), end="")
    for one in found.shrunk:
        own = ", ".join((one.scenario, *filter(None, one.parameters)))
        print(f"\nshrunk: {one.wish.words}, {own}: {one.words}", end="")
    print("\n" * bool(found.shrunk))
    print(f"{found.passed} of {len(found.runs)} runs passed: {'accepted' if found.accepted else 'NOT ACCEPTED'}")
    print(pace.words)
    print("\n".join(map(str, files)))


def _cut(number: int) -> None:
    if number > MOST_ROWS:
        print(f"... {number - MOST_ROWS} more on the page")


def _overview(found: "Found") -> list[list[Any]]:
    """Faults by scenarios: how many runs passed."""
    from rich.text import Text

    rows = []
    for fault in found.matrix.file.faults:
        row: list[Any] = [fault.name]
        for scenario in found.matrix.scenarios:
            own = [one.passed for one in found.runs if (one.run.scenario, one.run.fault) == (scenario, fault.name)]
            words = f"{sum(own)}/{len(own)}" if own else "-"
            row.append(Text(words, "green" if own and all(own) else "red" if own else ""))
        rows.append(row)
    return rows
