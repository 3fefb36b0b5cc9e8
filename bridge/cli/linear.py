"""The verb linearise."""

import math
from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCENARIO
from bridge.cli.outputs import json_text, print_json, write_text

AT = Annotated[
    str, typer.Option("--at", help="rest, up or down (limits of slow motion), or a spool position, such as 0.3.")
]
FRICTION = Annotated[str, typer.Option(help="Viscous friction in place of the seal's, such as '500 N s/m'.")]
OUTPUT = Annotated[Path | None, typer.Option("-o", "--output", help="Write the model as JSON.")]


def linearise(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    at: AT = "rest",
    friction: FRICTION = "0 N s/m",
    output: OUTPUT = None,
    as_json: AS_JSON = False,
) -> None:
    """Write the linear model of a scenario's rig: A, B, C, D, names and units, continuous and as its loop samples it.

    The piston stands at start.position, or moves there slowly. The sampled model has the hold and the delay of the
    loop; what is on its way to the valve is in further states. docs/linear-model.md designs controllers with it.
    """
    from bridge.cli.tables import print_table
    from bridge.scenario import load
    from bridge.scenario.units import option

    loaded, slope = load(scenario, changes), option("friction", friction, "N s/m", least=0.0)
    from bridge.studies.linear_model import linear_model

    model = linear_model(loaded, at, slope)
    plain = model.plain()
    written = write_text(output, json_text(plain, 1) + "\n")
    if as_json:
        print_json(plain)
    else:
        print(f"{loaded.name} at {at}, piston at {loaded.start.position * 1e3:g} mm: {model.note}")
        print_table(("state", "there", "unit"), [_row(name, x) for name, x in model.at.items()])
        print()
        print_table(("pole [1/s]", "frequency [Hz]", "damping"), _poles(model.continuous.poles().tolist()))
        sampled = model.sampled
        print(f"sampled every {sampled.dt * 1e3:g} ms with {model.delay * 1e3:g} ms of delay: {sampled.nstates} states")
    raise typer.Exit(not written)


def _row(name: str, value: float) -> tuple[str, str, str]:
    from bridge.scenario.units import shown
    from bridge.studies.linear_model import UNITS

    factor, unit = shown(UNITS[name])
    return name, f"{value * factor:.6g}", unit


def _poles(poles: list[complex]) -> list[tuple[str, str, str]]:
    """From the slowest to the fastest, one of each pair."""
    rows = []
    for pole in sorted((p for p in poles if p.imag >= 0.0), key=abs):
        turning = pole.imag > 0.0
        text = f"{pole.real:.4g}" + (f" +- {pole.imag:.4g}j" if turning else "")
        damping = f"{-pole.real / abs(pole):.3g}" if turning else ""
        rows.append((text, f"{abs(pole) / math.tau:.4g}" if turning else "", damping))
    return rows
