"""The verb import: a log of others made into a recording."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import AS_JSON, there
from bridge.cli.outputs import print_json
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.recording.logs.importing import Made


def import_log(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="A log: CSV (also .gz), MATLAB, Parquet, MDF, MCAP, or a rosbag2.")
    ],
    map_path: Annotated[
        Path | None, typer.Option("--map", help="Map, .toml: which column is which signal.", show_default=False)
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Recording to write. [default: LOG.mcap, here]", show_default=False),
    ] = None,
    guess: Annotated[
        bool,
        typer.Option("--guess", help="Print a map to edit: names, units and ranges of the log, and how sure each is."),
    ] = False,
    rig: Annotated[str, typer.Option(help="Scenario whose drive the guessed map is for.")] = "ehla",
    as_json: AS_JSON = False,
) -> None:
    """Import a log that another program has measured on a rig: a recording that every verb takes.

    The map names the drive, and of each signal its column, unit, sign and method; docs/import.md describes it. What is
    missing in the log stays missing.
    """
    there(log)
    if guess:
        _guess(log, rig, as_json)
        return
    if map_path is None:
        raise UsageError(f"{log}: --map MAP.toml says which column is which signal; --guess proposes such a map")
    there(map_path)
    from bridge.recording.logs.importing import import_log as write
    from bridge.recording.logs.importing import stem

    made = write(log, map_path, output or Path(f"{stem(log)}.mcap"))
    if as_json:
        print_json({"recording": str(made.recording.path), **made.recording.metadata["imported"]})
    else:
        _print(made)


def _guess(log: Path, rig: str, as_json: bool) -> None:
    from bridge.recording.logs.guess import guessed_map

    found = guessed_map(log, rig)
    if as_json:
        signals = {name: {"column": g.column, "sure": g.sure.word, "why": g.why} for name, g in found.signals.items()}
        print_json({"map": found.text, "signals": signals})
    else:
        print(found.text, end="")


def _print(made: "Made") -> None:
    from bridge.cli.tables import print_table
    from bridge.recording.imported import facts, holes_in_words, rows_in_words
    from bridge.scenario.units import shown

    told = facts(made.recording)
    rows = []
    for name, entry in told["signals"].items():
        factor, unit = shown(entry["unit"])
        low, high = (end * factor for end in made.ends(name))
        missing = holes_in_words(entry)
        rows.append((name, entry["column"], f"{low:.5g} to {high:.5g} {unit}".rstrip(), entry["method"], missing))
    print_table(("signal", "column", "range", "method", "missing"), rows)
    print(f"rows       {rows_in_words(told['rows'])}")
    for note in told["notes"]:
        print(f"note       {note}")
    print(f"recording  {made.recording.path}")
