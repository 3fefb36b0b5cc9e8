"""The verb identify."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCHEDULER, WORKERS, there
from bridge.cli.outputs import print_json, to_write
from bridge.cli.streams import said_when_interrupted
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.studies.identification.identify import Judged, Wanted
    from bridge.studies.sweep.engine import Crew

FILES = Annotated[list[Path] | None, typer.Argument(metavar="RUN.mcap", help="Recordings to fit.")]
FIT = Annotated[
    list[str] | None,
    typer.Option(
        "--fit",
        metavar="NAME",
        help="A number to fit, rig.load.mass or rig.load.mass=100:400kg. Repeatable, or commas.",
    ),
]
RIG = Annotated[
    str | None,
    typer.Option("--rig", metavar="SCENARIO", help="The rig to start with.  [default: that of the first recording]"),
]
JUDGE = Annotated[
    list[Path] | None, typer.Option("--judge", metavar="RUN.mcap", help="A recording to judge the fit on. Repeatable.")
]
PRIOR = Annotated[
    list[str] | None,
    typer.Option(
        "--prior", metavar="NAME=SHARE", help="How well a number is known before, rig.load.mass='5 %'. Repeatable."
    ),
]
NOISE = Annotated[
    list[str] | None,
    typer.Option(
        "--noise", metavar="SIGNAL=RMS", help="Noise of a signal, p2='0.05 bar'; a bare number is SI. Repeatable."
    ),
]
SEGMENT = Annotated[
    str | None,
    typer.Option(help="Simulate so long without looking at the data, '2 s'.  [default: as long as the twin follows]"),
]
MOVING = Annotated[
    bool, typer.Option("--only-moving", help="Leave out pressures of the chambers while the valve is shut.")
]
SUGGEST = Annotated[
    bool, typer.Option("--suggest", help="Fit nothing: write a scenario whose excitation tells the numbers best.")
]
DURATION = Annotated[str, typer.Option(help="With --suggest: how long it may take.")]
MOTION = Annotated[
    str | None, typer.Option(metavar="LOW:HIGH", help="With --suggest: where the rod may go, '50:220 mm'.")
]
PRESSURE = Annotated[str, typer.Option(help="With --suggest: the greatest pressure in chambers and at the tee.")]
TRIES = Annotated[int, typer.Option(min=1, max=100_000, help="With --suggest: excitations to try.")]
EACH = Annotated[
    bool, typer.Option("--each", help="Fit each number alone, then only the one that explains the recordings best.")
]
STARTS = Annotated[int, typer.Option(min=1, max=10_000, help="Starts of the fit.")]
RESULT = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Scenario file to write. [default: runs/identify-TIME/fitted.toml]"),
]
REPORT = Annotated[Path | None, typer.Option(help="HTML page to write.", metavar="PAGE.html")]


def identify(
    files: FILES = None,
    fit: FIT = None,
    rig: RIG = None,
    changes: CHANGES = None,
    judge: JUDGE = None,
    prior: PRIOR = None,
    noise: NOISE = None,
    segment: SEGMENT = None,
    only_moving: MOVING = False,
    each: EACH = False,
    starts: STARTS = 1,
    suggest: SUGGEST = False,
    duration: DURATION = "30 s",
    motion: MOTION = None,
    pressure: PRESSURE = "250 bar",
    tries: TRIES = 22,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: RESULT = None,
    report: REPORT = None,
    as_json: AS_JSON = False,
) -> None:
    """Fit numbers of a rig to recordings: the recorded commands through the twin, measured signals compared.

    The result is a scenario file that extends the rig. What is printed says how well each number is known, which the
    data cannot tell, and what the fit leaves of each signal, on recordings to judge it on as well. See
    docs/identify.md.
    """
    if suggest:
        limits = duration, motion, pressure
        _suggest(rig, changes or [], (fit or [], prior or []), limits, tries, (workers, scheduler), output, as_json)
        return
    if not files:
        raise UsageError("name the recordings to fit: hydrotwin identify run.mcap --fit rig.load.mass")
    there(*files, *(judge or []))
    from bridge.cli.fitted import refuse_foreign

    if output is not None:
        refuse_foreign(output)
    if each and starts > 1:
        raise UsageError("--each fits every number from the scenario's own values: leave out --starts")
    wanted, extends = _wanted(files, fit, rig, changes, judge, prior, noise, segment, only_moving)
    wanted = wanted._replace(each=each)
    from bridge.studies.sweep.engine import Crew

    with to_write(output, "identify", "fitted.toml") as path:
        found = _found(wanted, starts, path, Crew(workers, scheduler))
    _show(found, extends, changes or [], path, report, as_json)


def _wanted(
    files: Sequence[Path],
    fit: list[str] | None,
    rig: str | None,
    changes: list[str] | None,
    judge: list[Path] | None,
    prior: list[str] | None,
    noise: list[str] | None,
    segment: str | None,
    moving: bool,
) -> "tuple[Wanted, str]":
    from bridge.scenario.units import option
    from bridge.studies.identification.identify import Wanted, scenario_of
    from bridge.studies.identification.parameters import parameters_of, priors_of

    scenario, extends = scenario_of(rig, changes or [], [str(file) for file in files])
    parameters_of(fit or [], scenario, priors_of(prior or []))
    length = None if segment is None else option("segment", segment, "s", least=0.2)
    wanted = Wanted(
        tuple(map(str, files)), tuple(map(str, judge or [])), scenario.model_dump(mode="json"), tuple(fit or []),
        tuple(prior or []), tuple(map(_noise, noise or [])), length, moving,
    )  # fmt: skip
    return wanted, extends


def _noise(text: str) -> tuple[str, str]:
    """Signal, and what is said of it: which unit fits is known where recordings are read."""
    name, _, value = (part.strip() for part in text.partition("="))
    if not name or not value:
        raise UsageError(f"--noise {text!r}: write SIGNAL=RMS, such as p2='0.05 bar'")
    return name, value


def _suggest(
    rig: str | None,
    changes: list[str],
    numbers: tuple[list[str], list[str]],
    limits: tuple[str, str | None, str],
    tries: int,
    crew: tuple[int, str | None],
    output: Path | None,
    as_json: bool,
) -> None:
    """Write the scenario of the best excitation."""
    from bridge.cli.fitted import refuse_foreign
    from bridge.cli.suggested import asked_of, plain_suggestion, suggestion_rows, write_suggestion
    from bridge.cli.sweep import continuation
    from bridge.studies.identification.suggestion import suggest
    from bridge.studies.sweep.engine import Crew

    if rig is None:
        raise UsageError("name the rig to excite: --suggest --rig drive.toml")
    if output is not None:
        refuse_foreign(output)
    asked = asked_of(rig, changes, numbers, limits)
    with to_write(output, "identify", "excitation.toml") as path:
        part = path.with_suffix(".part")
        with said_when_interrupted(continuation(path, part)):
            found = suggest(asked, tries, part, Crew(*crew))
    write_suggestion(found, rig, changes, asked.duration, path)
    if as_json:
        print_json(plain_suggestion(found) | {"files": [str(path)]})
        return
    from bridge.cli.tables import print_table

    low, high, most = found.reached
    print(f"{found.words}: the best of {found.kept} within the limits, of {found.tried} that were tried")
    print(f"the rod goes from {low * 1e3:.4g} to {high * 1e3:.4g} mm, pressures up to {most / 1e5:.4g} bar")
    print_table(("number", "value", "error of a fit", "of the median candidate"), suggestion_rows(found))
    print(path)


def _found(wanted: "Wanted", starts: int, path: Path, crew: "Crew") -> "Judged":
    from bridge.cli.sweep import continuation
    from bridge.studies.identification.identify import identify as fitted

    part = path.with_suffix(".part")
    with said_when_interrupted(continuation(path, part)):
        return fitted(wanted, starts, part, crew)


def _show(found: "Judged", extends: str, changes: list[str], path: Path, report: Path | None, as_json: bool) -> None:
    from bridge.cli.fitted import plain, write_fitted

    files = [write_fitted(found, extends, changes, path)]
    if report is not None:
        from bridge.report.identification import write_page

        files.append(write_page(found, report))
    if as_json:
        print_json(plain(found) | {"files": [str(file) for file in files]})
        return
    _print(found)
    print("\n".join(map(str, files)))


def _print(found: "Judged") -> None:
    from bridge.cli.fitted import followed, number_rows, ranked_rows, residual_rows
    from bridge.cli.tables import print_table

    if found.ranked is not None:
        heads = ("each alone", "at first", "over short stretches", "times the noise left")
        print_table(heads, ranked_rows(found.ranked))
        print(f"{found.ranked.words}.\n")
    print_table(("number", "at first", "fitted", "95 % interval", "error", ""), number_rows(found))
    for line in _remarks(found):
        print(line)
    print(f"\n{followed(found)}")
    head = ("recording", "signal", "rms left", "of the motion", "times the noise")
    print_table((*head, "times the noise at first", ""), residual_rows(found))
    if found.judged:
        print("\nJudged on recordings that were not fitted:")
        print_table((*head, ""), residual_rows(found, True))


def _remarks(found: "Judged") -> list[str]:
    known: Any = found.known
    lines = [f"{one.words}." for one in known.untold]
    lines += [f"{a} and {b} hang together, correlation {r:.3f}." for a, b, r in known.strong]
    lines += [f"{e.parameter.name} stands at its limit." for e in known.estimates if e.at_limit]
    if known.robust:
        lines.append(
            "What is left is not noise, a part of the rig may be missing in the twin: the errors are those of numbers "
            "that differ from stretch to stretch."
        )
    if found.starts is not None:
        lines.append(f"{found.starts.words}.")
    records = [*found.found.task.records, *([] if found.held is None else found.held.task.records)]
    notes = [f"{r.name}: {note}." for r in records for note in r.told]
    return lines + notes + ([] if found.found.converged else ["The fit has not converged: start nearer."])
