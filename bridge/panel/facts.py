"""What a page is told of a run at its beginning."""

from typing import Any

from bridge.panel.picture import Picture
from bridge.panel.run import Run
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.scenario.fault_kinds import Kind
from bridge.scenario.faults import PROCESS_OF, targets
from bridge.scenario.fitted import is_motor
from bridge.scenario.units import shown
from twin.topology import CHANNELS


def facts_of(run: Run, picture: Picture | None) -> dict[str, Any]:
    """Names, picture, plots, and what can go wrong."""
    scenario, manifest = run.scenario, run.rig.manifest
    return {
        "rig": scenario.rig_name,
        "name": scenario.name,
        "title": scenario.title or scenario.name,
        "mode": manifest["mode"],
        "turns": is_motor(scenario.rig_values()),
        "svg": picture.svg if picture else "",
        "motion": picture.motion if picture else None,
        "plots": plots_plain(run),
        "faults": faults_of(scenario),
    }


def plots_plain(run: Run) -> list[dict[str, Any]]:
    """The pictures of a run for the page."""
    values = run.scenario.rig_values()
    return [plot.plain(values) for plot in run.plots]


def faults_of(scenario: Scenario) -> list[dict[str, Any]]:
    """What can be injected, by target: kinds, and the numbers of each in the units that people read."""
    further = chosen(scenario)
    found = []
    for target, kinds in targets(scenario):
        group, _, name = target.partition(".")
        if group == PROCESS_OF:
            continue
        unit = CHANNELS[name].unit if group == "sensor" else further[name].unit if group == "channel" else ""
        found.append({"target": target, "kinds": [_kind(kind, known, unit) for kind, known in kinds.items()]})
    return found


def _kind(name: str, kind: Kind, unit: str) -> dict[str, Any]:
    sizes = [
        {"name": size_name, "unit": shown(own)[1], "needed": size.default is None, "words": size.words}
        for size_name, size in kind.sizes.items()
        for own in (unit if size.unit == "*" else size.unit,)
    ]
    return {"name": name, "words": kind.words, "sizes": sizes, "lasting": kind.lasting}
