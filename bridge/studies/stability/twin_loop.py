"""The loop where the reduced drive leaves something out, or is no quicker: runs of the twin itself take its place.

Each run is that of `twin_edge`, 20 s or more with one noise of the card, so an edge has no interval of its own but what
the search and `WIDER` leave; `twin_range` looks for edges with few of them, in a bounded time.
"""

from typing import NamedTuple

from bridge.scenario import Scenario
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import is_asked, is_system
from bridge.studies.stability.trial import Stand
from bridge.studies.stability.twin_edge import twin_swing
from controller.stability.amplitude.swing import Swing

OFTEN = 5e-3  # [s], a sampling period up to which a law that is asked takes as long in the reduced drive as in the twin
UNCOVERED = {  # part and word of the rig, and the values that the reduced drive covers
    ("accumulator", "kind"): ("none",),
    ("valve", "kind"): ("proportional", "switching"),
    ("accessory_a", "kind"): ("none",),
    ("accessory_b", "kind"): ("none",),
    ("cushion", "kind"): ("none",),
    ("check_valve", "kind"): ("none",),
    ("load", "kind"): ("mass", "environment", "lever"),
    ("friction", "kind"): ("seal", "stribeck", "none"),
}


class TwinLoop(NamedTuple):
    """The twin under the scenario's law."""

    scenario: Scenario
    on: Stand

    def swing(self, gain: float, size: float, seed: int) -> Swing:
        """The last third after a step of a size [m] at a free gain, with one noise of the card."""
        return twin_swing(self.scenario.model_copy(update={"seed": seed}), gain, size, self.on)


def uncovered(scenario: Scenario) -> list[str]:
    """What the drive has that the reduced drive leaves out, as "rig.accessory_a.kind = counterbalance"."""
    rig = scenario.rig_values()
    return [
        f"rig.{part}.{name} = {rig[part][name]}"
        for (part, name), covered in UNCOVERED.items()
        if rig[part][name] not in covered
    ]


def runs_alone(scenario: Scenario) -> bool:
    """Does the twin alone answer, since the reduced drive leaves something out, or takes as long?"""
    often = scenario.loop.sample_period <= OFTEN and is_asked(scenario)
    return bool(uncovered(scenario)) or (often and not is_system(scenario))


def twin_loop(scenario: Scenario) -> TwinLoop:
    """The loop, compiled and at rest."""
    return TwinLoop(scenario, stand_of(scenario))
