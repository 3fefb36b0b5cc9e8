"""Verbs about scenarios: scenarios, schema, describe, convergence."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from bridge.cli.options import (
    AS_JSON,
    CHANGES,
    SCENARIO,
)
from bridge.cli.outputs import print_json
from twin.topology import PIPES

ALL_VALUES = Annotated[bool, typer.Option("--all", help="Print the values of what is not fitted, too.")]

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bridge.scenario import Scenario
    from bridge.scenario.describe import Value
    from bridge.scenario.of_run import Setting


def describe(
    scenario: SCENARIO = "step", changes: CHANGES = None, every: ALL_VALUES = False, as_json: AS_JSON = False
) -> None:
    """Print a scenario's circuit: parts, values with their sources, frequencies, travel times, limits of the step."""
    from bridge.cli.tables import print_table
    from bridge.scenario import load

    loaded = load(scenario, changes)
    from bridge.scenario.describe import (
        alarms,
        empty_slots,
        facts,
        faults,
        shown_values,
        slots_of,
        step_rows,
        timeline,
        values_of,
        warnings,
    )
    from bridge.scenario.of_run import settings_of
    from bridge.scenario.origins import origins
    from bridge.scenario.taps import TAP_HEADS, legend
    from bridge.scenario.text_picture import text_picture

    inherited = origins(scenario, changes or [])
    values, found, steps = values_of(loaded, inherited), facts(loaded), step_rows(loaded)
    settings, taps, slots = settings_of(loaded, inherited), legend(loaded), slots_of(loaded)
    parameters = _parameters(loaded)
    happens = {"timeline": timeline(loaded), "faults": faults(loaded), "alarms": alarms(loaded)}
    if as_json:
        plain = {
            "values": [v._asdict() for v in values],
            "facts": [f._asdict() for f in found],
            "step": _named(("part", "what", "time", "longest step"), steps),
            "settings": [s._asdict() for s in settings],
            "taps": _named(TAP_HEADS, taps),
            "warnings": warnings(loaded),
            "fitted": _named(("slot", "kind", "chosen by"), slots),
        }
        told = {name: [row._asdict() for row in rows] for name, rows in happens.items() if rows}
        print_json(plain | ({"parameters": parameters} if parameters else {}) | told)
        return
    print(text_picture(loaded.rig_values()))
    print_table(TAP_HEADS, taps)
    print()
    print_table(("slot", "what is fitted", "chosen by"), slots)
    if empty := empty_slots(loaded):
        print(f"not fitted: {', '.join(empty)}")
    print()
    shown = values if every else shown_values(loaded, inherited)
    print_table(("value", "", "", "source"), [(v.name, v.value, _mark(v), v.source) for v in shown])
    if not every:
        print(f"{len(values) - len(shown)} values of what is not fitted are left out; --all prints them")
    further = {
        ("of the run", "", "", "source"): [(s.name, s.value, _own(s), s.source) for s in settings],
        ("what follows", ""): found,
        ("part", "what is fast in it", "its time", "longest step that follows"): steps,
        ("parameter of the law, SI", ""): [(name, str(value)) for name, value in parameters.items()],
        **{HEADS[name]: rows for name, rows in happens.items()},
    }
    for heads, rows in further.items():
        if rows:
            print()
            print_table(heads, rows)
    for line in warnings(loaded):
        print(f"warning: {line}")


HEADS = {  # of what happens in a run
    "timeline": ("in the timeline", "what changes"),
    "faults": ("fault", "what goes wrong"),
    "alarms": ("alarm", "leads to"),
}


def _named(keys: tuple[str, ...], rows: "Iterable[tuple[Any, ...]]") -> list[dict[str, Any]]:
    return [dict(zip(keys, row, strict=True)) for row in rows]


def _own(value: "Value | Setting") -> str:
    """A star where the scenario itself says it, not one that it extends."""
    return "*" if value.changed and not value.origin else ""


def _mark(value: "Value") -> str:
    return _own(value) + ("" if value.fitted else " not fitted")


def _parameters(scenario: "Scenario") -> dict[str, Any]:
    """Those of a law of the user's, with what its module fills in; of others there are none."""
    if not hasattr(scenario.controller, "parameters"):
        return {}
    from bridge.loop.controller import ControllerSide
    from bridge.loop.parameters import plain

    return plain(ControllerSide(scenario, 0).gains.parameters)


def convergence(scenario: SCENARIO = "step", changes: CHANGES = None, as_json: AS_JSON = False) -> None:
    """Run a scenario at its step, a half and a quarter of it: error and order of each signal."""
    from bridge.cli.tables import print_table
    from bridge.scenario import load

    loaded = load(scenario, changes)
    from bridge.runs.convergence import convergence as compare

    rows = compare(loaded)
    if as_json:
        print_json([row.plain() for row in rows])
        return
    step = loaded.loop.step * 1e6
    print(f"{loaded.name} at {step:g}, {step / 2:g} and {step / 4:g} us; errors against the finest")
    print_table(("signal", "rms", "greatest", "order"), [row.words() for row in rows])
    if any(loaded.rig_values()[pipe]["model"] == "ends" for pipe in PIPES):
        print("lines of model ends are fitted anew to each step: what is left of the filters' own error does not fall")


def scenarios(as_json: AS_JSON = False) -> None:
    """List the built-in scenarios."""
    from bridge.cli.tables import print_table
    from bridge.scenario.files import listed, names

    rows = [(s.name, s.title, f"{s.duration:g} s", "; ".join(s.bands)) for s in map(listed, names())]
    keys = ("name", "title", "duration", "expects")
    if as_json:
        print_json([dict(zip(keys, row, strict=True)) for row in rows])
    else:
        print_table(keys, rows)


def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    from bridge.scenario import Scenario

    found: dict[str, Any] = Scenario.model_json_schema()
    print_json(found)
