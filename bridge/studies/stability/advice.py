"""What the theory says of a scenario's loop: critical gains, margins, how it would swing, and gains to take.

Linear, about the points of `plant`: friction, the card and large swings are not in it. Gains are also given in V per %
of the stroke, as a scenario writes them.
"""

import math
from collections.abc import Mapping
from typing import Any

from bridge.scenario import Scenario, ScenarioError
from bridge.scenario.gains import gains
from bridge.studies.stability.rig_loop import (
    Timing,
    margins_of,
    named,
    suggested,
    timing_of,
)
from bridge.studies.stability.rig_plant import RigPlant, plants
from controller.law import volts_per_percent
from controller.reference import evaluate
from controller.stability import Margins
from controller.stability.margins import GAIN_MARGIN

RULE = f"gain margin {GAIN_MARGIN:g} at the worst point; the patient gain tolerates one more sampling period of delay"
WORDS = {
    "stable": "stable",
    "unstable": "unstable",
    "between": "stable or unstable, depending on direction and amplitude",
}


def refuse_other_loops(scenario: Scenario) -> None:
    """Raises ScenarioError for a loop that the theory does not know."""
    law = scenario.controller.law
    if law != "pd":
        raise ScenarioError(f"controller.law {law!r}: the theory is that of 'pd'; set controller.law = 'pd'")
    if scenario.rig.valve.kind != "proportional":
        raise ScenarioError("rig.valve.kind 'switching' has no gain; set rig.valve.kind = 'proportional'")


def held(scenario: Scenario) -> Scenario:
    """The scenario, standing where its reference ends."""
    end = evaluate(scenario.reference.reference(), scenario.duration).position
    place = min(max(end, 0.0), scenario.rig.cylinder.stroke)
    return scenario.model_copy(update={"start": scenario.start.model_copy(update={"position": place})})


def plants_of(scenario: Scenario) -> dict[str, RigPlant]:
    """The plants about where the reference ends. Raises ScenarioError where the theory has no answer."""
    refuse_other_loops(scenario)
    try:
        return plants(held(scenario))
    except ValueError as error:
        raise ScenarioError(f"{scenario.name}: no linear model: {error}") from None


def advise(scenario: Scenario) -> dict[str, Any]:
    """Plain data. Raises ScenarioError where the theory has no answer."""
    found, timing, own = plants_of(scenario), timing_of(scenario), gains(scenario)
    of = {name: margins_of(p.plant(), timing, own.proportional, own.derivative) for name, p in found.items()}
    points = {name: _point(found[name].opening, timing, of[name], scenario) for name in found}
    least = min(named(margin.critical, timing).gain for margin in of.values())
    return {
        "scenario": scenario.name,
        "held_at": held(scenario).start.position,
        **timing._asdict(),
        "gain": _gain(own.proportional, scenario),
        "derivative_gain": _gain(own.derivative, scenario),
        "verdict": verdict(points),
        "points": points,
        "suggested": {
            "gain": _gain(least / GAIN_MARGIN, scenario),
            "patient": _gain(suggested([p.plant() for p in found.values()], timing, own.derivative), scenario),
            "rule": RULE,
        },
    }


def verdict(points: Mapping[str, Mapping[str, Any]]) -> str:
    """Of all points: stable at each, at none, or between."""
    good = [point["stable"] for point in points.values()]
    return "stable" if all(good) else "between" if any(good) else "unstable"


def _point(opening: float, timing: Timing, found: Margins, scenario: Scenario) -> dict[str, Any]:
    critical, swing = named(found.critical, timing), named(found.dominant, timing)
    return {
        "opening": opening,
        "critical_gain": _gain(critical.gain, scenario),
        "kind": critical.kind,
        "frequency": critical.frequency,
        "critical_derivative": _gain(found.derivative[1], scenario),
        "least_derivative": _gain(found.derivative[0], scenario),
        "gain_margin": _finite(found.gain_margin),
        "delay_margin": _finite(found.delay_margin * timing.period),
        "stable": found.stable,
        "swing": {"kind": swing.kind, "frequency": swing.frequency},
    }


def _gain(si: float, scenario: Scenario) -> dict[str, float | None]:
    """A gain in SI and in volts per %, of the second also times seconds; None where there is none."""
    rig = scenario.rig
    return {"si": _finite(si), "volts": _finite(volts_per_percent(si, rig.cylinder.stroke, rig.valve.full_scale))}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
