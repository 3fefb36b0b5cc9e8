"""Verbs about faults: which there are, and one injected into a rig that runs."""

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CONFIG, CONNECT
from bridge.cli.outputs import print_json
from bridge.cli.tuning import RIG, asked, bus_of, pair
from bridge.errors import UsageError
from bridge.wire.link import DEFAULT_ENDPOINT

if TYPE_CHECKING:
    from bridge.scenario.fault_kinds import Kind

OF_CHANNEL = "of the channel"


def fault(
    rig: RIG,
    target: Annotated[str, typer.Argument(help="Such as link.command, sensor.p2, valve or pump.")] = "",
    kind: Annotated[str, typer.Argument(help="Such as delay, stuck or leak; `hydrotwin faults` lists them.")] = "",
    numbers: Annotated[
        list[str] | None, typer.Argument(help="Such as 'lasts=2 s', 'size=2 mm' or 'when=p2 > 60 bar'.")
    ] = None,
    end: Annotated[
        str | None, typer.Option(help="End the fault of this name now, and let it begin no more.", metavar="NAME")
    ] = None,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Inject a fault into a rig that runs, or end one; the recording keeps both, and a replay repeats them."""
    wanted = _wanted(target, kind, numbers or [], end)
    with bus_of(rig, connect, zenoh_config) as bus:
        found = asked(bus, "fault", json.dumps(wanted).encode())
    if as_json:
        print_json(found)
        return
    if "ended" in found:
        print(f"hydrotwin: {found['ended']!r} has ended at {found['at']:g} s: {found['what']}")
        return
    when = f"from {found['begins'][0]:g} s on" if found["begins"] else "once its condition comes"
    print(f"hydrotwin: {found['injected']!r}: {found['what']}, {when}")


def _wanted(target: str, kind: str, numbers: list[str], end: str | None) -> dict[str, str]:
    """The query. Raises UsageError."""
    if end is not None:
        if target:
            raise UsageError(f"--end {end!r} ends a fault that is there: leave out {target!r} and what follows it")
        return {"end": end}
    if not target or not kind:
        raise UsageError("name a target and a kind, such as `fault rig sensor.p2 stuck`, or --end and a fault's name")
    return {"target": target, "kind": kind, **dict(map(pair, numbers))}


def faults(
    scenario: Annotated[str, typer.Argument(help="Scenario whose drive is meant.")] = "step",
    as_json: AS_JSON = False,
) -> None:
    """List what can go wrong: targets, kinds, and the numbers of each."""
    from bridge.cli.tables import print_table
    from bridge.scenario import load
    from bridge.scenario.faults import targets

    table: dict[tuple[str, ...], tuple[list[str], dict[str, Kind]]] = {}
    for target, kinds in targets(load(scenario)):
        table.setdefault(tuple(kinds), ([], kinds))[0].append(target)
    rows = [(", ".join(names), name, kind) for names, kinds in table.values() for name, kind in kinds.items()]
    if as_json:
        print_json([_plain(*row) for row in rows])
        return
    shown = [
        ("" if row and rows[row - 1][0] == names else names, name, kind.words, _numbers(kind))
        for row, (names, name, kind) in enumerate(rows)
    ]
    print_table(("target", "kind", "what happens", "numbers"), shown)


def _plain(names: str, name: str, kind: "Kind") -> dict[str, Any]:
    numbers = {number: size._asdict() for number, size in kind.sizes.items()}
    return {"targets": names, "kind": name, "what": kind.words, "numbers": numbers}


def _numbers(kind: "Kind") -> str:
    units = {name: OF_CHANNEL if size.unit == "*" else size.unit for name, size in kind.sizes.items()}
    return ", ".join(f"{name} [{unit}]" if unit else name for name, unit in units.items())
