"""Does a load swing that a scenario's counterbalance valve lowers? Linear theory at one speed of lowering."""

from typing import NamedTuple

from bridge.scenario.circuit import circuit_of
from bridge.scenario.model import Scenario
from twin.accessory import between
from twin.circuit.lowering import held_by, lowering
from twin.circuit.lowering_swing import Swing, swings
from twin.counterbalance import Counterbalance
from twin.directional_valve import is_switching
from twin.kernel import interpreted

HALF, FULL, PLACE = 0.5, 1.0, 0.5  # openings of the directional valve, and the share of the stroke, looked at


class LoweringSwing(NamedTuple):
    """A steady motion through the valve of a port, and the fastest growing oscillation about it."""

    port: str
    opening: float  # share of the directional valve's travel; one that knows three positions is fully open
    speed: float  # [m/s], towards the chamber that the valve holds
    swing: Swing | None


def lowering_swings(scenario: Scenario) -> dict[str, LoweringSwing | str]:
    """For each counterbalance valve what theory says, or why it says nothing. Raises ScenarioError as `circuit_of`."""
    circuit, rig, found = circuit_of(scenario), scenario.rig_values(), {}
    opening = FULL if interpreted(is_switching)(circuit.parts.valve) else HALF
    for port in held_by(necks := between(circuit.parts.necks)):
        if not isinstance(getattr(necks, port), Counterbalance):
            continue
        try:
            place, spool = PLACE * circuit.parts.cylinder.stroke, -opening if port == "accessory_a" else opening
            at = lowering(circuit, place, spool)
            found[port] = LoweringSwing(port, opening, at.speed, next(iter(swings(at, rig, circuit)), None))
        except ValueError as error:
            found[port] = str(error)
    return found


def in_words(found: LoweringSwing | str) -> str:
    """For people."""
    if isinstance(found, str):
        return f"no prediction: {found}"
    if found.swing is None:
        return f"no oscillation at {found.speed * 1e3:.3g} mm/s"
    verb, opening = "grows by" if found.swing.growth > 0.0 else "dies by", "half" if found.opening == HALF else "fully"
    return (
        f"at {found.speed * 1e3:.3g} mm/s, {opening} open, a swing of {found.swing.frequency:.3g} Hz {verb} "
        f"{abs(found.swing.growth):.3g} 1/s"
    )
