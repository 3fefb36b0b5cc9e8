"""Verbs that write FMUs: fmu plant, fmu controller."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.catalogue import VERBS
from bridge.cli.options import AS_JSON, CHANGES, SCENARIO
from bridge.cli.outputs import print_json

if TYPE_CHECKING:
    from bridge.connect.fmu.made import Made
    from bridge.connect.fmu.platforms import Platform
    from bridge.scenario import Scenario

app = typer.Typer(help=VERBS["fmu"].words, no_args_is_help=True, add_completion=False)


class Fmi(StrEnum):
    """Versions of FMI."""

    TWO = "2"
    THREE = "3"


OUTPUT = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="The file; without it SCENARIO-plant.fmu or SCENARIO-controller.fmu."),
]
VERSION = Annotated[Fmi, typer.Option("--fmi", help="Version of FMI: 2 (2.0) or 3 (3.0).")]
PLATFORM = Annotated[
    list[str] | None,
    typer.Option(
        help="Machine that it runs on: x86_64-linux, aarch64-linux or x86_64-windows; without it this one. Others need "
        "ziglang. Repeatable."
    ),
]


@app.command()
def plant(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    output: OUTPUT = None,
    version: VERSION = Fmi.TWO,
    platform: PLATFORM = None,
    as_json: AS_JSON = False,
) -> None:
    """Write a scenario's plant as an FMU for co-simulation, compiled, without Python: docs/fmu.md.

    Inputs are the spool reference, the load's force, the pump's speed and what the timeline changes; outputs what the
    card reads, and the true state. Other numbers of the rig are tunable parameters. A C compiler links it.
    """

    def make(loaded: "Scenario", machines: "list[Platform]") -> "Made":
        from bridge.connect.fmu.plant import plant_fmu

        return plant_fmu(loaded, machines)

    _write("plant", scenario, changes, output, version, platform or [], as_json, make)


@app.command()
def controller(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    output: OUTPUT = None,
    version: VERSION = Fmi.TWO,
    platform: PLATFORM = None,
    as_json: AS_JSON = False,
) -> None:
    """Write a scenario's controller as an FMU for co-simulation, compiled, without Python: docs/fmu.md.

    Inputs are what the card reads and the reference; the output is the spool reference; gains are tunable parameters.
    It samples every loop.sample_period. Laws in C can be written, too; those in Python cannot. A C compiler links it.
    """

    def make(loaded: "Scenario", _: "list[Platform]") -> "Made":
        from bridge.connect.fmu.controller import controller_fmu

        return controller_fmu(loaded)

    _write("controller", scenario, changes, output, version, platform or [], as_json, make)


def _write(
    kind: str,
    which: str,
    changes: list[str] | None,
    output: Path | None,
    version: Fmi,
    names: list[str],
    as_json: bool,
    make: Any,
) -> None:
    from bridge.connect.fmu.platforms import compiler_for, platforms
    from bridge.scenario import load

    loaded, machines = load(which, changes), platforms(names)
    for machine in machines:
        compiler_for(machine)
    path = output or Path(f"{loaded.name}-{kind}.fmu")
    from bridge.connect.fmu.build import write_fmu

    made: Made = make(loaded, machines)
    write_fmu(made, loaded, version.value, machines, path)
    facts = {
        "file": str(path),
        "bytes": path.stat().st_size,
        "fmi": f"{version.value}.0",
        "platforms": [machine.name for machine in machines],
        "variables": {role: sum(v.role == role for v in made.variables) for role in {v.role for v in made.variables}},
    }
    if as_json:
        print_json(facts | {"variables": {role.lower(): n for role, n in sorted(facts["variables"].items())}})
        return
    inputs = ", ".join(v.name for v in made.variables if v.role == "INPUT")
    print(f"{path}: {facts['bytes']} bytes, FMI {facts['fmi']}, {', '.join(facts['platforms'])}")
    print(f"inputs: {inputs}")
