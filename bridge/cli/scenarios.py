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
    from bridge.scenario.origins import Origins


def describe(
    scenario: SCENARIO = "step", changes: CHANGES = None, every: ALL_VALUES = False, as_json: AS_JSON = False
) -> None:
    """Print a scenario's circuit: parts, values with their sources, frequencies, travel times, limits of the step."""
    from bridge.scenario import load

    loaded = load(scenario, changes)
    from bridge.scenario.origins import origins

    inherited = origins(scenario, changes or [])
    if as_json:
        print_json(_described(loaded, inherited))
    else:
        _print(loaded, inherited, every)


def _described(scenario: "Scenario", inherited: "Origins") -> dict[str, Any]:
    from bridge.scenario.describe import facts, slots_of, step_rows, values_of, warnings
    from bridge.scenario.of_run import settings_of
    from bridge.scenario.taps import TAP_HEADS, legend

    parameters = _parameters(scenario)
    plain = {
        "values": [v._asdict() for v in values_of(scenario, inherited)],
        "facts": [f._asdict() for f in facts(scenario)],
        "step": _named(("part", "what", "time", "longest step"), step_rows(scenario)),
        "settings": [s._asdict() for s in settings_of(scenario, inherited)],
        "taps": _named(TAP_HEADS, legend(scenario)),
        "warnings": warnings(scenario),
        "fitted": _named(("slot", "kind", "chosen by"), slots_of(scenario)),
    }
    told = {name: [row._asdict() for row in rows] for name, rows in _happens(scenario).items() if rows}
    return plain | ({"parameters": parameters} if parameters else {}) | told


def _print(scenario: "Scenario", inherited: "Origins", every: bool) -> None:
    from bridge.cli.tables import print_table
    from bridge.scenario.describe import empty_slots, shown_values, slots_of, values_of, warnings
    from bridge.scenario.taps import TAP_HEADS, legend
    from bridge.scenario.text_picture import text_picture

    print(text_picture(scenario.rig_values()))
    print_table(TAP_HEADS, legend(scenario))
    print()
    print_table(("slot", "what is fitted", "chosen by"), slots_of(scenario))
    if empty := empty_slots(scenario):
        print(f"not fitted: {', '.join(empty)}")
    print()
    values = values_of(scenario, inherited)
    shown = values if every else shown_values(scenario, inherited)
    print_table(("value", "", "", "source"), [(v.name, v.value, _mark(v), v.source) for v in shown])
    if not every:
        print(f"{len(values) - len(shown)} values of what is not fitted are left out; --all prints them")
    for heads, rows in _further(scenario, inherited).items():
        if rows:
            print()
            print_table(heads, rows)
    for line in warnings(scenario):
        print(f"warning: {line}")


def _further(scenario: "Scenario", inherited: "Origins") -> dict[tuple[str, ...], Any]:
    """Tables behind that of the values, by their heads."""
    from bridge.scenario.describe import facts, step_rows
    from bridge.scenario.of_run import settings_of

    settings = [(s.name, s.value, _own(s), s.source) for s in settings_of(scenario, inherited)]
    return {
        ("of the run", "", "", "source"): settings,
        ("what follows", ""): facts(scenario),
        ("part", "what is fast in it", "its time", "longest step that follows"): step_rows(scenario),
        ("parameter of the law, SI", ""): [(name, str(value)) for name, value in _parameters(scenario).items()],
        **{HEADS[name]: rows for name, rows in _happens(scenario).items()},
    }


def _happens(scenario: "Scenario") -> dict[str, Any]:
    from bridge.scenario.describe import alarms, faults, timeline

    return {"timeline": timeline(scenario), "faults": faults(scenario), "alarms": alarms(scenario)}


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
    """List the built-in scenarios.

    --json says what each expects, too.
    """
    from bridge.cli.tables import print_table
    from bridge.scenario.files import listed, names

    found = [*map(listed, names())]
    rows = [(s.name, s.title, f"{s.duration:g} s") for s in found]
    keys = ("name", "title", "duration")
    if as_json:
        bands = ("; ".join(s.bands) for s in found)
        print_json(
            [dict(zip((*keys, "expects"), (*row, words), strict=True)) for row, words in zip(rows, bands, strict=True)]
        )
        return
    print_table((*keys, "bands"), [(*row, str(len(s.bands) or "")) for row, s in zip(rows, found, strict=True)])


def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    from bridge.scenario import Scenario

    found: dict[str, Any] = Scenario.model_json_schema()
    print_json(found)
