"""Verbs of a valve's designer: valve static, chatter, seat, chart."""

from pathlib import Path
from typing import Annotated, Any

import typer

from bridge.cli.catalogue import VERBS
from bridge.cli.options import AS_JSON, CHANGES, SCHEDULER, WORKERS
from bridge.cli.outputs import print_json
from bridge.errors import UsageError

app = typer.Typer(help=VERBS["valve"].words, no_args_is_help=True, add_completion=False)
OUTPUT = Annotated[Path, typer.Option("--output", "-o", help="Folder for the picture and the table.")]
SCENARIO = Annotated[str, typer.Option("--scenario", help="Whose rig.")]
SEAT = Annotated[str, typer.Argument(help="chamfered or conical.")]
FLOW = Annotated[str, typer.Option(help="Flow into the volume before the seat.")]
PRECOMPRESSION = Annotated[str, typer.Option(help="Precompression of the spring.")]


@app.command()
def static(scenario: SCENARIO = "step", changes: CHANGES = None, output: OUTPUT = Path(), as_json: AS_JSON = False):
    """The static curve of the two-stage valve: setting, knee, openings, what shapes it, what it can tell."""
    from bridge.cli.tables import print_table
    from bridge.studies.valve.static import (
        combinations,
        draw,
        plain,
        rows,
    )
    from bridge.studies.valve.static import static as found_of

    found = _asked(lambda: found_of(_rig(scenario, changes)))
    paths = _save("valve-static", draw(found), output)
    if as_json:
        print_json(plain(found) | {"files": paths})
        return
    knee = found.knee
    print(f"pilot cracks at {knee.cracking / 1e5:.4f} bar, precompression {found.precompression * 1e3:.4f} mm")
    print(f"main stage opens at {knee.pressure / 1e5:.4f} bar, {knee.flow * 6e4:.5f} l/min\n")
    print("1 % of a parameter changes the set pressure (1 l/min) and the override (to 100 l/min) by [bar]:")
    print_table(("parameter", "set", "override", "known to, alone"), rows(found))
    print(f"\nthe curve tells {found.told.known} combinations to 10 % or better, read with half a step of the card:")
    print_table(("known to", "of ln(parameter)"), combinations(found.told))
    print("\n".join(paths))


@app.command()
def seat(
    kind: SEAT = "conical",
    lift: Annotated[str, typer.Option(help="Lift of the poppet.")] = "0.1 mm",
    drop: Annotated[str, typer.Option(help="Pressure drop.")] = "10 bar",
    speed: Annotated[str, typer.Option(help="Axial speed of the conical poppet; above 0 opens.")] = "0 m/s",
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    output: OUTPUT = Path(),
    as_json: AS_JSON = False,
) -> None:
    """A seat at a lift and a pressure drop: flow, loss, forces, damping; a warning where its law does not hold."""
    from bridge.scenario.units import option
    from bridge.studies.valve.chatter import law_of
    from bridge.studies.valve.seat import draw, facts, rows

    def answer() -> tuple[dict[str, Any], Any]:
        law_of(kind)
        rig, x, dp = _rig(scenario, changes), option("lift", lift, "m"), option("drop", drop, "Pa")
        return facts(kind, x, dp, rig, option("speed", speed, "m/s")), draw(kind, x, dp, rig)

    found, drawn = _asked(answer)
    _tell(found, rows(found), _save(f"valve-seat-{kind}", drawn, output), as_json)


@app.command()
def chatter(
    kind: SEAT = "chamfered",
    flow: FLOW = "0.3 l/min",
    precompression: PRECOMPRESSION = "0.23 mm",
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    output: OUTPUT = Path(),
    as_json: AS_JSON = False,
) -> None:
    """Predict chatter of seat, spring and volume (rig.chatter) at a flow: required and available damping, impacts."""
    from bridge.scenario.units import option
    from bridge.studies.valve.chatter import draw, facts, rows

    def answer() -> tuple[dict[str, Any], Any]:
        rig, q, x0 = (
            _rig(scenario, changes),
            option("flow", flow, "m^3/s"),
            option("precompression", precompression, "m"),
        )
        return facts(kind, q, x0, rig), draw(kind, q, x0, rig)

    found, drawn = _asked(answer)
    _tell(found, rows(found), _save(f"valve-chatter-{kind}", drawn, output), as_json)


@app.command()
def chart(
    kind: SEAT = "chamfered",
    precompression: PRECOMPRESSION = "0.23 mm",
    flows: Annotated[str, typer.Option(help="Range of q.", metavar="LOW:HIGH")] = "0.01:0.5",
    dampings: Annotated[str, typer.Option(help="Range of k.", metavar="LOW:HIGH")] = "0.0001:0.02",
    cells: Annotated[int, typer.Option(min=2, max=2000, help="Runs per side.")] = 100,
    workers: WORKERS = 0,
    scheduler: SCHEDULER = None,
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    output: OUTPUT = Path(),
    as_json: AS_JSON = False,
) -> None:
    """A chart of flow and damping by runs with impacts: calm, swinging freely, hitting the seat.

    An interrupted chart continues where it was (valve-chart-SEAT.part in the folder).
    """
    import numpy as np

    from bridge.scenario.units import interval, option
    from bridge.studies.sweep.engine import Crew
    from bridge.studies.valve.chart import draw
    from bridge.studies.valve.chatter import law_of
    from twin.chatter.build import pilot_of
    from twin.chatter.physical import reference, system

    def answer() -> Any:
        law, pilot = law_of(kind), pilot_of(_rig(scenario, changes))
        x0 = option("precompression", precompression, "m")
        s = system(law, reference(law, pilot).flow, x0, pilot)
        q, k = (
            np.linspace(*interval(f"--{name}", text), cells)
            for text, name in ((flows, "flows"), (dampings, "dampings"))
        )
        output.mkdir(parents=True, exist_ok=True)
        return draw(kind, s, q, k, output / f"valve-chart-{kind}.part", Crew(workers, scheduler))

    paths = _save(f"valve-chart-{kind}", _asked(answer), output)
    if as_json:
        print_json(paths)
    else:
        print("\n".join(paths))


def _rig(scenario: str, changes: list[str] | None) -> Any:
    from bridge.scenario import load

    return load(scenario, changes).rig_values()


def _asked(answer: Any) -> Any:
    """The answer; a user's mistake as one line."""
    try:
        return answer()
    except ValueError as error:
        raise UsageError(str(error)) from None


def _save(name: str, drawn: Any, output: Path) -> list[str]:
    from bridge.drawing.files import save

    columns, page = drawn
    return [str(path) for path in save(name, columns, page, output)]


def _tell(found: dict[str, Any], rows: list[tuple[str, str]], paths: list[str], as_json: bool) -> None:
    from bridge.cli.tables import print_table

    if as_json:
        print_json(found | {"files": paths})
        return
    print_table(("", ""), rows)
    for line in found["warnings"]:
        print(f"warning: {line}")
    print("\n".join(paths))
