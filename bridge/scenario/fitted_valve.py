"""What the loop must know of the directional valve that a scenario fits."""

from typing import TYPE_CHECKING

from twin.rig_servo import LANDS

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

SIDES = (LANDS[:2], LANDS[2:])  # the lands that open upwards, and downwards


def overlap_of(scenario: "Scenario") -> float:
    """Dead band of the lands to either side, share of the travel: of a servo valve the smaller of both, 0 or more."""
    if scenario.rig.valve.kind != "servo":
        return scenario.rig.valve.overlap
    servo = scenario.rig.servo_valve
    bands = (max(getattr(servo, f"overlap_{land}") for land in lands) for lands in SIDES)
    return max(0.0, min(bands))


def power_off_of(scenario: "Scenario") -> float:
    """Spool position without power, share of the travel: where the safe state leads."""
    return scenario.rig.servo_valve.power_off if scenario.rig.valve.kind == "servo" else 0.0


def delay_of(scenario: "Scenario") -> float:
    """How long a command is under way inside the valve [s]."""
    return scenario.rig.servo_valve.delay if scenario.rig.valve.kind == "servo" else 0.0
