"""The derivative time that a relay's loop on a rig needs, by (5.22) with hold and delay.

The edge of (5.22) knows no sampling. To first order a dead time takes from the lead of the switching line what it
lasts, so a loop that samples needs the T_d of (5.22) + delay + half a period. Below it the swing grows the more lead is
missing; above, it is the travel during the dead time. The lag of the valve is in neither.
"""

from typing import Any

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.controllers import Relay
from bridge.scenario.gains import law_gains
from bridge.studies.stability.equivalent import drive_of
from controller.law import RelayGains
from controller.stability.actuator.relay import critical_derivative_time


def relay_of(scenario: Scenario) -> RelayGains:
    """The scenario's law. Raises ScenarioError for another kind."""
    if not isinstance(scenario.controller, Relay):
        raise ScenarioError(f"controller.kind {scenario.controller.kind!r}; set controller.kind = 'relay'")
    found: Any = law_gains(scenario)
    return found


def critical_lead(scenario: Scenario) -> float:
    """T_d [s] of (5.22) on the scenario's rig, without hold, delay and the valve's lag."""
    return critical_derivative_time(drive_of(scenario))


def needed_lead(scenario: Scenario, period: float, delay: float) -> float:
    """T_d [s] of (5.22) and what hold and delay take from it."""
    return critical_lead(scenario) + delay + 0.5 * period
