"""How far a scenario's reference goes: past the stroke, or past what the card measures, it is likely a mistake."""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from controller.reference import Reference, evaluate

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

PLACES = 1001  # in the run, where the reference is looked at


@lru_cache(16)
def reach(reference: Reference, duration: float) -> tuple[float, float]:
    """Least and greatest position [m] that a reference asks for within a run [s]."""
    asked = [evaluate(reference, t).position for t in np.linspace(0.0, duration, PLACES).tolist()]
    return min(asked), max(asked)


def refuse_far(reference: Reference, duration: float, stroke: float) -> None:
    """Raises ValueError for a reference that is further outside the stroke [m] than that is long."""
    for place in reach(reference, duration):
        if not -stroke <= place <= 2.0 * stroke:
            raise ValueError(
                f"the reference goes to {place:g} m, and the stroke is from 0 to {stroke:g} m; a unit may be missing, "
                "as in '160 mm'"
            )


def reference_warnings(scenario: "Scenario") -> list[str]:
    """A sentence where the reference leaves the stroke, and where it leaves the card's range."""
    if not scenario.controller.follows:
        return []
    low, high = reach(scenario.reference.reference(), scenario.duration)
    stroke, card = scenario.rig.cylinder.stroke, scenario.daq.position_range
    found = []
    if low < 0.0 or high > stroke:
        found.append(
            f"the reference goes from {low * 1e3:g} to {high * 1e3:g} mm, the stroke from 0 to {stroke * 1e3:g} mm: "
            "the piston will be driven on to its stop"
        )
    if scenario.daq.clip and card < min(high, stroke):
        found.append(
            f"the reference goes to {high * 1e3:g} mm, and the card measures up to daq.position_range "
            f"{card * 1e3:g} mm: beyond, the controller sees {card * 1e3:g} mm and drives on; raise the range"
        )
    return found
