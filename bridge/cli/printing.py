"""Tables for people: the summary of a run, the verdicts of checks."""

import sys
from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from bridge.runs.check import CheckResult
from bridge.runs.run import Outcome
from bridge.scenario.bands import METRICS, value_with_unit

UNFOLDED = 200  # columns, where nobody's window is to be kept to


def print_table(headers: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """A plain table on standard output."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for header in headers:
        table.add_column(header, overflow="fold")
    for row in rows:
        table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else UNFOLDED).print(table)


def print_summary(outcome: Outcome) -> None:
    """The summary of a run."""
    summary = outcome.summary
    console = Console()
    if "ending" in summary:
        console.print(f"[bold]{summary['scenario']}[/bold] {summary['mode']}: {summary['ending']}")
        rows = [(METRICS[name].words, value_with_unit(name, value)) for name, value in summary["metrics"].items()]
        print_table(("control", ""), rows)
        print_table(("timing", "p50", "p99", "p99.9", "max"), _timing_rows(summary["timing"]))
        for line in [*_stability(summary), *_counts(summary)]:
            console.print(line, highlight=False, soft_wrap=True)
    for note in summary["notes"]:
        console.print(f"[yellow]{note}[/yellow]", highlight=False)
    for fault in outcome.faults:
        console.print(f"[red]{fault}[/red]", highlight=False, markup=True)
    if outcome.recording:
        console.print(f"recording  {outcome.recording}", highlight=False, soft_wrap=True)
    if outcome.picture:
        console.print(f"picture    {outcome.picture}", highlight=False, soft_wrap=True)


def _timing_rows(timing: dict[str, Any]) -> list[list[str]]:
    rows = []
    for key, words in (("lateness", "lateness of the ticks"), ("round_trip", "measurement to command")):
        spread = timing.get(key) or {}
        if spread:
            rows.append([words, *(f"{value * 1e6:.1f} us" for value in spread.values())])
    return rows


def _stability(summary: dict[str, Any]) -> list[str]:
    """Where the run stands among the stable gains."""
    from bridge.studies.stability.operating import sentences

    found = summary.get("stability")
    return [f"{word:11}{line}" for word, line in zip(("gain", ""), sentences(found), strict=True)] if found else []


def _counts(summary: dict[str, Any]) -> Iterable[str]:
    commands = summary["commands"]
    overruns = summary["timing"].get("overruns")
    if overruns:
        yield (
            f"overruns   {overruns['count']}, longest {overruns['worst'] * 1e3:.2f} ms, "
            f"most ticks caught up {overruns['burst']}"
        )
    refused = ", ".join(f"{count} {reason}" for reason, count in commands["refused"].items()) or "none"
    worst = f" (worst {commands['worst_lateness'] * 1e3:.2f} ms)" if commands["late"] else ""
    lost = ", ".join(f"{count} {topic}" for topic, count in summary["lost"].items()) or "none"
    yield f"commands   {commands['sent']} sent, {commands['late']} late{worst}; refused: {refused}"
    yield f"lost       {lost}; safe states: {summary['safe_states']}"


def print_checks(results: list[CheckResult]) -> None:
    """The verdicts of `hydrotwin check`."""
    rows = []
    for result in results:
        for verdict in result.verdicts:
            mark = "[green]passed[/green]" if verdict.passed else "[red]FAILED[/red]"
            rows.append((result.scenario.name, verdict.text, verdict.found, mark))
        rows += [(result.scenario.name, note, "", "[yellow]note[/yellow]") for note in result.notes]
        rows += [(result.scenario.name, fault, "", "[red]FAILED[/red]") for fault in result.faults]
    print_table(("scenario", "expected", "found", ""), rows)
