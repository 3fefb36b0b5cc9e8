"""Verbs on recordings: info, recover, export, compare."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, FILE, TOLERANCE, TOPICS, there, tolerances
from bridge.cli.outputs import print_json
from bridge.errors import UsageError


def info(file: FILE, as_json: AS_JSON = False) -> None:
    """Say what a recording holds and how its run went: channels, rates, gaps, events, metrics."""
    there(file)
    from bridge.cli.printing import print_info
    from bridge.recording.info import describe
    from bridge.recording.reader import read

    found = describe(read(file))
    if as_json:
        print_json(found.plain())
    else:
        print_info(found)


def recover(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", help="A truncated recording, or the parts of one."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Recording to write. [default: FILE-recovered.mcap]", show_default=False),
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Recover the readable part of a truncated or damaged recording, or join the parts of one run.

    Exit code 1: nothing could be recovered.
    """
    there(*files)
    from bridge.recording.recover import recover as copy

    done = copy(files, output or files[0].with_stem(f"{files[0].stem}-recovered"))
    if as_json:
        print_json(done._asdict() | {"path": str(done.path)})
        return
    for note in done.notes:
        print(f"hydrotwin: {note}", file=sys.stderr)
    damaged = f", {done.damaged} damaged chunks left out" if done.damaged else ""
    print(f"{done.path}: {done.messages} messages{damaged}" + (" (nothing was missing)" if done.whole else ""))


def export(
    file: FILE,
    csv: Annotated[bool, typer.Option("--csv", help="One CSV file per channel.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="One Parquet file per channel.")] = False,
    mat: Annotated[bool, typer.Option("--mat", help="A MATLAB file, one structure per channel.")] = False,
    mdf: Annotated[
        bool, typer.Option("--mdf", help="An MDF 4 file, one channel group per topic; needs the extra `logs`.")
    ] = False,
    rosbag2: Annotated[
        bool, typer.Option("--rosbag2", help="A bag of ROS 2: a folder with the messages in MCAP and metadata.yaml.")
    ] = False,
    topics: TOPICS = None,
    absolute: Annotated[
        bool, typer.Option("--absolute", help="Absolute pressures: gauge and 1 bar of ambient.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File or folder to write. [default: beside FILE]", show_default=False),
    ] = None,
    as_json: AS_JSON = False,
) -> None:
    """Write a recording for other programs, units in the headers."""
    there(file)
    from bridge.recording.choice import choose
    from bridge.recording.export import BAG, ENDINGS, MDF
    from bridge.recording.export import export as write
    from bridge.recording.reader import read
    from bridge.wire.messages import TOPICS as OURS

    asked = {"csv": csv, "parquet": parquet, "mat": mat, MDF: mdf, BAG: rosbag2}
    forms = [name for name, wanted in asked.items() if wanted]
    if len(forms) != 1:
        raise UsageError(f"export: name one of {', '.join(f'--{name}' for name in asked)}")
    (form,) = forms
    if rosbag2 and absolute:
        raise UsageError("--absolute: a bag holds the messages as they are, in gauge; leave it out")
    recording = read(file)
    chosen = sorted(choose([topic for topic in recording.counts if topic in OURS], topics))
    paths = write(recording, chosen, form, output or file.with_suffix(ENDINGS.get(form, "")), absolute)
    if as_json:
        print_json([str(path) for path in paths])
    else:
        print("\n".join(str(path) for path in paths))


def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="A recording, .mcap.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Another one.")],
    tolerance: TOLERANCE = None,
    topics: TOPICS = None,
    partly: Annotated[bool, typer.Option("--partly", help="Ignore time stamps that only one file contains.")] = False,
    as_json: AS_JSON = False,
) -> None:
    """Compare two recordings signal by signal: greatest difference, rms, where it begins. Exit code 1: they differ."""
    there(first, second)
    from bridge.cli.printing import print_differences
    from bridge.recording.choice import choose
    from bridge.recording.compare import compare as differences
    from bridge.recording.reader import read
    from bridge.recording.signals import COMPARED

    chosen = tuple(topic for topic in COMPARED if topic in choose(COMPARED, topics))
    found = differences(read(first), read(second), tolerances(tolerance), chosen, partly)
    print_differences(found, as_json)
    raise typer.Exit(0 if all(difference.passed for difference in found) else 1)


def digest(files: Annotated[list[Path], typer.Argument(help="Recordings, .mcap.")], as_json: AS_JSON = False) -> None:
    """Print one hash per data channel; with several files, say whether they are the same."""
    there(*files)
    from bridge.cli.tables import print_table
    from bridge.recording.digest import digest as hashes

    found = {str(path): hashes(path) for path in files}
    first = next(iter(found.values()))
    same = {channel: all(other[channel] == first[channel] for other in found.values()) for channel in first}
    if as_json:
        print_json(found)
    elif len(files) == 1:
        print_table(("channel", "hash"), list(first.items()))
    else:
        rows = [(c, *(hashes[c][:12] for hashes in found.values()), "same" if same[c] else "DIFFERS") for c in first]
        print_table(("channel", *(Path(name).name for name in found), ""), rows)
    raise typer.Exit(0 if all(same.values()) else 1)
