"""What `hydrotwin info` prints for people."""

from typing import Any

from rich.console import Console

from bridge.cli.printing import print_table
from bridge.recording.info import plain
from bridge.scenario.bands import METRICS, value_with_unit

EVENTS = 20  # events that are shown; --json gives all


def print_info(found: dict[str, Any]) -> None:
    """Facts, channels, events, metrics."""
    console = Console(soft_wrap=True, highlight=False)
    size = "" if found["size"] is None else f", {found['size'] / 1e6:.2f} MB"
    console.print(f"[bold]{found['file']}[/bold]{size}", highlight=False)
    for problem in found["problems"]:
        console.print(f"[red]{problem}[/red]")
    print_table(("", ""), [(name, plain(value)) for name, value in _facts(found)])
    print_table(("channel", "type", "messages", "from", "to", "rate", "gaps", "longest", "lost"), _channels(found))
    _print_events(console, found["events"])
    if found["metrics"]:
        print_table(("metric", ""), [(METRICS[k].words, value_with_unit(k, v)) for k, v in found["metrics"].items()])


def _facts(found: dict[str, Any]) -> list[tuple[str, Any]]:
    names = ("ending", "scenario", "title", "rig", "mode", "speed", "recorded", "run_id", "lost", "host", "versions")
    own = [(f"{name}.{key}", value) for name, values in found["metadata"].items() for key, value in values.items()]
    return [(name, found[name]) for name in names if found.get(name) not in (None, "", {})] + own


def _channels(found: dict[str, Any]) -> list[tuple[str, ...]]:
    return [
        (
            c["topic"],
            c["type"].rpartition("/")[2],
            str(c["messages"]),
            f"{c['first']:.3f} s",
            f"{c['last']:.3f} s",
            "-" if c["rate"] is None else f"{c['rate']:.6g} /s",
            str(c["gaps"]),
            "-" if c["longest"] is None else f"{c['longest'] * 1e3:.6g} ms",
            str(c["lost"]),
        )
        for c in found["channels"]
    ]


def _print_events(console: Console, events: list[dict[str, Any]]) -> None:
    for event in events[:EVENTS]:
        console.print(f"{event['time']:10.3f} s  {event['kind']:8}  {event['text']}", markup=False)
    if len(events) > EVENTS:
        console.print(f"… and {len(events) - EVENTS} events more: --json gives all")
