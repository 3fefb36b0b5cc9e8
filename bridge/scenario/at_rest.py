"""What a drive is like at rest: pressures where it starts, and whether its counterbalance valves hold the load."""

from collections.abc import Iterator

from bridge.scenario.circuit import circuit_of, rest_of
from bridge.scenario.fitted import chamber_names
from bridge.scenario.model import Scenario
from bridge.scenario.supply_facts import Fact
from twin.accessory import between
from twin.circuit.equilibrium import holding_pressures
from twin.circuit.state import pressures, unflatten
from twin.counterbalance import Counterbalance
from twin.topology import CHAMBERS

PLACES_TRIED = 17  # over the stroke, for the heaviest one
USUAL = 1.3  # setting of a counterbalance valve over the load's pressure, as data sheets have it


def rest_facts(scenario: Scenario) -> list[Fact]:
    """Pressures of the chambers where the run starts, friction left out."""
    at = pressures(unflatten(rest_of(scenario)))
    names = chamber_names(scenario.rig_values())
    said = ", ".join(
        f"{tap} {names[chamber]} {_bar(pressure)}"
        for tap, chamber, pressure in zip(("p2", "p3"), CHAMBERS, (at.lower, at.upper), strict=True)
    )
    place = scenario.start.position
    return [Fact(f"at rest at {place * 1e3:g} mm, friction left out", said)]


def holding_warnings(scenario: Scenario) -> list[str]:
    """A sentence for each counterbalance valve whose setting is below the pressure of the load on it."""
    return [
        f"rig.{name}.setting {_bar(valve.setting)} is below the load's pressure, {_bar(most)} at {place * 1e3:.4g} mm: "
        f'the valve does not hold it and the load sinks; {USUAL:g} times that is usual, "{USUAL * most / 1e5:.3g} bar"'
        for name, valve, most, place in _held(scenario)
        if valve.setting < most
    ]


def _held(scenario: Scenario) -> Iterator[tuple[str, Counterbalance, float, float]]:
    """Each counterbalance valve, the greatest pressure [Pa] that the load makes in its chamber, and where."""
    circuit = circuit_of(scenario)
    parts, necks = circuit.parts, between(circuit.parts.necks)
    places = [i / (PLACES_TRIED - 1) * parts.cylinder.stroke for i in range(PLACES_TRIED)]
    held = [(holding_pressures(parts.cylinder, parts.load, place, 0.0), place) for place in places]
    for name, chamber in (("accessory_a", "lower"), ("accessory_b", "upper")):
        if isinstance(valve := getattr(necks, name), Counterbalance):
            most, place = max((getattr(p, chamber), place) for p, place in held)
            yield name, valve, most, place


def _bar(pressure: float) -> str:
    return f"{pressure / 1e5:.4g} bar"
