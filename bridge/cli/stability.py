"""Verbs about the stability of the sampled loop: advise, map."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import AS_JSON, CHANGES, MARK, SCENARIO, SCHEDULER, WORKERS
from bridge.cli.outputs import print_json
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.scenario import Scenario
    from bridge.studies.stability.advised import CycleAdvice

PAIR = "LOW:HIGH"
STEP = Annotated[
    list[str] | None, typer.Option("--step", metavar="LENGTH", help="Size of a step [default: 2, 20 and 60 mm].")
]
VERIFY = Annotated[bool, typer.Option("--verify", help="Search for each edge again, upwards from below.")]
RANGE = Annotated[str | None, typer.Option(metavar=PAIR, help="Range of the first axis.")]
OTHER_RANGE = Annotated[str | None, typer.Option(metavar=PAIR, help="Range of the other.")]
RIG = Annotated[
    str | None, typer.Option("--rig", metavar="SCENARIO", help="A scenario's rig: V/%, V s/%, ms, and runs of it.")
]
FIXED = Annotated[
    list[str] | None, typer.Option("--at", metavar="NAME=NUMBER", help="The other numbers, such as delay=0.5.")
]
RUNS = Annotated[int, typer.Option(min=0, max=100, help="Runs per side, with --rig or --simulate; 0 for none.")]
SIMULATE = Annotated[
    bool,
    typer.Option(
        "--simulate", help="Lay runs of the nonlinear dimensionless actuator over; --at alpha=, start=, limit=."
    ),
]
DERIVATIVE = Annotated[
    str, typer.Option(help="Derivative of the dimensionless controller: measured, backward or filtered.")
]
FILTER_TIME = Annotated[
    float | None, typer.Option(min=0.0, help="Lag of the filtered derivative, in sampling periods.")
]


def advise(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    steps: STEP = None,
    verify: VERIFY = False,
    as_json: AS_JSON = False,
) -> None:
    """Find the gains at which a scenario's loop settles, swings after every motion, or depends on the motion.

    The answer is the band of gains that settles about the scenario's own gain, or next to it, and what swings on either
    side. A reduced drive under the sampled law, with friction, saturation and card, says where to look. About each edge
    the twin itself runs at some 25 gains: above the quietest that swings, others may settle. --verify searches for
    the upper edges again, at other gains. The linear theory of the smallest motions stands beside it. See
    docs/stability.md.
    """
    from bridge.scenario import load

    checked = load(scenario, changes)
    from bridge.studies.stability.advice import advise as advice
    from bridge.studies.stability.advised import Advice

    found = advice(checked, _sizes(steps))
    if as_json and not verify:
        print_json(found.plain())
    elif not isinstance(found, Advice):
        _cycles(checked, found, verify, as_json)
    elif as_json:
        from bridge.studies.stability.verified import verified

        print_json(found.plain() | {"verified": [one.plain() for one in verified(checked, found.steps)]})
    else:
        from bridge.cli.advice import print_advice, print_verified

        print_advice(found)
        if verify:
            print_verified(checked, found)


def _sizes(steps: list[str] | None) -> tuple[float, ...]:
    """Sizes of steps [m]."""
    from bridge.scenario.units import quantity
    from bridge.studies.stability.amplitude import ASKED

    if not steps:
        return ASKED
    try:
        sizes = tuple(abs(float(quantity(step, "m"))) for step in steps)
    except ValueError as error:
        raise UsageError(f"--step: {error}") from None
    if not all(sizes):
        raise UsageError("--step 0 moves nothing; give a size such as '5 mm'")
    return sizes


def _cycles(scenario: "Scenario", found: "CycleAdvice", verify: bool, as_json: bool) -> None:
    """A relay's cycles, with the twin's beside them if it is to run."""
    from bridge.studies.stability.verified import verified_cycles

    runs = list(verified_cycles(scenario, found.cycles)) if verify else []
    if as_json:
        print_json(found.plain() | {"verified": [run.plain() for run in runs]})
    else:
        from bridge.cli.advice import print_cycles

        print_cycles(found, runs)


def map_stability(
    across: Annotated[str, typer.Argument(help="Axis: gain, derivative, period, delay or damping.")] = "period",
    up: Annotated[str, typer.Argument(help="The other axis.")] = "gain",
    x: RANGE = None,
    y: OTHER_RANGE = None,
    rig: RIG = None,
    about: Annotated[str, typer.Option(help="Point of the rig: rest, up or down. [default: rest]")] = "",
    changes: CHANGES = None,
    fixed: FIXED = None,
    cells: Annotated[int, typer.Option(min=2, max=1000, help="Cells of the theory, per side.")] = 120,
    runs: RUNS = 8,
    simulate: SIMULATE = False,
    derivative: DERIVATIVE = "measured",
    filter_time: FILTER_TIME = None,
    mark: MARK = None,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="Name of the files, without ending.")] = Path("map"),
    as_json: AS_JSON = False,
) -> None:
    """Draw a chart of stability over two numbers of the loop: OUTPUT.png, .csv, .html, and the runs' own .csv.

    Colours count the multipliers outside the unit circle, by linear theory: of the dimensionless actuator, over which
    --simulate lays runs of the nonlinear one; or of a scenario's rig (--rig), with runs of the full twin. Where such a
    run of the actuator and theory disagree, the cause is found and named. A theory that takes long says so, and Ctrl-C
    draws the columns that are there. Runs that are interrupted continue where they were.
    """
    from bridge.studies.stability.map import Wanted, make

    try:
        wanted = Wanted(
            across,
            up,
            x,
            y,
            rig,
            about,
            tuple(changes or ()),
            tuple(fixed or ()),
            cells,
            runs,
            simulate,
            derivative,
            filter_time,
            mark,
        )
        paths = make(wanted, output, workers, scheduler)
    except ValueError as error:
        raise UsageError(str(error)) from None
    if as_json:
        print_json([str(path) for path in paths])
    else:
        print("\n".join(str(path) for path in paths))
