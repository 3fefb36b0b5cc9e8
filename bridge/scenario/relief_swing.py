"""Does the pilot of a scenario's relief valve oscillate by itself? Linear theory, at the flow over it at rest."""

from bridge.scenario.circuit import circuit_of
from bridge.scenario.model import Scenario
from twin.circuit.pilot_swing import SelfExcited, self_excited, swings_below


def swing_of(scenario: Scenario) -> SelfExcited | None:
    """What grows by itself; None where nothing does. Raises ScenarioError where the numbers make no circuit."""
    return self_excited(scenario.rig_values(), circuit_of(scenario))


def below_rest(scenario: Scenario) -> str:
    """Where a pilot that is calm at rest oscillates by itself, for people; empty where it never does."""
    found = swings_below(scenario.rig_values(), circuit_of(scenario))
    return f"below {found[0] * 6e4:.3g} l/min over the valve, at {found[1]:.0f} Hz; calm at rest" if found else ""


def in_numbers(found: SelfExcited) -> str:
    """Frequency, growth and range of flow, for people."""
    flows = f"from {found.least * 6e4:.3g} to {found.flow * 6e4:.3g} l/min"
    if found.least == 0.0:
        flows = f"up to {found.flow * 6e4:.3g} l/min, which pass at rest"
    return f"{found.frequency:.0f} Hz, growing by {found.growth:.3g} 1/s; {flows}"


def swing_notes(scenario: Scenario) -> list[str]:
    """A sentence where it oscillates; otherwise nothing."""
    found = swing_of(scenario)
    if found is None:
        return []
    return [
        f"the pilot of the relief valve oscillates by itself (linear theory): {in_numbers(found)}; other lengths of "
        "pipe_1 and pipe_2 change that"
    ]
