"""The verb import: a log of others made into a recording."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import AS_JSON, there
from bridge.cli.outputs import given_up, print_json, write_text
from bridge.cli.streams import said_when_interrupted
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.recording.logs.importing import Made

RIG = "ehla"


def import_log(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="A log: CSV (also .gz), MATLAB, Parquet, MDF, MCAP, or a rosbag2.")
    ],
    map_path: Annotated[
        Path | None, typer.Option("--map", help="Map, .toml: which column is which signal.", show_default=False)
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Recording to write; with --guess the map. [default: LOG.mcap, here; a map is printed]",
            show_default=False,
        ),
    ] = None,
    guess: Annotated[
        bool,
        typer.Option("--guess", help="Print a map to edit: names, units and ranges of the log, and how sure each is."),
    ] = False,
    rig: Annotated[
        str | None,
        typer.Option(
            help="With --guess: scenario whose drive the map is for. [default: ehla]",
            metavar="SCENARIO",
            show_default=False,
        ),
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Import a log that another program has measured on a rig: a recording that every verb takes.

    The map names the drive, and of each signal its column, unit, sign and method; docs/import.md describes it. What is
    missing in the log stays missing. A file that is there is replaced if it was imported before, and no other.
    """
    there(log)
    if guess:
        if map_path is not None:
            raise UsageError("--guess proposes a map, and --map gives one: leave one of them out")
        _guess(log, rig or RIG, output, as_json)
        return
    if rig is not None:
        raise UsageError(f"--rig {rig}: is of --guess; the drive of an import is named by its map, `rig`")
    if map_path is None:
        raise UsageError(f"{log}: --map MAP.toml says which column is which signal; --guess proposes such a map")
    there(map_path)
    from bridge.recording.logs.importing import import_log as write
    from bridge.recording.logs.importing import stem

    path = output or Path(f"{stem(log)}.mcap")
    with said_when_interrupted(lambda: given_up(path)):
        made = write(log, map_path, path)
    if as_json:
        own = {"recording": str(made.recording.path), "replaced": made.replaced}
        print_json(own | made.recording.metadata["imported"])
    else:
        _print(made)


def _guess(log: Path, rig: str, output: Path | None, as_json: bool) -> None:
    from bridge.recording.logs.guess import guessed_map

    if output is not None and output.suffix != ".toml":
        raise UsageError(f"-o {output}: a map is a TOML file; name one that ends in .toml")
    if output is not None and output.exists():  # a guess is corrected by hand: that is not to be lost
        raise UsageError(f"-o {output}: is there already; name another file")
    found = guessed_map(log, rig)
    if not write_text(output, found.text):
        raise typer.Exit(1)
    if as_json:
        signals = {name: {"column": g.column, "sure": g.sure.word, "why": g.why} for name, g in found.signals.items()}
        print_json({"map": found.text, "signals": signals})
    else:
        print(found.text if output is None else f"{output}\n", end="")


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
    print(f"recording  {made.recording.path}" + (", in place of an earlier import" if made.replaced else ""))
