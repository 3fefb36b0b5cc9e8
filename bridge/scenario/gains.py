"""The numbers of a scenario's control law in SI."""

from typing import TYPE_CHECKING

from bridge.errors import ScenarioError
from bridge.scenario.controllers import PdGains, Scale
from bridge.scenario.fitted_valve import overlap_of
from bridge.scenario.fmu_controller import FmuGains
from controller.law import CGains, Gains, OpenLoopGains, RelayGains, UserGains
from controller.pid import PidGains
from controller.state_space import StateSpaceGains

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario


def scale_of(scenario: "Scenario") -> Scale:
    """What turns V per % of stroke into spool per metre."""
    rig = scenario.rig
    return Scale(rig.cylinder.stroke, rig.valve.full_scale, overlap_of(scenario), scenario.loop.sample_period)


AnyGains = Gains | UserGains | PidGains | RelayGains | OpenLoopGains | StateSpaceGains | CGains | FmuGains


def law_gains(scenario: "Scenario") -> AnyGains:
    """What the scenario's law is given."""
    return scenario.controller.gains(scale_of(scenario))


def gains(scenario: "Scenario") -> Gains | UserGains:
    """The gains of a PD controller. Raises ScenarioError for another one."""
    if isinstance(scenario.controller, PdGains):
        return scenario.controller.gains(scale_of(scenario))
    raise ScenarioError(f"controller.kind {scenario.controller.kind!r} is not a PD; set controller.kind = 'pd'")
