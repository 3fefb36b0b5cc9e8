"""The numbers of a scenario's control law in SI."""

from bridge.errors import ScenarioError
from bridge.scenario.controllers import Scale, WithGains
from bridge.scenario.model import Scenario
from controller.law import Gains, OpenLoopGains, RelayGains


def scale_of(scenario: Scenario) -> Scale:
    """What turns V per % of stroke into spool per metre."""
    rig = scenario.rig
    return Scale(rig.cylinder.stroke, rig.valve.full_scale, rig.valve.overlap, scenario.loop.sample_period)


def law_gains(scenario: Scenario) -> Gains | RelayGains | OpenLoopGains:
    """What the scenario's law is given."""
    return scenario.controller.gains(scale_of(scenario))


def gains(scenario: Scenario) -> Gains:
    """The gains of a PD controller. Raises ScenarioError for a controller without gains."""
    if isinstance(scenario.controller, WithGains):
        return scenario.controller.gains(scale_of(scenario))
    raise ScenarioError(f"controller.kind {scenario.controller.kind!r} has no gains; set controller.kind = 'pd'")
