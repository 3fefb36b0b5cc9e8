"""How quantities are shown."""

from twin.topology import PLACES, TANK, TAPS


def place_words(place: str) -> str:
    """A place of the circuit for people, with its taps: "tee, p1"."""
    words = PLACES[place].words if place in PLACES else TANK
    return ", ".join((words, *(tap for tap, at in TAPS.items() if at == place)))
