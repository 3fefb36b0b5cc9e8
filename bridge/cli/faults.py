"""Verbs about faults: which there are, and one injected into a rig that runs."""

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import AS_JSON, CONFIG, CONNECT
from bridge.cli.outputs import print_json
from bridge.cli.tuning import RIG, asked, bus_of, pair
from bridge.wire.link import DEFAULT_ENDPOINT

if TYPE_CHECKING:
    from bridge.scenario.fault_kinds import Kind

OF_CHANNEL = "of the channel"


def fault(
    rig: RIG,
    target: Annotated[str, typer.Argument(help="Such as link.command, sensor.p2, valve or pump.")],
    kind: Annotated[str, typer.Argument(help="Such as delay, stuck or leak; `hydrotwin faults` lists them.")],
    numbers: Annotated[
        list[str] | None, typer.Argument(help="Such as 'lasts=2 s', 'size=2 mm' or 'when=p2 > 60 bar'.")
    ] = None,
    connect: CONNECT = DEFAULT_ENDPOINT,
    zenoh_config: CONFIG = None,
    as_json: AS_JSON = False,
) -> None:
    """Inject a fault into a rig that runs; the recording keeps it with its instant, and a replay repeats it."""
    wanted = {"target": target, "kind": kind, **dict(map(pair, numbers or []))}
    with bus_of(rig, connect, zenoh_config) as bus:
        found = asked(bus, "fault", json.dumps(wanted).encode())
    if as_json:
        print_json(found)
        return
    when = f"from {found['begins'][0]:g} s on" if found["begins"] else "once its condition comes"
    print(f"hydrotwin: {found['what']}, {when}")


def faults(
    scenario: Annotated[str, typer.Argument(help="Of this scenario's drive.")] = "step",
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
