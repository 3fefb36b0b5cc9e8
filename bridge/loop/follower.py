"""A twin beside a rig as its partners see it: commands, scans and events in, estimates out. No clock, no network.

It is a pure function of the commands and the scans in the order of the grid: a block is integrated when the scan that
ends it has come and the command that it cannot do without; a command that does not come is waited for until the scans
are `PATIENCE` ahead. Commands go through the plant's own gate, watchdog and hold.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from bridge.errors import UsageError
from bridge.loop.health import HealthSide
from bridge.loop.inlet import Inlet
from bridge.scenario import Scenario, ScenarioError, check
from bridge.scenario.circuit import circuit_of
from bridge.wire.codec import Estimate as EstimateMessage
from bridge.wire.codec import Health as HealthMessage
from bridge.wire.codec import Innovation as InnovationMessage
from bridge.wire.estimates import DEVIATION, OF_UNKNOWN
from bridge.wire.messages import ALARMING, COMING, ESTIMATE, HEALTH, INNOVATION, EventKind, Outgoing, SafetyState
from controller.grid import NS, last_due
from controller.hold import Hold
from twin.estimation.filter import Estimate, Filter
from twin.estimation.health import Rules
from twin.estimation.quantities import UNKNOWNS, Standing
from twin.estimation.settings import Settings
from twin.sensors import card_of, put_out
from twin.topology import CHANNELS

COARSE = 100_000  # longest step of the twins [ns]: waves in the rig's lines are followed to some 1 kHz
PATIENCE = 20_000_000  # of simulated time [ns]: later commands act late
SILENCE = NS // 5  # without a command after joining [ns]
RETRY = NS // 2  # after a beginning it may be lost for so long before it begins anew [ns]
TIGHT = 1e18  # [Pa s/m^3], of a leak that is there and loses nothing
HEEDED = (EventKind.RESET, EventKind.RESUMED, EventKind.SAFE, *ALARMING)
LONGEST_GAP = 5 * NS  # without a scan; what was known before that is worth nothing


class Scan(NamedTuple):
    """What the card read."""

    tick: int
    stamp: int  # [ns]
    readings: dict[str, float]  # by channel


class Told(NamedTuple):
    """What a plant says of itself."""

    stamp: int  # [ns]
    is_safe: bool  # commands do not act
    spool: float  # reference in force


class FollowerSide:
    """One estimate of a rig, over as many runs of its plant as come."""

    def __init__(self, scenario: Scenario, settings: Settings, seed: int = 1, rules: Rules | None = None) -> None:
        """rules: of a judge of its health, if there is to be one. Raises UsageError where they do not fit the rig."""
        self.scenario = followed(scenario, leaks_outside=rules is not None)
        self.grid = self.scenario.loop.grid()
        self._settings, self._seed = settings, seed
        self._refuse_unknown()
        try:
            circuit = circuit_of(self.scenario)
            self.filter = Filter(circuit, card_of(self.scenario.daq), settings, seed)
        except ValueError as error:
            raise UsageError(f"follow: {error}") from None
        self.health = None if rules is None else HealthSide(self.filter, rules)
        self.published = {ESTIMATE: 0, INNOVATION: 0} | ({} if rules is None else {HEALTH: 0})
        self.latest: Estimate | None = None
        self.restarts = -1  # of the estimate, the first beginning not counted
        self._run_id: int | None = None
        self._forget(None)

    @property
    def run_id(self) -> int:
        """Of the plant that is followed; 0 before the first scan."""
        return self._run_id or 0

    @property
    def now(self) -> int:
        """Simulated time reached [ns]; -1 before the first scan."""
        return self._now

    @property
    def state(self) -> SafetyState:
        """How far the plant trusts its loop, as of the instant reached."""
        return self._inlet.state

    @property
    def limit(self) -> float:
        """How far commands act, of the spool's travel."""
        return self._inlet.limit

    def held(self) -> Hold:
        """What the valve is told, and what is to follow, as of the instant reached."""
        return self._inlet.held()

    def hear(self, measurement: Any) -> list[Outgoing]:
        """Take a scan; the messages of all corrections that it makes possible."""
        if measurement.run_id != self._run_id:
            self._forget(measurement.run_id)
        if measurement.stamp <= self._newest:
            return []
        self._newest = measurement.stamp
        readings = {name: float(getattr(measurement, name)) for name in CHANNELS}
        self._scans.append(Scan(measurement.tick, measurement.stamp, readings))
        return list(self._ready())

    def take(self, command: Any) -> list[Outgoing]:
        """Take a command; the messages of all corrections that had waited for it."""
        if self._run_id is None or command.run_id == self._run_id:
            self._commands.append(command)
        return list(self._ready())

    def heed(self, event: Any) -> None:
        """Take an event of the plant: its alarms and resets say what its valve is told."""
        if event.run_id == self._run_id and event.kind in HEEDED:
            self._events.append(event)

    def learn(self, told: Told) -> None:
        """Take what the plant says of itself: only one that joined in the middle does not know what led there."""
        if self._joined > 0 and told.stamp >= self._joined:
            self._told = told

    def finish(self) -> list[Outgoing]:
        """The messages of what is still waited for: nothing more comes."""
        return list(self._ready(patience=0))

    def _ready(self, patience: int = PATIENCE) -> Iterator[Outgoing]:
        while self._scans and (self._now < 0 or self._has_command(self._scans[0].stamp, patience)):
            yield from self._step(self._scans.pop(0))

    def _has_command(self, end: int, patience: int) -> bool:
        """May the block until an instant [ns] be integrated?"""
        self._offer()
        due = last_due(end, self.grid)
        waits = due is not None and due > self._inlet.answered and due > self._given_up and not self._inlet.safe
        return not waits or self._newest - end >= patience

    def _offer(self) -> None:
        """Give the plant's gate what it had by the instant reached."""
        while self._events and self._events[0].stamp <= self._now:
            event = self._events.pop(0)
            if event.kind == EventKind.RESET or (event.kind == EventKind.RESUMED and self._inlet.believed):
                self._inlet.reset(self._now)
            elif event.kind != EventKind.RESUMED:
                self._inlet.turn(event.command, event.kind in COMING, self._now)
        if self._told is not None and self._told.stamp <= self._now:
            if self._inlet.believe(self._told.is_safe, self._told.spool, self._now):
                self.filter.forget()  # so far commands were taken for what acts
            self._told = None
        known = [c for c in self._commands if c.sample_stamp <= max(self._now, 0)]
        self._commands = [c for c in self._commands if c.sample_stamp > max(self._now, 0)]
        for command in known:
            self._inlet.offer(command, max(self._now, 0))
        self._inlet.notes()

    def _step(self, scan: Scan) -> Iterator[Outgoing]:
        if self._now < 0:
            self._join(scan.stamp)
        if scan.stamp - self._now > LONGEST_GAP:
            self.filter.forget()
        self._integrate(scan.stamp)
        if self.filter.standing == Standing.WAITING:
            if self._knows_valve(scan.stamp):
                self._begin(scan)
            return
        if scan.readings and not all(map(math.isnan, scan.readings.values())):
            self.filter.look(scan.readings)
            if self.health is not None:
                self.health.look(scan.readings)
        self._inlet.watch_position(scan.stamp, scan.readings["position"])
        if (
            scan.tick % self._settings.every == 0
            or scan.stamp - self._corrected >= self._settings.every * self.grid.daq
        ):
            self._corrected = scan.stamp
            self.filter.correct()
            if self.filter.standing == Standing.LOST and scan.stamp - self._begun > RETRY:
                self._begin(scan)
            if self.filter.standing != Standing.WAITING:
                self.latest = self.filter.estimate(scan.stamp / NS)
                yield from self._messages(scan)

    def _knows_valve(self, stamp: int) -> bool:
        """At rest, or once a command acts, or when none has come for a while: the valve is centred then."""
        return self._joined == 0 or self._inlet.in_force or stamp - self._joined > SILENCE

    def _begin(self, scan: Scan) -> None:
        """Begin anew at a scan."""
        spool = self._reference(self._inlet.value)
        if self.filter.start(scan.readings, spool, scan.stamp // self.grid.step):
            self.restarts += 1
            self._begun = self._corrected = scan.stamp
            if self.health is not None:
                self.health.forget()

    def _join(self, stamp: int) -> None:
        """In the middle of a run: what was commanded before is not known, and not waited for."""
        self._given_up, self._joined, self._now = (stamp - 1 if stamp else -1), stamp, stamp
        self._offer()

    def _integrate(self, end: int) -> None:
        for segment in self._inlet.segments(self._now, end):
            if self.filter.standing != Standing.WAITING:
                steps = (segment.end - segment.begin) // self.grid.step
                self.filter.advance(self._reference(segment.value), steps)
                if self.health is not None:
                    self.health.advance(self._reference(segment.value), steps)
        self._now = end

    def _reference(self, value: float) -> float:
        daq = self.scenario.daq
        return put_out(value, daq.output_bits) if daq.quantise_output else value

    def _messages(self, scan: Scan) -> Iterator[Outgoing]:
        found = self.latest
        assert found is not None
        head = {"run_id": self.run_id, "tick": scan.tick, "stamp": scan.stamp}
        own = {"standing": int(found.standing), **_with_deviations(found.values, found.deviations)}
        unknowns = {name: found.unknowns.get(name, math.nan) for name in UNKNOWNS}
        spreads = {name: found.unknown_deviations.get(name, math.nan) for name in UNKNOWNS}
        own |= {f"{OF_UNKNOWN}{name}": value for name, value in _with_deviations(unknowns, spreads).items()}
        yield self._outgoing(ESTIMATE, scan.stamp, EstimateMessage, head | own)
        channels: dict[str, float] = {}
        for name, innovation in found.innovations.items():
            channels |= {name: innovation.away, name + DEVIATION: innovation.deviation}
            channels |= {f"{name}_use": float(innovation.use), f"{name}_nis": innovation.verdict.nis}
            channels |= {f"{name}_whiteness": innovation.verdict.whiteness}
        yield self._outgoing(INNOVATION, scan.stamp, InnovationMessage, head | channels)
        if self.health is not None and (told := self.health.take(found)) is not None:
            yield self._outgoing(HEALTH, scan.stamp, HealthMessage, head | told)

    def _outgoing(self, topic: str, stamp: int, kind: Any, fields: dict[str, Any]) -> Outgoing:
        sequence = self.published[topic]
        self.published[topic] = sequence + 1
        return Outgoing(topic, stamp, sequence, kind(sequence=sequence, **fields))

    def _forget(self, run_id: int | None) -> None:
        """A new run: nothing of the last one holds, but for what wanders slowly."""
        self._run_id = run_id
        self._inlet = Inlet(self.scenario, run_id or 0)
        self._scans: list[Scan] = []
        self._events: list[Any] = []
        self._told: Told | None = None
        kept = [] if run_id is None else [c for c in getattr(self, "_commands", []) if c.run_id == run_id]
        self._commands: list[Any] = kept
        self._now, self._newest, self._given_up, self._joined, self._begun, self._corrected = -1, -1, -1, -1, -1, -1
        self.filter.forget()
        if self.health is not None:
            self.health.forget()

    def _refuse_unknown(self) -> None:
        for name in self._settings.without:
            if name not in CHANNELS:
                raise UsageError(f"--without {name}: not a channel; there are {', '.join(CHANNELS)}")
            if name == "position":
                raise UsageError("--without position: an estimate begins with it; leave out others")
        if self._settings.every < 1:
            raise UsageError(f"--every {self._settings.every}: at least 1 scan")


def _with_deviations(values: dict[str, float], deviations: dict[str, float]) -> dict[str, float]:
    return {name + end: each[name] for name in values for end, each in (("", values), (DEVIATION, deviations))}


def warm_up(scenario: Scenario, settings: Settings, rules: Rules | None = None) -> None:
    """Load or compile all that a follower needs before anybody waits for it."""
    side = FollowerSide(scenario, settings, rules=rules)
    scan = dict.fromkeys(CHANNELS, 0.0) | {"position": side.scenario.start.position}
    side.filter.start(scan, 0.0, 0)
    side.filter.advance(0.0, max(1, round(2.0 * settings.settling / side.scenario.loop.step)))
    side.filter.look(scan)
    side.filter.correct()
    side.filter.estimate(0.0)
    if side.health is not None:
        side.health.warm_up()


def followed(scenario: Scenario, leaks_outside: bool = False) -> Scenario:
    """The scenario as a twin beside it knows it: without what is to happen, and with a longer step where that does.

    leaks_outside: of a cylinder that may begin to leak; one that is tight is built without such leaks.
    """
    data: dict[str, Any] = scenario.model_dump(mode="json") | {"timeline": [], "fault": [], "expect": []}
    if leaks_outside:
        cylinder = data["rig"]["cylinder"]
        cylinder |= {name: min(float(cylinder[name]), TIGHT) for name in ("outside_lower", "outside_upper")}
    known = check(data, scenario.name)
    grid = known.loop.grid()
    for step in range(COARSE, grid.step, -grid.step):
        if step % grid.step == 0 and grid.daq % step == 0 and grid.delay % step == 0:
            try:
                coarse = check(data | {"loop": data["loop"] | {"step": step / NS}}, scenario.name)
                circuit_of(coarse)
            except ScenarioError:
                continue
            return coarse
    return known
