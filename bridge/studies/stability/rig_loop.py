"""The sampled loop of a rig's plant: between the SI units and seconds of a scenario and `controller.stability`.

There a delay and a filter time are counted in sampling periods and an oscillation in angles; here gains are 1/m and
s/m, times s, frequencies Hz.
"""

import math
from typing import NamedTuple

from bridge.scenario import Scenario, ScenarioError
from bridge.scenario.controllers import Fmu, InC, StateSpace, WithVelocity
from bridge.scenario.fitted_valve import delay_of
from bridge.studies.stability.rig_plant import RigPlant
from controller.stability import (
    Margins,
    Onset,
    Plant,
    SampledLoop,
    Timing,
    closed,
    dominant,
    is_stable,
    loop_onset,
    margins,
    sampled_loop,
)
from controller.stability.amplitude.describing import held_speed

MOST_DAMPING, HALVINGS = 1e5, 16  # [N s/m], of what friction is compared with
LATEST = 5.0  # sampling periods, the longest further delay that is looked at


class RigTiming(NamedTuple):
    """When the controller of a rig samples and acts, and where its velocity comes from; seconds."""

    period: float  # T [s]
    delay: float  # [s], may exceed T
    derivative: str  # "measured" | "backward" | "filtered"; "none" of a law without a derivative gain
    filter_time: float  # [s], of the filtered one

    def counted(self) -> Timing:
        """The same in sampling periods, as `controller.stability` takes it."""
        return Timing(self.period, self.delay / self.period, self.derivative, self.filter_time / self.period)


class Edge(NamedTuple):
    """Where a loop loses stability."""

    gain: float  # [1/m]; 0.0 if the smallest is too much, inf if it never does
    kind: str  # "none" | "fold" | "flip" | "Neimark-Sacker"
    frequency: float  # [Hz], that it starts with


def timing_of(scenario: Scenario) -> RigTiming:
    """The times of a controller, the delay with that of a servo valve. Raises ScenarioError for one without a loop."""
    own, period, delay = scenario.controller, scenario.loop.sample_period, scenario.loop.delay + delay_of(scenario)
    if isinstance(own, StateSpace | InC | Fmu):
        return RigTiming(period, delay, "none", 0.0)
    if not isinstance(own, WithVelocity):
        raise ScenarioError(f"controller.kind {own.kind!r} closes no loop; set controller.kind = 'pd'")
    return RigTiming(period, delay, own.velocity, own.filter_time)


def loop_of(plant: Plant, timing: RigTiming) -> SampledLoop:
    """The loop of a plant."""
    return sampled_loop(plant, timing.counted())


def edge_of(plant: Plant, timing: RigTiming, derivative: float) -> Edge:
    """The critical gain at a derivative gain [s/m]."""
    return named(loop_onset(loop_of(plant, timing), derivative), timing)


def named(onset: Onset | None, timing: RigTiming) -> Edge:
    """An onset in Hz."""
    if onset is None:
        return Edge(math.inf, "none", 0.0)
    return Edge(onset.gain, onset.kind, onset.angle / (2.0 * math.pi * timing.period))


def margins_of(plant: Plant, timing: RigTiming, gain: float, derivative: float) -> Margins:
    """Its margins at gains [1/m], [s/m]; the delay margin is still in sampling periods."""
    return margins(plant, gain, derivative, timing.counted(), longest=LATEST)


def held_amplitude(point: RigPlant, timing: RigTiming, gain: float, derivative: float) -> float | None:
    """Amplitude [m] up to which the seal's friction holds a swing that grows without it, by its describing function.

    None for a loop that is stable anyway, and for one that no damping calms.
    """

    def calm(damping: float) -> bool:
        return bool(is_stable(closed(loop_of(point.plant(damping), timing), gain, derivative)))

    low, high = 0.0, MOST_DAMPING
    if calm(low) or not calm(high) or point.friction == 0.0:
        return None
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if calm(middle) else (middle, high)
    swing = named(dominant(loop_of(point.plant(), timing), gain, derivative), timing)
    return held_speed(high, point.friction) / (2.0 * math.pi * swing.frequency) if swing.frequency else None
