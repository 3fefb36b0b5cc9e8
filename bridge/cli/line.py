"""The verb `line`: waves in one pipe, or in one with a branch."""

from pathlib import Path
from typing import Annotated

import typer

from bridge.cli.options import AS_JSON
from bridge.cli.outputs import print_json

SCHEME = Annotated[
    str,
    typer.Option(
        help="moc; SPACE/TIME of cds3, cds5, fem, chebyshev and backward-euler, bdf2, esdirk3, esdirk4, esdirk5; "
        "ends, nodes, lumped (the rig's); exact."
    ),
]
BRANCH = Annotated[str | None, typer.Option(help="Length of a branch; scheme moc.")]
BRANCH_DIAMETER = Annotated[str | None, typer.Option(help="Inner diameter of the branch. [default: the pipe's]")]
BRANCH_AT = Annotated[str | None, typer.Option(help="Where the branch leaves the pipe. [default: the middle]")]
BRANCH_END = Annotated[str, typer.Option(help="Far end of the branch: closed or reservoir.")]
TOLERANCE = Annotated[str | None, typer.Option(help="Pressure; the esdirk pairs then choose their steps.")]
CAVITATION = Annotated[bool, typer.Option("--cavitation", help="Vapour cavities; scheme ends or nodes.")]


def line(
    length: Annotated[str, typer.Option(help="Length of the pipe.")] = "2.5 m",
    diameter: Annotated[str, typer.Option(help="Inner diameter.")] = "11 mm",
    oil: Annotated[str, typer.Option(help="rig: the oil of the rig.")] = "rig",
    temperature: Annotated[str, typer.Option(help="Temperature of the oil, -20 to 80 degC.")] = "40.07 degC",
    viscosity: Annotated[
        str | None, typer.Option(help="Viscosity in place of that of the oil, in m^2/s or mm^2/s.")
    ] = None,
    density: Annotated[str | None, typer.Option(help="Density in place of that of the oil.")] = None,
    speed: Annotated[
        str | None, typer.Option(help="Wave speed. [default: from oil, wall and Young's modulus]", show_default=False)
    ] = None,
    wall: Annotated[str, typer.Option(help="Thickness of the elastic wall.")] = "2 mm",
    young: Annotated[str, typer.Option(help="Young's modulus of the wall.")] = "210 GPa",
    left: Annotated[str, typer.Option(help="closed, reservoir, shut, open or push.")] = "shut",
    right: Annotated[str, typer.Option(help="The right end, as --left.")] = "reservoir",
    velocity: Annotated[str, typer.Option(help="From left to right, before shut or after open.")] = "1 m/s",
    pressure: Annotated[str, typer.Option(help="Pressure of a reservoir, and before a push.")] = "20 bar",
    rise: Annotated[str, typer.Option(help="Pressure added by a push.")] = "10 bar",
    closure: Annotated[str, typer.Option(help="Time to shut, open or push.")] = "1 ms",
    span: Annotated[str | None, typer.Option(help="Simulated time. [default: 20 wave travel times]")] = None,
    scheme: SCHEME = "moc",
    friction: Annotated[
        str,
        typer.Option(help="none, steady, quasi-steady, brunone, zielke, trikha, kagawa, schohl, fit or convolution."),
    ] = "fit",
    cells: Annotated[int, typer.Option(help="Cells along the pipe.")] = 50,
    step: Annotated[str | None, typer.Option(help="Time step of SPACE/TIME and of the rig's lines.")] = None,
    courant: Annotated[float, typer.Option(help="Courant number of moc, up to 1.")] = 1.0,
    tolerance: TOLERANCE = None,
    poles: Annotated[int, typer.Option(help="Poles of friction zielke.")] = 100,
    cavitation: CAVITATION = False,
    branch: BRANCH = None,
    branch_diameter: BRANCH_DIAMETER = None,
    branch_at: BRANCH_AT = None,
    branch_end: BRANCH_END = "closed",
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for line.png and line.csv.")] = Path(),
    as_json: AS_JSON = False,
) -> None:
    """Simulate waves in one pipe with any scheme, compared with the exact line: line.png, line.csv and a summary.

    With --branch three pipes meet at a junction.
    """
    from bridge.cli.tables import print_table
    from bridge.studies.line.case import LineOptions
    from bridge.studies.line.study import facts, study, write

    request = LineOptions(
        length, diameter, oil, temperature, viscosity, density, speed, wall, young, left, right, velocity, pressure,
        rise, closure, span, scheme, friction, cells, step, courant, tolerance, poles, cavitation,
        branch, branch_diameter, branch_at, branch_end,
    )  # fmt: skip
    found = study(request)
    paths = write(found, output)
    if as_json:
        print_json({"files": [str(path) for path in paths], "facts": dict(facts(found))})
        return
    print_table(("", ""), facts(found))
    print("\n".join(str(path) for path in paths))
