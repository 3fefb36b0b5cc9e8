"""What a plant in real time does when its ticks come later than the scenario allows."""

from bridge.errors import RunError
from bridge.machine.clock import Overruns
from bridge.scenario import Scenario
from bridge.wire.messages import OnOverrun
from controller.grid import NS


def stop_where_late(overruns: Overruns, scenario: Scenario) -> None:
    """Raises RunError where ticks are later than allowed and the scenario wants to end then."""
    policy = scenario.real_time
    most = policy.overruns * scenario.ticks
    if policy.on_overrun == OnOverrun.STOP and overruns.beyond(most, policy.length * NS):
        raise RunError(
            f"{overruns.ticks} ticks came a period or more late, the worst by {overruns.worst / 1e6:.1f} ms: "
            f"real_time allows {most:g} (overruns), by at most {policy.length * 1e3:g} ms (length), "
            "and on_overrun is 'stop'"
        )
