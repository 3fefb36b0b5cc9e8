"""What the pressure taps are in a drive: their names in measurements, pictures and bands, and where each is."""

from bridge.scenario.fitted import chamber_names, chamber_words, kind_of
from bridge.scenario.model import Scenario
from twin.topology import CHAMBERS, PLACES, TAPS

TAP_HEADS = ("measured", "in bands", "where", "reached by")
REACHED = {"lower": "port A, pipe_3", "upper": "port B, pipe_4"}


def legend(scenario: Scenario) -> list[tuple[str, str, str, str]]:
    """For each tap: its names in measurements and in bands, where it is, and by which port and line it is reached."""
    rig = scenario.rig_values()
    names, sides = chamber_names(rig), chamber_words(rig)
    at_tee = PLACES["tee"].words + ("" if kind_of(rig, "relief valve") == "none" else ", relief valve")
    where = {"tee": at_tee} | {place: f"{names[place]}, {sides[place]}" for place in CHAMBERS}
    between = "between pipe_1 and pipe_2"
    return [(tap, PLACES[at].pressure, where[at], REACHED.get(at, between)) for tap, at in TAPS.items()]
