"""What the valve does in the safe state: `safety.on_trip`.

A ramp is a staircase with a stair per scan of the card. A retreat looks at the card's reading of the position.
"""

from bridge.scenario import Scenario
from bridge.scenario.fitted_valve import power_off_of
from bridge.wire.messages import OnTrip
from controller.grid import to_ns
from controller.hold import Hold

CENTRED = 0.0  # spool reference until somebody speaks


class Refuge:
    """Puts the values of the safe state into the hold of a plant's commands."""

    def __init__(self, scenario: Scenario, hold: Hold) -> None:
        self._hold = hold
        self._policy = scenario.safety
        self._grid = scenario.loop.grid()
        self._power_off = power_off_of(scenario)
        self._begin = 0  # of the retreat [ns]
        self._until = -1  # a command acts from then on [ns]; a retreat beyond it is over
        self._retreating = False

    @property
    def on_trip(self) -> OnTrip:
        """What it does."""
        return self._policy.on_trip

    @property
    def retreating(self) -> bool:
        """Does it wait for the piston?"""
        return self._retreating

    @property
    def moves_alone(self) -> bool:
        """Does the valve move though nobody has commanded anything yet?"""
        return self.on_trip == OnTrip.SHUT_OFF and self._power_off != CENTRED

    def take(self, at: int) -> None:
        """From an instant on [ns]."""
        self._begin, self._retreating = at, False
        if self.on_trip == OnTrip.RAMP:
            self._ramp(at)
        elif self.on_trip == OnTrip.RETREAT:
            self._retreating, self._until = True, 1 << 62
            self._hold.put(at, self._policy.retreat_spool or 0.0)
        else:
            self._hold.put(at, self._constant(at))

    def give_way(self, apply_at: int) -> None:
        """A command was taken that acts at an instant [ns]."""
        self._until = min(self._until, apply_at)

    def look(self, now: int, position: float) -> None:
        """After a scan [ns, m]: end a retreat that has come to its end."""
        if now >= self._until:
            self._retreating = False
        elif self._reached(position) or now - self._begin >= to_ns(self._policy.retreat_within):
            self._hold.insert(now, CENTRED)
            self._retreating = False

    def words(self, owned: bool) -> str:
        """The same for people; `owned`: a controller has spoken."""
        safety = self._policy
        if self.on_trip == OnTrip.HOLD:
            return f"the spool stays where it is told, {self._hold.value:g}"
        if self.on_trip == OnTrip.RAMP:
            return f"the spool to the centre within {safety.ramp:g} s"
        if self.on_trip == OnTrip.RETREAT:
            to = (safety.retreat_position or 0.0) * 1e3
            return f"the spool to {safety.retreat_spool:g} until the piston is at {to:g} mm"
        if self.moves_alone:
            return f"valve without power, spool to {self._power_off:g}"
        return "valve centred" if owned else "the valve stays centred"  # so whoever speaks first will be heard

    def _constant(self, at: int) -> float:
        if self.on_trip == OnTrip.HOLD:
            return self._hold.at(at)
        return self._power_off if self.on_trip == OnTrip.SHUT_OFF else CENTRED

    def _ramp(self, at: int) -> None:
        step, daq = self._grid.step, self._grid.daq
        begin, over = self._hold.at(at), max(step, round(to_ns(self._policy.ramp) / step) * step)
        self._hold.put(at, begin)
        for instant in range((at // daq + 1) * daq, at + over, daq):
            self._hold.put(instant, begin * (1.0 - (instant - at) / over))
        self._hold.put(at + over, CENTRED)

    def _reached(self, position: float) -> bool:
        to, spool = self._policy.retreat_position or 0.0, self._policy.retreat_spool or 0.0
        return position >= to if spool > 0.0 else position <= to if spool < 0.0 else True
