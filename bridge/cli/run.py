"""Verbs that run scenarios: run, check, scenarios, schema."""

import json
import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import (
    AS_JSON,
    CHANGES,
    SCENARIO,
    Mode,
    address,
    seconds,
)
from bridge.cli.outputs import print_json, write_text
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.scenario import Scenario

RECORD = Annotated[
    Path | None,
    typer.Option("--record", help="Recording to write. [default: runs/SCENARIO-TIME.mcap]", show_default=False),
]


def run(
    scenario: SCENARIO,
    mode: Annotated[Mode, typer.Option(help="What paces the loop.")] = Mode.REALTIME,
    speed: Annotated[float, typer.Option(min=0.01, max=100.0, help="Simulated seconds per second.")] = 1.0,
    duration: Annotated[str | None, typer.Option(help="Instead of the scenario's, such as '5 s'.")] = None,
    seed: Annotated[int | None, typer.Option(help="Instead of the scenario's.")] = None,
    changes: CHANGES = None,
    recording: RECORD = None,
    summary_file: Annotated[
        Path | None, typer.Option("--json", help="Also write the summary as JSON; - prints it instead of the table.")
    ] = None,
    fifo: Annotated[bool, typer.Option("--fifo", help="Ask for SCHED_FIFO and locked memory.")] = False,
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
        outcome = run_scenario(checked, RunOptions(mode, path, speed, fifo, patience, external, listen))
    if summary_file == Path("-"):
        print_json(outcome.plain())
        raise typer.Exit(1 if outcome.faults else 0)
    outcome = shown(outcome)
    print_summary(outcome)
    written = write_text(summary_file, json.dumps(outcome.plain(), indent=2))
    raise typer.Exit(1 if outcome.faults or not written else 0)


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
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for the recordings.")] = Path("runs"),
    covered: Annotated[
        bool, typer.Option("--coverage", help="Run nothing: list the requirements, and the bands that belong to each.")
    ] = False,
    as_json: AS_JSON = False,
) -> None:
    """Run scenarios headless and judge the bands they state; for CI."""
    from bridge.scenario import load

    if covered:
        _print_coverage([load(name, changes) for name in scenarios], as_json)
        return
    try:
        loaded = [load(name, changes) for name in scenarios]
        from bridge.runs.check import refuse_windows
        from bridge.runs.run import ready_to_run

        for scenario in loaded:
            ready_to_run(scenario)  # all are good, or none is run
            refuse_windows(scenario)
    except UsageError as error:
        _write_refusal(junit, scenarios, str(error))
        raise
    from bridge.cli.printing import print_checks
    from bridge.runs.check import check_scenario, junit_xml

    results = []
    for scenario in loaded:
        results.append(check_scenario(scenario, mode, output))
        if results[-1].interrupted:
            break
    written = write_text(junit, junit_xml(results))
    if as_json:
        print_json([result.plain() for result in results])
    else:
        print_checks(results)
    raise typer.Exit(0 if written and all(result.passed for result in results) else 1)


def _print_coverage(scenarios: "list[Scenario]", as_json: bool) -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.check import coverage

    heads, rows = ("requirement", "text", "scenario", "band"), coverage(scenarios)
    if as_json:
        print_json([dict(zip(heads, row, strict=True)) for row in rows])
    else:
        print_table(heads, [(row[0] or "-", *row[1:]) for row in rows])


def _write_refusal(junit: Path | None, scenarios: list[str], reason: str) -> None:
    """Whoever reads the JUnit file must not find an earlier one there."""
    if junit is not None:
        from bridge.runs.check import refused_xml

        write_text(junit, refused_xml(scenarios, reason))
