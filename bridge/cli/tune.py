"""The verb tune."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCENARIO, SCHEDULER, WORKERS
from bridge.cli.outputs import own_folder, print_json
from bridge.cli.streams import said_when_interrupted
from bridge.cli.sweep import continuation, refuse_set_twice
from bridge.errors import RunError

if TYPE_CHECKING:
    from bridge.runs.tune.tune import Found, Wanted

VARY = Annotated[
    list[str] | None,
    typer.Option("--vary", metavar="NAME=LOW:HIGH", help="A number to choose, and its range; :log. Repeatable."),
]
MINIMISE = Annotated[str, typer.Option("--minimise", metavar="METRIC", help="What bands can name.")]
SUBJECT = Annotated[
    list[str] | None,
    typer.Option("--subject-to", metavar="BAND", help="What must be kept, such as 'overshoot <= 5 %'. Repeatable."),
]
RUNS = Annotated[int, typer.Option(min=30, max=100_000, help="Runs at most.")]
SEED = Annotated[int, typer.Option(min=0, help="Seed of the search.")]
RESULT = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", help="Scenario file to write. [default: runs/tune-TIME/tuned.toml]", show_default=False
    ),
]


def tune(
    scenario: SCENARIO,
    vary: VARY = None,
    minimise: MINIMISE = "rms error",
    subject_to: SUBJECT = None,
    changes: CHANGES = None,
    runs: RUNS = 200,
    seed: SEED = 1,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: RESULT = None,
    as_json: AS_JSON = False,
) -> None:
    """Find the values of a scenario that make a metric smallest, within bands.

    The result is a scenario file that extends this one; what is printed is of a run of that file. Beside it are all
    runs (.csv) and a picture (.png). Exit code 1: no run kept all bands. See docs/sweeps.md.
    """
    from bridge.runs.tune.varied import varied_of
    from bridge.scenario import load

    loaded = load(scenario, changes)
    varied = varied_of(vary or [], loaded)
    refuse_set_twice([one.name for one in varied], changes)
    from bridge.runs.tune.goal import goal_of
    from bridge.runs.tune.scenario_file import refuse_foreign

    goal = goal_of(minimise, subject_to or [])
    if output is not None:
        refuse_foreign(output)
    from bridge.runs.tune.tune import Wanted, refuse

    wanted = Wanted(loaded, varied, goal, runs, seed)
    refuse(wanted)
    path = output or own_folder("tune") / "tuned.toml"
    try:
        found = _tuned(wanted, path, workers, scheduler)
    finally:
        if output is None:
            with suppress(OSError):
                path.parent.rmdir()  # where nothing was found
    result = _verified(found, path, scenario, changes or []) if found.feasible else found.best.result
    _show(found, result, path, as_json)
    raise typer.Exit(not found.feasible)


def _tuned(wanted: "Wanted", path: Path, workers: int, scheduler: str | None) -> "Found":
    from bridge.runs.tune.tune import tune as search
    from bridge.studies.sweep.engine import Crew

    part = path.with_suffix(".part")
    with said_when_interrupted(continuation(path, part)):
        return search(wanted, part, Crew(workers, scheduler))


def _verified(found: "Found", path: Path, scenario: str, changes: list[str]) -> Any:
    """Write the scenario and run it as it stands there. Raises RunError where that gives something else."""
    from bridge.runs.sweep.point import run_of
    from bridge.runs.tune.scenario_file import write_scenario
    from bridge.scenario import load

    wanted = found.wanted
    pairs = zip(wanted.varied, found.best.values, strict=True)
    chosen = [f"{one.name}={one.text(value)}" for one, value in pairs]
    bands = ", ".join(limit.text for limit in wanted.goal.limits)
    words = f"the smallest {wanted.goal.objective.words}{f' within {bands}' if bands else ''}, seed {wanted.seed}"
    write_scenario(path, scenario, [*changes, *chosen], words)
    base = load(str(path)).model_dump(mode="json")
    result = run_of({"changes": []}, base, path.stem, [asked.words for asked in wanted.goal.measures])
    if not wanted.goal.feasible(result):
        raise RunError(f"{path}: runs otherwise than in the search: {result['reason'] or 'a band is not kept'}")
    return result


def _show(found: "Found", result: Any, path: Path, as_json: bool) -> None:
    from bridge.runs.tune.drawing import write_picture
    from bridge.runs.tune.table import plain, write_csv

    files = [path] if found.feasible else []
    files += [write_csv(found, path.with_suffix(".csv")), write_picture(found, path.with_suffix(".png"))]
    if as_json:
        print_json(plain(found, result) | {"files": [str(file) for file in files]})
        return
    _print(found, result)
    print("\n".join(map(str, files)))


def _print(found: "Found", result: Any) -> None:
    from bridge.cli.tables import print_table
    from bridge.runs.tune.table import failures, rows

    name = found.wanted.scenario.name
    print_table(("", name, "result" if found.feasible else "nearest"), rows(found, result))
    spent = "converged" if found.converged else "not converged: more --runs may find better"
    print(f"{len(found.trials)} runs, {spent}")
    if found.feasible:
        return
    print("\nNo run kept all bands; what fails least first:")
    print_table(("band", "kept in runs", "nearest"), failures(found))
    reasons = [trial.result["reason"] for trial in found.trials[1:] if trial.result["reason"]]
    if reasons:
        print(f"{len(reasons)} runs failed; the first: {reasons[0]}")
