"""What a plant says on its terminal of what happens to it."""

from typing import Any

from bridge.loop.inlet import Inlet
from bridge.machine.narrator import Narrator
from bridge.wire.events import reason_of
from bridge.wire.messages import ALARMING, EventKind
from controller.grid import NS

PLAIN = (EventKind.RESET, EventKind.RESUMED, EventKind.DIFFERS, EventKind.ENDED, EventKind.FAULT)  # in their own words


class Telling:
    """One run of it."""

    def __init__(self, narrator: Narrator, is_live: bool) -> None:
        self._narrator = narrator
        self._is_live = is_live  # a reference that changes all the time is not told of
        self._told: set[str] = set()  # reasons of refusals that were said

    def tell(self, event: Any, inlet: Inlet) -> None:
        """Say what happens to the plant; of refusals the first of each reason."""
        when = f"t = {event.stamp / NS:g} s: "
        if event.kind == EventKind.REFUSED and (reason := reason_of(event)) not in self._told:
            self._told.add(reason)
            self._narrator.say(f"{when}command refused: {event.text}; further ones for this reason are only counted")
        if event.kind == EventKind.SAFE:
            self._narrator.say(f"{when}safe state, {_way_out(inlet)}: {event.text}")
        if event.kind == EventKind.CHANGED and not self._is_live:
            self._narrator.say(f"{when}{event.text}, from {event.apply_at / NS:g} s on")
        if event.kind in PLAIN:
            self._narrator.say(f"{when}{event.text}")
        if event.kind in ALARMING:
            self._narrator.say(f"{when}{event.kind}: {event.text}")


def _way_out(inlet: Inlet) -> str:
    if inlet.latched or not inlet.shut:
        return "leave with `hydrotwin reset`" if inlet.latched else "left by the first valid command"
    return "left by the first valid command once the alarm is gone, or with `hydrotwin reset`"
