"""Verbs that run scenarios: run, check."""

import time
from collections.abc import Iterator
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import (
    AS_JSON,
    CHANGES,
    PRIORITY,
    SCENARIO,
    Mode,
    address,
    seconds,
)
from bridge.cli.outputs import json_text, own_folder, print_json, write_text
from bridge.cli.streams import complain, done_when_interrupted
from bridge.errors import UsageError
from bridge.machine.priority import Priority

if TYPE_CHECKING:
    from bridge.runs.check import CheckResult
    from bridge.scenario import Scenario

RECORD = Annotated[
    Path | None,
    typer.Option("--record", help="Recording to write. [default: runs/SCENARIO-TIME.mcap]", show_default=False),
]


def run(
    scenario: SCENARIO,
    mode: Annotated[Mode, typer.Option(help="What paces the loop.")] = Mode.REALTIME,
    speed: Annotated[float, typer.Option(min=0.01, max=100.0, help="Simulated seconds per second.")] = 1.0,
    duration: Annotated[str | None, typer.Option(help="Duration in place of the scenario's, such as '5 s'.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed in place of the scenario's.")] = None,
    changes: CHANGES = None,
    recording: RECORD = None,
    summary_file: Annotated[
        Path | None, typer.Option("--json", help="Also write the summary as JSON; - prints it instead of the table.")
    ] = None,
    priority: PRIORITY = Priority.AUTO,
    external: Annotated[
        bool, typer.Option("--external", help="Wait for an external controller instead of starting ours.")
    ] = False,
    listen: Annotated[
        str | None,
        typer.Option(
            help="The plant's address. [default: a free one on loopback]", show_default=False, callback=address
        ),
    ] = None,
    patience: Annotated[
        float, typer.Option(help="Seconds the plant waits for a partner or a lockstep command.", callback=seconds)
    ] = 10.0,
) -> None:
    """Run a scenario and leave a recording, a picture and a summary.

    [bold]realtime[/bold] and [bold]lockstep[/bold] start plant, controller and recorder as processes;
    [bold]inprocess[/bold] needs neither middleware nor clock. All record the same data.
    """
    from bridge.scenario import load
    from bridge.scenario.loading import refuse_fast_daq

    checked = load(scenario, _changes(changes, duration, seed))
    if mode == Mode.REALTIME:
        refuse_fast_daq(checked, speed)
    from bridge.cli.printing import print_summary
    from bridge.processes.options import RunOptions
    from bridge.recording.names import own_name
    from bridge.runs.run import run_scenario, shown

    with nullcontext(recording) if recording else own_name(default_recording(checked.name)) as path:
        outcome = run_scenario(checked, RunOptions(mode, path, speed, priority, patience, external, listen))
    if summary_file == Path("-"):
        print_json(outcome.plain())
        raise typer.Exit(1 if outcome.faults else 0)
    with done_when_interrupted(lambda: print_summary(outcome)):  # what is known without picture and theory
        full = shown(outcome)
    print_summary(full)
    written = write_text(summary_file, json_text(full.plain()))
    raise typer.Exit(1 if full.faults or not written else 0)


def default_recording(name: str) -> Path:
    """runs/NAME-TIME.mcap"""
    return Path("runs") / f"{name}-{time.strftime('%Y%m%d-%H%M%S')}.mcap"


def _changes(changes: list[str] | None, duration: str | None, seed: int | None) -> list[str]:
    own = [f"duration={duration}"] if duration is not None else []
    return [*(changes or []), *own, *([f"seed={seed}"] if seed is not None else [])]


def check(
    scenarios: Annotated[list[str], typer.Argument(metavar="SCENARIO...", help="Names or TOML files.")],
    mode: Annotated[Mode, typer.Option(help="What paces the loop.")] = Mode.INPROCESS,
    changes: CHANGES = None,
    junit: Annotated[Path | None, typer.Option(help="Write JUnit XML here.")] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Folder for the recordings. [default: runs/check-TIME]", show_default=False
        ),
    ] = None,
    report: Annotated[bool, typer.Option("--report", help="Write a page on each run beside its recording.")] = False,
    covered: Annotated[
        bool, typer.Option("--coverage", help="Run nothing: list the requirements, and the bands that belong to each.")
    ] = False,
    as_json: AS_JSON = False,
) -> None:
    """Run scenarios headless and judge the bands they state; for CI."""
    if covered:
        from bridge.scenario import load

        _print_coverage([load(name, changes) for name in scenarios], as_json)
        return
    asked = [(name, _loaded(name, changes)) for name in scenarios]
    wrong = [str(found) for _, found in asked if isinstance(found, UsageError)]
    if len(wrong) == len(asked) and junit is None:
        raise UsageError("\n".join(wrong))
    from bridge.runs.check import junit_xml

    folder = output or own_folder("check")
    results = list(_checked(asked, mode, folder))
    if output is None:
        with suppress(OSError):
            folder.rmdir()  # where nothing was recorded
    written = write_text(junit, junit_xml(results))
    refused = [fault for result in results if result.refused for fault in result.faults]
    if len(refused) == len(results):
        raise UsageError("\n".join(refused))
    complain("\n".join(refused))
    recordings = [result.recording for result in results if result.recording]
    if report:
        _write_reports(recordings)
    if as_json:
        print_json([result.plain() for result in results])
    else:
        from bridge.cli.printing import print_checks

        print_checks(results)
        if recordings:
            print(f"recordings in {folder}")
    well = written and all(result.passed for result in results)
    raise typer.Exit(2 if refused else 0 if well else 1)


def _loaded(name: str, changes: list[str] | None) -> "Scenario | UsageError":
    from bridge.scenario import load

    try:
        return load(name, changes)
    except UsageError as error:
        return error


def _checked(asked: "list[tuple[str, Scenario | UsageError]]", mode: Mode, folder: Path) -> "Iterator[CheckResult]":
    """One result after the other; a scenario that cannot be run does not stop the others, an interrupt does."""
    from bridge.runs.check import check_scenario, refusal, refuse_windows
    from bridge.runs.run import ready_to_run

    for name, scenario in asked:
        try:
            if isinstance(scenario, UsageError):
                raise scenario
            ready_to_run(scenario)
            refuse_windows(scenario)
        except UsageError as error:
            yield refusal(name, str(error))
            continue
        yield (result := check_scenario(scenario, mode, folder))
        if result.interrupted:
            return


def _write_reports(recordings: list[Path]) -> None:
    """A page beside each recording."""
    from bridge.report.page import write_report

    for recording in recordings:
        write_report([recording], recording.with_suffix(".html"))


def _print_coverage(scenarios: "list[Scenario]", as_json: bool) -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.check import coverage

    heads, rows = ("requirement", "text", "scenario", "band"), coverage(scenarios)
    if as_json:
        print_json([dict(zip(heads, row, strict=True)) for row in rows])
    else:
        print_table(heads, [(row[0] or "-", *row[1:]) for row in rows])
