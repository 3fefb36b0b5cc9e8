"""Verbs about the machine and the wire: messages, doctor."""

from importlib import resources
from itertools import groupby
from typing import Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CHANGES
from bridge.cli.outputs import print_json
from bridge.errors import UsageError

C = Annotated[bool, typer.Option("--c", help="Print hydrotwin_law.h, the header of a law in C, and nothing else.")]


OF = Annotated[
    str | None, typer.Option("--scenario", help="Print the further channels of a scenario and their message instead.")
]


def messages(header: C = False, scenario: OF = None, changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Print every key, type, rate, `.msg` text and `struct` format, and how to write a controller with them."""
    if header:
        print((resources.files("bridge.loop") / "hydrotwin_law.h").read_text(encoding="utf-8"), end="")
        return
    if changes and scenario is None:
        raise UsageError("--set changes a scenario: name it with --scenario")
    if scenario is not None:
        _channels(scenario, changes or [], as_json)
        return
    from bridge.cli.tables import print_table
    from bridge.wire.guide import GUIDE
    from bridge.wire.messages import TOPICS, definition, described, field_names

    rows = [
        (
            f"<rig>/{t.name}",
            t.type.rpartition("/")[2],
            t.publisher,
            t.rate,
            "data" if t.data else "",
            t.delivery,
            _struct(t.type),
        )
        for t in TOPICS.values()
    ]
    keys = ("key", "type", "from", "rate", "kind", "in real time", "struct")
    types = {topic.type: definition(topic.type) for topic in TOPICS.values()}
    if as_json:
        plain = [dict(zip(keys, row, strict=True)) for row in rows]
        fields = {kind: field_names(kind) for kind in types}
        print_json({"messages": plain, "definitions": types, "fields": fields, "guide": GUIDE})
        return
    print_table(keys, rows)
    for kind in types:
        print(f"\n# {kind}\n{described(kind).rstrip()}")
    print(f"\n{GUIDE}", end="")


def _channels(which: str, changes: list[str], as_json: bool) -> None:
    """The message of a scenario's further channels, and what its channels may read."""
    from bridge.cli.tables import print_table
    from bridge.scenario import load
    from bridge.scenario.channels import layout_of, rows_of
    from bridge.scenario.taps import TAP_HEADS, legend
    from bridge.wire.channels import format_of, text_of
    from bridge.wire.messages import CHANNELS_TOPIC, VARYING

    scenario = load(which, changes)
    layout, rows = layout_of(scenario), rows_of(scenario)
    if as_json:
        message: dict[str, Any] = {
            "key": f"{scenario.rig_name}/{CHANNELS_TOPIC}",
            "type": VARYING,
            "struct": format_of(layout),
        }
        known = [row._asdict() for row in rows]
        taps = [dict(zip(TAP_HEADS, row, strict=True)) for row in legend(scenario)]
        message |= {"definition": text_of(layout), "channels": scenario.daq.channels, "known": known, "measured": taps}
        print_json(message)
        return
    print_table(TAP_HEADS, legend(scenario))
    print()
    print_table(("channel", "unit", "from", "to", "reads", "chosen"), [row.in_words() for row in rows])
    if layout:
        print(f"\n# {VARYING} on {scenario.rig_name}/{CHANNELS_TOPIC}, struct {_short(format_of(layout))}")
        print(text_of(layout), end="")
    else:
        print('\nNone is chosen, so none is published. Choose some: daq.channels = ["p_pump", "force"]')


def _struct(kind: str) -> str:
    """The struct format of a message; empty for one with strings or arrays."""
    from bridge.wire.messages import VARYING, struct_format

    return _short(struct_format(kind) or "") + (", then d per channel" if kind == VARYING else "")


def _short(layout: str) -> str:
    """A struct format with runs of a code counted: dddd is 4d."""
    head, codes = layout[:3], layout[3:]
    return head + "".join(f"{n}{code}" if (n := len(list(run))) > 1 else code for code, run in groupby(codes))


def doctor(as_json: AS_JSON = False) -> None:
    """Look at this machine: can it run the loop, and how punctually?"""
    from rich.text import Text

    from bridge.cli.tables import print_table
    from bridge.machine.doctor import examine

    findings = examine()
    if as_json:
        print_json([finding._asdict() for finding in findings])
    else:
        marks = {"good": Text("good", "green"), "fair": Text("fair", "yellow"), "bad": Text("bad", "red")}
        print_table(
            ("", "what", "found", "what to do"), [(marks[f.state], f.what, f.found, f.advice) for f in findings]
        )
    raise typer.Exit(1 if any(finding.state == "bad" for finding in findings) else 0)
