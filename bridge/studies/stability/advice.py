"""What the theory says of a scenario's loop: critical gains, margins, how it would swing, and gains to take.

Linear, about the points of `plant`: friction, the card and large swings are not in it. Gains are also given in V per %
of the stroke, as a scenario writes them.
"""

import math
from collections.abc import Collection
from enum import StrEnum
from typing import Any, NamedTuple

from bridge.scenario import Scenario, ScenarioError
from bridge.scenario.gains import gains
from bridge.studies.stability.rig_loop import (
    RigTiming,
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


class Stability(StrEnum):
    """A loop about all its points."""

    STABLE = "stable"
    UNSTABLE = "unstable"
    BETWEEN = "between"

    @property
    def words(self) -> str:
        """For people."""
        return "stable or unstable, depending on direction and amplitude" if self is Stability.BETWEEN else self.value


class GainInUnits(NamedTuple):
    """A gain in two units, of a derivative also times seconds; None where there is none."""

    si: float | None  # [1/m], of a derivative [s/m]
    volts: float | None  # [V/%] of the stroke, of a derivative [V s/%]


class Oscillation(NamedTuple):
    """How a loop swings at its own gains."""

    kind: str  # "none" | "fold" | "flip" | "Neimark-Sacker"
    frequency: float  # [Hz]


class PointAdvice(NamedTuple):
    """The loop about one point of rest or slow motion; None stands for no limit, of derivative gains for no gain."""

    opening: float  # of the valve, -1 .. 1
    critical_gain: GainInUnits
    kind: str  # of the oscillation that starts at the critical gain
    frequency: float  # its own [Hz]
    critical_derivative: GainInUnits  # stable below
    least_derivative: GainInUnits  # stable above
    gain_margin: float | None
    delay_margin: float | None  # [s]
    stable: bool
    swing: Oscillation

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        gains = ("critical_gain", "critical_derivative", "least_derivative")
        inner = {name: getattr(self, name)._asdict() for name in (*gains, "swing")}
        return self._asdict() | inner


class Suggestion(NamedTuple):
    """Gains to take."""

    gain: GainInUnits
    patient: GainInUnits  # tolerates one more sampling period of delay
    rule: str

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {"gain": self.gain._asdict(), "patient": self.patient._asdict(), "rule": self.rule}


class Advice(NamedTuple):
    """What the theory says of a scenario's loop."""

    scenario: str
    held_at: float  # [m], where the reference ends
    timing: RigTiming
    gain: GainInUnits  # the scenario's own
    derivative_gain: GainInUnits
    verdict: Stability
    points: dict[str, PointAdvice]  # by the name of the point: rest, up, down
    suggested: Suggestion

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "scenario": self.scenario,
            "held_at": self.held_at,
            **self.timing._asdict(),
            "gain": self.gain._asdict(),
            "derivative_gain": self.derivative_gain._asdict(),
            "verdict": self.verdict,
            "points": {name: point.plain() for name, point in self.points.items()},
            "suggested": self.suggested.plain(),
        }


def refuse_other_loops(scenario: Scenario) -> None:
    """Raises ScenarioError for a loop that the theory does not know."""
    kind = scenario.controller.kind
    if kind != "pd":
        raise ScenarioError(f"controller.kind {kind!r}: the theory is that of 'pd'; set controller.kind = 'pd'")
    if scenario.rig.valve.kind != "proportional":
        raise ScenarioError("rig.valve.kind 'switching' has no gain; set rig.valve.kind = 'proportional'")


def at_reference_end(scenario: Scenario) -> Scenario:
    """The scenario with its start moved to where its reference ends."""
    end = evaluate(scenario.reference.reference(), scenario.duration).position
    place = min(max(end, 0.0), scenario.rig.cylinder.stroke)
    return scenario.model_copy(update={"start": scenario.start.model_copy(update={"position": place})})


def plants_of(scenario: Scenario) -> dict[str, RigPlant]:
    """The plants about where the reference ends. Raises ScenarioError where the theory has no answer."""
    refuse_other_loops(scenario)
    try:
        return plants(at_reference_end(scenario))
    except ValueError as error:
        raise ScenarioError(f"{scenario.name}: no linear model: {error}") from None


def advise(scenario: Scenario) -> Advice:
    """Margins and gains to take. Raises ScenarioError where the theory has no answer."""
    found, timing, own = plants_of(scenario), timing_of(scenario), gains(scenario)
    of = {name: margins_of(p.plant(), timing, own.proportional, own.derivative) for name, p in found.items()}
    points = {name: _point(found[name].opening, timing, of[name], scenario) for name in found}
    least = min(named(margin.critical, timing).gain for margin in of.values())
    patient = suggested([p.plant() for p in found.values()], timing, own.derivative)
    return Advice(
        scenario=scenario.name,
        held_at=at_reference_end(scenario).start.position,
        timing=timing,
        gain=_gain(own.proportional, scenario),
        derivative_gain=_gain(own.derivative, scenario),
        verdict=verdict([point.stable for point in points.values()]),
        points=points,
        suggested=Suggestion(_gain(least / GAIN_MARGIN, scenario), _gain(patient, scenario), RULE),
    )


def verdict(stable: Collection[bool]) -> Stability:
    """Of all points: stable at each, at none, or between."""
    return Stability.STABLE if all(stable) else Stability.BETWEEN if any(stable) else Stability.UNSTABLE


def _point(opening: float, timing: RigTiming, found: Margins, scenario: Scenario) -> PointAdvice:
    critical, swing = named(found.critical, timing), named(found.dominant, timing)
    return PointAdvice(
        opening=opening,
        critical_gain=_gain(critical.gain, scenario),
        kind=critical.kind,
        frequency=critical.frequency,
        critical_derivative=_gain(found.derivative[1], scenario),
        least_derivative=_gain(found.derivative[0], scenario),
        gain_margin=_finite(found.gain_margin),
        delay_margin=_finite(found.delay_margin * timing.period),
        stable=found.stable,
        swing=Oscillation(swing.kind, swing.frequency),
    )


def _gain(si: float, scenario: Scenario) -> GainInUnits:
    rig = scenario.rig
    return GainInUnits(_finite(si), _finite(volts_per_percent(si, rig.cylinder.stroke, rig.valve.full_scale)))


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
