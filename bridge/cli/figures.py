"""Verbs that look: describe, convergence, digest, messages, figure, figures, doctor."""

from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.app import AS_JSON, CHANGES, SCENARIO, print_json


def describe(scenario: SCENARIO = "step", changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Print a scenario's circuit: parts, values with their sources, frequencies, travel times, limits of the step."""
    from bridge.cli.printing import print_table
    from bridge.scenario import load
    from bridge.scenario.describe import (
        PICTURE,
        facts,
        step_rows,
        values_of,
        warnings,
    )

    loaded = load(scenario, changes)
    values, found, steps = values_of(loaded), facts(loaded), step_rows(loaded)
    if as_json:
        keys = ("part", "what", "time", "longest step")
        limits = [dict(zip(keys, row, strict=True)) for row in steps]
        print_json({"values": [v._asdict() for v in values], "facts": [f._asdict() for f in found], "step": limits})
        return
    print(PICTURE)
    print_table(("value", "", "", "source"), [(v.name, v.value, "*" if v.changed else "", v.source) for v in values])
    print()
    print_table(("what follows", ""), found)
    print()
    print_table(("part", "what is fast in it", "its time", "longest step that follows"), steps)
    for line in warnings(loaded):
        print(f"warning: {line}")


def convergence(scenario: SCENARIO = "step", changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Run a scenario at its step, a half and a quarter of it: error and order of each signal."""
    from bridge.cli.printing import print_table
    from bridge.runs.convergence import convergence as compare
    from bridge.scenario import load

    loaded = load(scenario, changes)
    rows = compare(loaded)
    if as_json:
        print_json([row.plain() for row in rows])
        return
    step = loaded.loop.step * 1e6
    print(f"{loaded.name} at {step:g}, {step / 2:g} and {step / 4:g} us; errors against the finest")
    print_table(("signal", "rms", "greatest", "order"), [row.words() for row in rows])
    if any(pipe["model"] == "ends" for name, pipe in loaded.rig_values().items() if name.startswith("pipe_")):
        print("lines of model ends are fitted anew to each step: what is left of the filters' own error does not fall")


def digest(files: Annotated[list[Path], typer.Argument(help="Recordings, .mcap.")], as_json: AS_JSON = False) -> None:
    """Print one hash per data channel; with several files, say whether they are the same."""
    from bridge.cli.printing import print_table
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


def messages(as_json: AS_JSON = False) -> None:
    """Print every key, type, rate, `.msg` text and `struct` format."""
    from bridge.cli.printing import print_table
    from bridge.wire.messages import (
        TOPICS,
        definition,
        described,
        field_names,
        struct_format,
    )

    rows = [
        (
            f"<rig>/{t.name}",
            t.type.rpartition("/")[2],
            t.publisher,
            t.rate,
            "data" if t.data else "",
            t.delivery,
            _short(struct_format(t.type) or ""),
        )
        for t in TOPICS.values()
    ]
    keys = ("key", "type", "from", "rate", "kind", "in real time", "struct")
    types = {topic.type: definition(topic.type) for topic in TOPICS.values()}
    if as_json:
        plain = [dict(zip(keys, row, strict=True)) for row in rows]
        fields = {kind: field_names(kind) for kind in types}
        print_json({"messages": plain, "definitions": types, "fields": fields})
        return
    print_table(keys, rows)
    for kind in types:
        print(f"\n# {kind}\n{described(kind).rstrip()}")
    print("\nPayloads are CDR, little endian: 4 bytes of header (00 01 00 00), then the fields in order.")


def _short(layout: str) -> str:
    """A struct format with runs of a code counted: dddd is 4d."""
    head, codes = layout[:3], layout[3:]
    return head + "".join(f"{n}{code}" if (n := len(list(run))) > 1 else code for code, run in groupby(codes))


def figure(
    name: Annotated[str, typer.Argument(help="Name of a figure, such as 2.4.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for NAME.png and NAME.csv.")] = Path(),
    as_json: AS_JSON = False,
) -> None:
    """Draw a figure of the source from the twin: NAME.png and NAME.csv."""
    from bridge.errors import ScenarioError
    from bridge.figures import draw_figure

    try:
        paths = draw_figure(name, output)
    except ValueError as error:
        raise ScenarioError(str(error)) from None
    if as_json:
        print_json([str(path) for path in paths])
    else:
        print("\n".join(str(path) for path in paths))


def figures(
    every: Annotated[bool, typer.Option("--all", help="Draw all of them instead.")] = False,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for them, with --all.")] = Path("figures"),
    as_json: AS_JSON = False,
) -> None:
    """List the figures, or draw them all."""
    from bridge.cli.printing import print_table
    from bridge.figures import FIGURES

    if every:
        for name in FIGURES:
            figure(name, output, as_json)
        return
    rows = [(entry.name, entry.title) for entry in FIGURES.values()]
    if as_json:
        print_json([{"name": name, "title": title} for name, title in rows])
    else:
        print_table(("name", "title"), rows)


def doctor(as_json: AS_JSON = False) -> None:
    """Look at this machine: can it run the loop, and how punctually?"""
    from bridge.cli.printing import print_table
    from bridge.machine.doctor import examine

    findings = examine()
    if as_json:
        print_json([finding._asdict() for finding in findings])
    else:
        marks = {"good": "[green]good[/green]", "fair": "[yellow]fair[/yellow]", "bad": "[red]bad[/red]"}
        print_table(
            ("", "what", "found", "what to do"), [(marks[f.state], f.what, f.found, f.advice) for f in findings]
        )
    raise typer.Exit(1 if any(finding.state == "bad" for finding in findings) else 0)
