"""The verb dimensionless: a scenario's drive in the numbers of the thesis's model, and back."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CHANGES, SCENARIO
from bridge.cli.outputs import print_json
from bridge.errors import UsageError, nearest

if TYPE_CHECKING:
    from bridge.scenario import Scenario
    from bridge.studies.stability.equivalent import Scaled

GIVEN = Annotated[
    list[str] | None,
    typer.Option("--at", metavar="NAME=NUMBER", help="Back to SI with another alpha, gamma, k, tau, delay, s or d."),
]
FRICTION = Annotated[float, typer.Option(min=0.0, help="Slope of the piston's friction [N s/m].")]


def dimensionless(
    scenario: SCENARIO = "step",
    changes: CHANGES = None,
    given: GIVEN = None,
    friction: FRICTION = 0.0,
    as_json: AS_JSON = False,
) -> None:
    """Convert a scenario's drive and controller to the thesis's alpha, gamma, k, tau, s and d, and back (--at).

    (5.7), (5.8): the rig stands as a symmetric drive with the same oil spring. With --at the other numbers stay those
    of the scenario, and so do mass, area, length and bulk modulus. `hydrotwin map --mark` and `hydrotwin figure --mark`
    show where it lies on a chart.
    """
    from bridge.scenario import load
    from bridge.studies.stability.equivalent import scaled

    checked = load(scenario, changes)
    try:
        found = _with(scaled(checked, friction), given or [])
    except ValueError as error:
        raise UsageError(str(error)) from None
    if as_json:
        print_json(_plain(found, checked))
    else:
        _print(found, checked)


def _with(found: "Scaled", given: list[str]) -> "Scaled":
    """With some of its numbers replaced, and SI units that follow."""
    from controller.stability.actuator.scaling import to_si

    replaced = {}
    for entry in given:
        name, sign, value = entry.partition("=")
        if name not in found.numbers._fields or not sign:
            raise UsageError(f"--at {entry!r}: write NAME=NUMBER{nearest(name, found.numbers._fields)}")
        try:
            replaced[name] = float(value)
        except ValueError:
            raise UsageError(f"--at {entry!r}: {value!r} is not a number") from None
    if not replaced:
        return found
    numbers = found.numbers._replace(**replaced)
    drive, loop = to_si(numbers, found.drive)
    return found._replace(numbers=numbers, drive=drive, loop=loop)


def _plain(found: "Scaled", scenario: "Scenario") -> dict[str, Any]:
    return {
        "scenario": found.scenario,
        "numbers": found.numbers._asdict(),
        "drive": found.drive._asdict(),
        "loop": found.loop._asdict(),
        "omega": _omega(found),
        "changes": _changes(found, scenario),
        "notes": list(found.notes),
    }


def _omega(found: "Scaled") -> float:
    from controller.stability.actuator.model import omega

    return omega(found.drive)


def _changes(found: "Scaled", scenario: "Scenario") -> list[str]:
    """What gives a scenario this controller, for --set."""
    loop = found.loop
    times = [f"loop.sample_period={loop.period!r} s", f"loop.delay={loop.delay!r} s"]
    if scenario.controller.kind == "relay":
        lead = loop.derivative / loop.gain if loop.gain else 0.0
        return [*times, f"controller.derivative_time={lead!r} s"]
    return [*times, f"controller.gain={loop.gain!r} 1/m", f"controller.derivative={loop.derivative!r} s/m"]


def _print(found: "Scaled", scenario: "Scenario") -> None:
    from bridge.cli.tables import print_table
    from controller.law import volts_per_percent

    n, drive, loop, rig = found.numbers, found.drive, found.loop, scenario.rig
    volts = [volts_per_percent(g, rig.cylinder.stroke, rig.valve.full_scale) for g in (loop.gain, loop.derivative)]
    rows = (
        ("alpha", n.alpha, "(p_s - p_r)/B", f"p_s {drive.supply / 1e5:.4g} bar, p_r {drive.relief / 1e5:.4g} bar"),
        ("gamma", n.gamma, "Q_max/(A L omega)", f"Q_max {drive.flow * 60e3:.4g} l/min, one land at p_s - p_r"),
        ("k", n.k, "K/(m omega)", f"K {drive.friction:.4g} N s/m"),
        ("tau", n.tau, "omega T", f"T {loop.period * 1e3:.4g} ms"),
        ("delay", n.delay, "delay/T", f"{loop.delay * 1e3:.4g} ms"),
        ("s", n.s, "P L", f"P {loop.gain:.4g} 1/m, {volts[0]:.4g} V/%"),
        ("d", n.d, "D L omega", f"D {loop.derivative:.4g} s/m, {volts[1]:.4g} V s/%"),
    )
    print_table(("", "number", "is", "in SI"), [(name, f"{value:.6g}", *rest) for name, value, *rest in rows])
    print(
        f"\n{found.scenario} as a symmetric drive: m {drive.mass:g} kg, A {drive.area * 1e4:.4g} cm2, L "
        f"{drive.length * 1e3:.4g} mm, B {drive.modulus / 1e5:.5g} bar, omega {_omega(found):.5g} rad/s"
    )
    for note in found.notes:
        print(note)
