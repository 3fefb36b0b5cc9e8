"""The edge of stability of the twin for one step: the smallest gain at which the piston goes on swinging.

The reference steps once; the run lasts 20 s, 200 sampling periods or 10 delays, whichever is longest. It swings if the
true position varies by more than 0.3 mm, peak to peak, in the last third. Such gains need not be one range: a louder
loop may settle where a quieter one does not. So the gain rises from far below, by 5 % at a time, until a run
swings, and the last interval is bisected.
"""

import math
from typing import Any

from bridge.scenario import Scenario
from bridge.scenario.references import Step
from bridge.studies.stability.probe import stand_of
from bridge.studies.stability.sampled_law import at_free, free_gain
from bridge.studies.stability.trial import Stand, trial
from controller.stability.amplitude.edges import Edge, Scan, lasting, smallest_swinging
from controller.stability.amplitude.swing import Swing, last_third

SCAN = Scan(ratio=1.05, tolerance=1.02, up=64.0, down=64.0, back=0.8)
AT = 1.0  # [s], when the reference steps


def stepped(scenario: Scenario, size: float) -> Scenario:
    """The scenario with one step of a size [m] from where it starts."""
    start, interval, tick = scenario.start.position, scenario.loop.sample_period, scenario.loop.daq_period
    at = interval * math.ceil(round(AT / interval, 9))
    length = lasting(interval, scenario.loop.delay)
    loop = scenario.loop.model_copy(update={"command_timeout": 10.0 * interval})
    update: dict[str, Any] = {
        "reference": Step(kind="step", start=start, end=start + size, at=at),
        "duration": tick * math.ceil(round(length / tick, 6)),
        "loop": loop,
    }
    return scenario.model_copy(update=update)


def twin_swing(scenario: Scenario, gain: float, size: float, on: Stand | None = None) -> Swing:
    """The twin's last third after a step of a size [m], at a free gain."""
    asked, factor = at_free(stepped(scenario, size), gain, free_gain(scenario))
    trace = trial(asked, on or stand_of(scenario), factor)
    return last_third(trace.time, trace.position)


def step_edge(scenario: Scenario, size: float, first: float, scan: Scan = SCAN) -> Edge:
    """The edge for a step of a size [m], scanned upwards from a gain `first` that had better be too low."""
    on = stand_of(scenario)
    return smallest_swinging(lambda gain: twin_swing(scenario, gain, size, on), first, scan)
