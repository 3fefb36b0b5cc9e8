"""Verbs on recordings: info, recover, export, compare."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.app import AS_JSON, print_json

if TYPE_CHECKING:
    from bridge.recording.compare import Difference

FILE = Annotated[Path, typer.Argument(help="A recording, .mcap.")]
TOPICS = Annotated[list[str] | None, typer.Option("--topics", help="Only these: 'state,pressure/*'. Repeatable.")]
TOLERANCE = Annotated[
    list[str] | None,
    typer.Option("--tolerance", metavar="SIGNAL=VALUE", help="Allowed difference: position='0.1 mm'. Repeatable."),
]


def info(file: FILE, as_json: AS_JSON = False) -> None:
    """Say what a recording holds and how its run went: channels, rates, gaps, events, metrics."""
    from bridge.cli.info import print_info
    from bridge.recording.info import describe
    from bridge.recording.reader import read

    found = describe(read(file))
    if as_json:
        print_json(found)
    else:
        print_info(found)


def recover(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="What was cut off; or parts, to be joined.")],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="[default: FILE-recovered.mcap]", show_default=False)
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Copy all that is sound in a file that was cut off, or in the parts of one run, to a file that is whole."""
    from bridge.recording.recover import recover as copy

    done = copy(files, output or files[0].with_stem(f"{files[0].stem}-recovered"))
    if as_json:
        print_json(done._asdict() | {"path": str(done.path)})
        return
    damaged = f", {done.damaged} damaged chunks left out" if done.damaged else ""
    print(f"{done.path}: {done.messages} messages{damaged}" + (" (nothing was missing)" if done.whole else ""))


def export(
    file: FILE,
    csv: Annotated[bool, typer.Option("--csv", help="A folder of CSV files, one a channel.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="A folder of Parquet files, one a channel.")] = False,
    mat: Annotated[bool, typer.Option("--mat", help="A MATLAB file, a structure a channel.")] = False,
    topics: TOPICS = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="[default: beside FILE]", show_default=False)
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Write a recording for other programs, units in the headers."""
    from bridge.errors import ScenarioError
    from bridge.recording.choice import choose
    from bridge.recording.export import export as write
    from bridge.recording.reader import read
    from bridge.wire.messages import TOPICS as OURS

    forms = [name for name, asked in (("csv", csv), ("parquet", parquet), ("mat", mat)) if asked]
    if len(forms) != 1:
        raise ScenarioError("export: name one of --csv, --parquet, --mat")
    recording = read(file)
    chosen = sorted(choose([topic for topic in recording.counts if topic in OURS], topics))
    paths = write(recording, chosen, forms[0], output or file.with_suffix(".mat" if mat else ""))
    if as_json:
        print_json([str(path) for path in paths])
    else:
        print("\n".join(str(path) for path in paths))


def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="A recording, .mcap.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Another one.")],
    tolerance: TOLERANCE = None,
    topics: TOPICS = None,
    partly: Annotated[bool, typer.Option("--partly", help="Allow instants that only one of them has.")] = False,
    as_json: AS_JSON = False,
) -> None:
    """Compare two recordings signal by signal: greatest difference, rms, where it begins. Exit code 1: they differ."""
    from bridge.recording.choice import choose
    from bridge.recording.compare import compare as differences
    from bridge.recording.reader import read
    from bridge.recording.signals import COMPARED

    chosen = tuple(topic for topic in COMPARED if topic in choose(COMPARED, topics))
    found = differences(read(first), read(second), tolerances(tolerance), chosen, partly)
    print_differences(found, as_json)
    raise typer.Exit(0 if all(difference.passed for difference in found) else 1)


def tolerances(texts: list[str] | None) -> dict[str, str]:
    """Signal -> what may be. Raises ScenarioError for what is no such pair."""
    from bridge.errors import ScenarioError

    pairs = [text.partition("=") for text in texts or []]
    for name, sign, value in pairs:
        if not sign or not value:
            raise ScenarioError(f"--tolerance {name}: write SIGNAL=VALUE, such as position='0.1 mm'")
    return {name: value for name, _, value in pairs}


def print_differences(found: "list[Difference]", as_json: bool, further: dict[str, Any] | None = None) -> None:
    """The table of a comparison."""
    from bridge.cli.printing import print_table

    if as_json:
        plain = [{k: None if v != v else v for k, v in difference._asdict().items()} for difference in found]
        print_json({"signals": plain, "passed": all(d.passed for d in found), **(further or {})})
        return
    print_table(
        ("signal", "greatest", "at", "rms", "first beyond", "allowed", "instants", "alone", ""), map(_row, found)
    )


def _row(d: "Difference") -> tuple[str, ...]:
    def time(value: float | None) -> str:
        return "-" if value is None else f"{value:.6g} s"

    mark = "[green]same[/green]" if d.passed and d.greatest == 0.0 else "[green]within[/green]"
    return (
        d.signal,
        f"{d.greatest:.4g} {d.unit}",
        time(d.at),
        f"{d.rms:.3g} {d.unit}",
        time(d.first),
        f"{d.tolerance:g} {d.unit}",
        str(d.instants),
        str(d.alone),
        mark if d.passed else "[red]DIFFERS[/red]",
    )
