"""The plant as its partners see it: blocks of simulation between measurements, commands in, messages out.

No clock, no network: `tick` is called when it is time, `receive` when something has come. The in-process loop and the
plant process run this same code.
"""

from typing import Any

import numpy as np

from bridge.loop.line_profiles import LineProfiles
from bridge.loop.safety import Gate, Refusal, Watchdog
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.wire.codec import Event, FluidPressure, Header, JointState, Measurement, PlantState, Time, decode
from bridge.wire.messages import TOPICS, EventKind, Outgoing, Reason, refusal
from controller.grid import NS, last_due, to_ns
from controller.hold import Hold
from twin.circuit.block import compiled, run_block
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import flatten
from twin.sensors import NOISE_ROWS, Card, acquire, noise_block
from twin.topology import OBSERVED

SAFE = 0.0  # spool reference of the safe state: valve centred
Note = tuple[EventKind, int, int, int, int, str]  # kind, source, command, apply_at, applied_at, text
EVENTS_PER_REASON = 100  # refusals of one kind that are recorded one by one; all are counted


class PlantSide:
    """One run of the plant."""

    def __init__(self, scenario: Scenario, run_id: int) -> None:
        loop = scenario.loop
        self.scenario = scenario
        self.run_id = run_id
        self.grid = loop.grid()
        self.gate = Gate(run_id, self.grid)
        self.watchdog = Watchdog(to_ns(loop.command_timeout), self.grid, loop.after_timeout == "latch")
        self.hold = Hold(SAFE)
        self.tick_number = 0
        self.late = 0
        self.worst_lateness = 0
        self.published: dict[str, int] = {}
        self._viewer_ticks = max(1, round(loop.viewer_period * NS / self.grid.daq))
        circuit = circuit_of(scenario)
        self._circuit = compiled(circuit)
        self._state = flatten(equilibrium(circuit, scenario.start.position, scenario.start.p_upper))
        self._taps = np.zeros((2, 5))
        self._card = card_of(scenario)
        self._noise = noise_block(scenario.seed, 0)
        self._reading = np.zeros(5)
        self._observed = np.zeros(len(OBSERVED))
        self._lines = LineProfiles(run_id, self._circuit)
        self._notes: list[Note] = []
        acquire(self._taps, self._noise[0], self._card, loop.step, self._reading)  # compiled before the clock starts
        self._run(SAFE, 0)
        self.measurement: Any = None

    @property
    def now(self) -> int:
        """Simulated time reached [ns]."""
        return self.tick_number * self.grid.daq

    def start(self) -> list[Outgoing]:
        """The messages of tick 0: the rig at rest."""
        self._run(self.hold.value, 0)
        self._taps[0] = self._taps[1]
        self.note(EventKind.STARTED, f"scenario {self.scenario.name}, {self.scenario.duration:g} s")
        return self._messages()

    def awaited(self) -> int | None:
        """Stamp of the sample whose command the next block cannot do without; None when it has all."""
        due = last_due(self.now + self.grid.daq, self.grid)
        return due if due is not None and due > self.gate.last_sample else None

    def receive(self, payload: bytes, kind: str = "") -> Any:
        """Take a command from the wire; `kind` is the type it claims. The command if it was taken, else None."""
        try:
            if kind and kind != TOPICS["command"].type:
                raise ValueError(f"a message of type {kind!r}")
            command = decode(payload, "command")
        except ValueError as error:
            self._record_refusal(self.gate.refuse(Reason.UNDECODABLE, str(error)), 0, 0, 0)
            return None
        return command if self.take(command) else None

    def take(self, command: Any) -> bool:
        """Take a command; False when it was refused."""
        if self.watchdog.blocks():
            refused = self.gate.refuse(Reason.LATCHED, "the plant is in its safe state until reset")
        else:
            refused = self.gate.check(command, self.now)
        if refused is not None:
            self._record_refusal(refused, command.source, command.sequence, command.apply_at)
            return False
        if self.watchdog.safe:
            self.watchdog.clear()
            self.note(EventKind.RESUMED, "commands have resumed", command.source, command.sequence)
        if command.apply_at < self.now:
            self._record_late(command)
        self.hold.put(command.apply_at, command.spool)
        return True

    def reset(self) -> None:
        """Leave the safe state on somebody's word."""
        if self.watchdog.safe:
            self.watchdog.clear()
            self.gate.release(self.now)
            self.note(EventKind.RESET, "safe state left by reset")

    def tick(self, lean: bool = False) -> list[Outgoing]:
        """Integrate the block that has just passed and return its messages; `lean`: the measurement alone."""
        begin, end = self.now, self.now + self.grid.daq
        self._watch(begin, end)
        for segment in self.hold.segments(begin, end):
            steps = (segment.end - segment.begin) // self.grid.step
            self._run(segment.value, steps)
        self.gate.in_force = max(self.gate.in_force, self.hold.since)
        self.tick_number += 1
        return [self._measure()] if lean else self._messages()

    def finish(self, text: str) -> list[Outgoing]:
        """The last words."""
        self.note(EventKind.ENDED, text)
        return self._drain()

    def note(
        self, kind: EventKind, text: str, source: int = 0, command: int = 0, apply_at: int = 0, applied_at: int = 0
    ) -> None:
        """Record an event; it goes out, stamped, with the next messages."""
        self._notes.append((kind, source, command, apply_at, applied_at, text))

    def _run(self, reference: float, steps: int) -> None:
        run_block(self._state, reference, *self._circuit, steps, self._taps, self._observed)

    def _watch(self, begin: int, end: int) -> None:
        if self.gate.last_apply < 0 or self.watchdog.safe:
            return
        at = self.watchdog.trip_at(self.gate.last_apply)
        if at < end:
            at = max(at, begin)
            self.watchdog.trip()
            self.gate.release(at)
            self.hold.put(at, SAFE)
            timeout = self.watchdog.timeout / NS
            self.note(EventKind.SAFE, f"no command for {timeout:g} s: valve centred", applied_at=at)

    def _record_late(self, command: Any) -> None:
        self.late += 1
        behind = self.now - command.apply_at
        self.worst_lateness = max(self.worst_lateness, behind)
        text = f"acted {behind / 1e6:g} ms late"
        self.note(EventKind.LATE, text, command.source, command.sequence, command.apply_at, self.now)

    def _record_refusal(self, refused: Refusal, source: int, sequence: int, apply_at: int) -> None:
        count = self.gate.refused[refused.reason]
        if count <= EVENTS_PER_REASON:
            last = "; more of these are only counted" if count == EVENTS_PER_REASON else ""
            text = refusal(refused.reason, f"{refused.text}{last}")
            self.note(EventKind.REFUSED, text, source, sequence, apply_at)

    def _count(self, topic: str) -> int:
        sequence = self.published.get(topic, 0)
        self.published[topic] = sequence + 1
        return sequence

    def _messages(self) -> list[Outgoing]:
        out = [self._measure(), self._true_state()]
        if self.tick_number % self._viewer_ticks == 0:
            out += self._viewer_messages()
        return out + self._drain()

    def _drain(self) -> list[Outgoing]:
        notes, self._notes = self._notes, []
        return [self._event(note) for note in notes]

    def _event(self, note: Note) -> Outgoing:
        sequence = self._count("event")
        return Outgoing("event", self.now, sequence, Event(self.run_id, sequence, self.now, *note))

    def _measure(self) -> Outgoing:
        row = self.tick_number % NOISE_ROWS
        if row == 0 and self.tick_number:
            self._noise = noise_block(self.scenario.seed, self.tick_number // NOISE_ROWS)
        acquire(self._taps, self._noise[row], self._card, self.scenario.loop.step, self._reading)
        sequence = self._count("measurement")
        self.measurement = Measurement(self.run_id, sequence, self.tick_number, self.now, *self._reading.tolist())
        return Outgoing("measurement", self.now, sequence, self.measurement)

    def _true_state(self) -> Outgoing:
        sequence = self._count("state")
        values = self._observed.tolist()
        state = PlantState(self.run_id, sequence, self.tick_number, self.now, self.hold.value, *values)
        return Outgoing("state", self.now, sequence, state)

    def _viewer_messages(self) -> list[Outgoing]:
        m = self.measurement
        header = Header(Time(self.now // NS, self.now % NS), self.scenario.rig_name)
        effort = np.array([])
        joint = JointState(header, ["piston"], np.array([m.position]), np.array([m.velocity]), effort)
        out = [Outgoing("joint", self.now, self._count("joint"), joint)]
        for tap in ("p1", "p2", "p3"):
            topic = f"pressure/{tap}"
            out.append(Outgoing(topic, self.now, self._count(topic), FluidPressure(header, getattr(m, tap), 0.0)))
        out.append(self._lines.message(self._state, self._count("lines"), self.tick_number, self.now))
        return out


def card_of(scenario: Scenario) -> Card:
    """The scenario's data acquisition card."""
    daq = scenario.daq
    return Card(
        daq.bits,
        daq.position_range,
        daq.velocity_range,
        daq.pressure_range,
        daq.noise,
        daq.skew,
        daq.quantise,
        daq.clip,
        daq.tachometer,
    )
