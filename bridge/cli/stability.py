"""Verbs about the stability of the sampled loop: advise, map."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCENARIO, SCHEDULER, WORKERS
from bridge.cli.outputs import print_json
from bridge.errors import UsageError

if TYPE_CHECKING:
    from bridge.studies.stability.advice import Advice, GainInUnits, PointAdvice

PAIR = "LOW:HIGH"


def advise(scenario: SCENARIO = "step", changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Find the stable gains of a scenario's loop: critical gains, margins, predicted oscillation, suggested gains.

    By linear theory about the rig's own points of rest and slow motion; what it leaves out is in docs/stability.md.
    """
    from bridge.scenario import load

    checked = load(scenario, changes)
    from bridge.studies.stability.advice import advise as advice

    found = advice(checked)
    if as_json:
        print_json(found.plain())
    else:
        _print(found)


def _print(found: "Advice") -> None:
    from bridge.cli.tables import print_table

    timing = found.timing
    print(
        f"{found.scenario}: P {found.gain.volts:.4g} V/%, D {found.derivative_gain.volts:.4g} V s/% "
        f"({timing.derivative}), sampled every {timing.period * 1e3:g} ms, delay {timing.delay * 1e3:g} ms, "
        f"held at {found.held_at * 1e3:g} mm"
    )
    print(f"By linear theory the loop is {found.verdict.words}.\n")
    heads = ("about", "opening", "critical P", "gain margin", "delay margin", "stable D", "starts as", "at these gains")
    print_table(heads, [_row(name, point) for name, point in found.points.items()])
    suggested = found.suggested
    gain, patient = _volts(suggested.gain, "V/%"), _volts(suggested.patient, "V/%")
    print(f"\nsuggested P: {gain}, patient {patient} ({suggested.rule})")


def _row(name: str, point: "PointAdvice") -> tuple[str, ...]:
    swing, margin, late = point.swing, point.gain_margin, point.delay_margin
    low, high = point.least_derivative.volts, point.critical_derivative.volts
    width = "none" if low is None else f"{low:.3g} to {'any' if high is None else f'{high:.3g}'} V s/%"
    now = "dies away" if point.stable else f"{swing.kind}, {swing.frequency:.3g} Hz"
    return (
        name,
        f"{point.opening * 1e2:.2g} %",
        _volts(point.critical_gain, "V/%"),
        "-" if margin is None else f"{margin:.3g}",
        "long" if late is None else f"{late * 1e3:.3g} ms",
        width,
        f"{point.kind}, {point.frequency:.3g} Hz",
        now,
    )


def _volts(gain: "GainInUnits", unit: str) -> str:
    return "none" if gain.volts is None else f"{gain.volts:.4g} {unit}"


def map_stability(
    across: Annotated[str, typer.Argument(help="Axis: gain, derivative, period, delay or damping.")] = "period",
    up: Annotated[str, typer.Argument(help="The other axis.")] = "gain",
    x: Annotated[str | None, typer.Option(metavar=PAIR, help="Range of the first axis.")] = None,
    y: Annotated[str | None, typer.Option(metavar=PAIR, help="Range of the other.")] = None,
    rig: Annotated[
        str | None, typer.Option("--rig", metavar="SCENARIO", help="A scenario's rig: V/%, V s/%, ms, and runs of it.")
    ] = None,
    about: Annotated[str, typer.Option(help="Point of the rig: rest, up or down. [default: rest]")] = "",
    changes: CHANGES = None,
    fixed: Annotated[
        list[str] | None, typer.Option("--at", metavar="NAME=NUMBER", help="The other numbers, such as delay=0.5.")
    ] = None,
    cells: Annotated[int, typer.Option(min=2, max=1000, help="Of the theory, per side.")] = 120,
    runs: Annotated[int, typer.Option(min=0, max=100, help="Runs per side, with --rig or --simulate; 0 for none.")] = 8,
    simulate: Annotated[
        bool,
        typer.Option(
            "--simulate", help="Lay runs of the nonlinear dimensionless actuator over; --at alpha=, start=, limit=."
        ),
    ] = False,
    derivative: Annotated[
        str, typer.Option(help="Of the dimensionless controller: measured, backward or filtered.")
    ] = "measured",
    filter_time: Annotated[
        float | None, typer.Option(min=0.0, help="Of the filtered derivative, in sampling periods.")
    ] = None,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="Name of the files, without ending.")] = Path("map"),
    as_json: AS_JSON = False,
) -> None:
    """Draw a chart of stability over two numbers of the loop: OUTPUT.png, .csv, .html, and the runs' own .csv.

    Colours count the multipliers outside the unit circle, by linear theory: of the dimensionless actuator, over which
    --simulate lays runs of the nonlinear one; or of a scenario's rig (--rig), with runs of the full twin. Where such a
    run of the actuator and theory disagree, the cause is found and named. An interrupted map continues where it was.
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
        )
        paths = make(wanted, output, workers, scheduler)
    except ValueError as error:
        raise UsageError(str(error)) from None
    if as_json:
        print_json([str(path) for path in paths])
    else:
        print("\n".join(str(path) for path in paths))
