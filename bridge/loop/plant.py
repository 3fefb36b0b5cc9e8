"""The plant as its partners see it: blocks of simulation between measurements, commands in, messages out.

No clock, no network: `tick` is called when it is time, `receive` when something has come. The in-process loop and the
plant process run this same code.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.loop.acquisition import Acquisition
from bridge.loop.bad_link import Scan
from bridge.loop.faults import Faults
from bridge.loop.further import further_channels, message
from bridge.loop.inlet import Inlet, Note
from bridge.loop.line_profiles import LineProfiles
from bridge.loop.live_reference import LiveReference
from bridge.loop.plant_tuning import PlantTuning, Tune
from bridge.loop.refuge import CENTRED
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of, rest_of
from bridge.scenario.faults import Fault, PlannedFault
from bridge.scenario.references import Live
from bridge.scenario.tunable import FURTHER, REFERENCE, SENSOR, Tunable
from bridge.wire.codec import Event, FluidPressure, Header, JointState, Measurement, PlantState, Time, decode
from bridge.wire.events import silence
from bridge.wire.messages import CHANNELS_TOPIC, TOPICS, EventKind, Outgoing, Reason, of_tap
from bridge.wire.status import PlantStatus, Reading
from controller.grid import NS, is_sample, last_due, next_sample
from twin.circuit.block import block_of, compiled
from twin.sensors import put_out
from twin.topology import CHANNELS, OBSERVED, PRESSURES

SEEN_AT = {name: place for place, name in enumerate(OBSERVED)}


class PlantSide:
    """One run of the plant."""

    def __init__(self, scenario: Scenario, run_id: int) -> None:
        loop = scenario.loop
        self.scenario = scenario
        self.run_id = run_id
        self.grid = loop.grid()
        self.inlet = Inlet(scenario, run_id)
        self.tick_number = 0
        self.published: dict[str, int] = {}
        self._viewer_ticks = max(1, round(loop.viewer_period * NS / self.grid.daq))
        self._circuit = compiled(circuit_of(scenario))
        self._block = block_of(self._circuit)
        self._state = rest_of(scenario)
        self._acquisition = Acquisition(scenario)
        self._further = further_channels(scenario, self._circuit)
        self._observed = np.zeros(len(OBSERVED))
        self._lines = LineProfiles(run_id, self._circuit)
        self._tuning = PlantTuning(scenario, self._circuit, self._state, self._transducers(), self._tell)
        self._faults = Faults(scenario, self.inlet, self._tuning, self._tell_fault)
        self._live = LiveReference(scenario.reference) if isinstance(scenario.reference, Live) else None
        self._reference = CENTRED  # that acts on the spool
        self._run(CENTRED, 0)
        self.measurement: Any = None
        self.channels: Any = None  # the newest scan of further channels; None where the scenario has none
        self.heard: list[Heard] = []  # what the controller is sent at this tick

    @property
    def now(self) -> int:
        """Simulated time reached [ns]."""
        return self.tick_number * self.grid.daq

    @property
    def observed(self) -> NDArray[np.float64]:
        """The true quantities now, in the order of OBSERVED; valid until the next tick."""
        return self._observed

    def start(self) -> list[Outgoing]:
        """The messages of tick 0: the rig at rest."""
        for _ in self._tuning.cut(0, 0):
            self._run(self.inlet.value, 0)
        self._acquisition.taps[0] = self._acquisition.taps[1]
        self.inlet.note(EventKind.STARTED, f"scenario {self.scenario.name}, {self.scenario.duration:g} s")
        return self._messages()

    def awaited(self) -> int | None:
        """Stamp of the sample whose command the next block cannot do without; None when it has all."""
        if self._faults.link is not None:
            return self._faults.link.awaited(self.now, self.inlet.prompt)
        at_once = self.inlet.prompt and is_sample(self.now, self.grid)
        due = self.now if at_once else last_due(self.now + self.grid.daq, self.grid)
        return due if due is not None and due > self.inlet.answered else None

    def unanswered(self) -> bool:
        """Is there a sample whose command has not come yet?"""
        if self._faults.link is not None:
            return self._faults.link.unanswered()
        return next_sample(self.inlet.answered + 1, self.grid) <= self.now

    def receive(self, payload: bytes, kind: str = "") -> Any:
        """Take a command from the wire; `kind` is the type it claims. The command if it was taken, else None."""
        try:
            if kind and kind != TOPICS["command"].type:
                raise ValueError(f"a message of type {kind!r}")
            command = decode(payload, "command")
        except ValueError as error:
            self.inlet.refuse(Reason.UNDECODABLE, str(error))
            return None
        return command if self.take(command) else None

    def take(self, command: Any) -> bool:
        """Take a command; False when it was refused. One of a bad link is offered when it is there."""
        if self._faults.link is not None and command.run_id == self.run_id:
            self._faults.link.take(command, self.now)
            return True
        return self.inlet.offer(command, self.now)

    def retell(self, refusal: Any) -> None:
        """Tell once more of a refusal, by its event: of what was refused no more may be known."""
        self.inlet.retell(refusal)

    def reset(self) -> None:
        """Leave the safe state because somebody says so."""
        self.inlet.reset(self.now)

    def set(self, numbers: Mapping[str, float], over: int = 0) -> dict[str, int]:
        """Change numbers (SI) because somebody says so, at once or over a time [ns]; from when on each acts [ns].

        Raises ScenarioError, and changes none, where the rig cannot be so.
        """
        return self._tuning.set(numbers, self.now, over)

    def inject(self, fault: Fault) -> PlannedFault:
        """Take one more fault because somebody says so. Raises ScenarioError, and takes none."""
        return self._faults.inject(fault, self.now)

    def end_fault(self, name: str) -> PlannedFault:
        """End a fault because somebody says so. Raises ScenarioError where there is none to end."""
        return self._faults.end(name, self.now)

    def aim(self, target: float | None) -> None:
        """Take the newest target of a live reference [m], None without a new one; call once before each tick."""
        if self._live is not None:
            aim = self._live.aim(target, self.now, self._tuning.value(REFERENCE, self.now))
            if aim is not None:
                self.set({REFERENCE: aim.position}, aim.over)

    def values(self) -> dict[str, tuple[Tunable, float]]:
        """The numbers that may change, and what they are now, SI."""
        return {name: (entry, self._tuning.value(name, self.now)) for name, entry in self._tuning.known().items()}

    @property
    def said(self) -> list[dict[str, Any]]:
        """Changes that a controller which comes now has to be told of."""
        return self._tuning.said

    def tick(self, lean: bool = False) -> list[Outgoing]:
        """Integrate the block that has just passed and return its messages; `lean`: measurement and events alone."""
        begin, end = self.now, self.now + self.grid.daq
        if self._faults.link is not None:
            self._faults.link.offer(begin)
        for segment in self.inlet.segments(begin, end):
            for first, last in self._tuning.cut(segment.begin, segment.end):
                for since, until in self._faults.cut(first, last):
                    self._run(segment.value, (until - since) // self.grid.step, since)
        self.tick_number += 1
        if not lean:
            return self._messages()
        measured = self._measure()
        self._look()
        return [*measured, *self._drain()]

    def status(self) -> PlantStatus:
        """How it is doing."""
        inlet, m = self.inlet, self.measurement
        return PlantStatus(
            tick=self.tick_number,
            ticks=self.scenario.ticks,
            commands=inlet.accepted,
            late=inlet.late,
            worst_late=inlet.worst_lateness / NS,
            safe_states=inlet.safe_states,
            reading=None if m is None else _reading(m, inlet.value),
            refused={reason.value: count for reason, count in inlet.refused.items()},
            faulted=self._faults.counts(),
        )

    def finish(self, text: str) -> list[Outgoing]:
        """The last words, and before them since when the controller was not heard any more."""
        due = last_due(self.now, self.grid)
        if due is not None and due > self.inlet.answered and self._faults.link is None:
            self.inlet.note(EventKind.MISSED, silence(self.inlet.answered + 1))
        self.inlet.note(EventKind.ENDED, text)
        return self._drain()

    def _transducers(self) -> dict[str, Tune]:
        """Who changes the transducers of the card, by the beginning of their numbers' names."""
        further = {} if self._further is None else {FURTHER: self._further.tune}
        return {SENSOR: self._acquisition.tune, **further}

    def _run(self, reference: float, steps: int, now: int = 0) -> None:
        daq = self.scenario.daq
        self._reference = put_out(reference, daq.output_bits) if daq.quantise_output else reference
        if self._faults.valve is not None:
            self._reference = self._faults.valve.reference(self._reference, now)
        self._block(self._state, self._reference, steps, self._acquisition.taps, self._observed)

    def _count(self, topic: str) -> int:
        sequence = self.published.get(topic, 0)
        self.published[topic] = sequence + 1
        return sequence

    def _messages(self) -> list[Outgoing]:
        out = [*self._measure(), self._true_state()]
        self._look()
        if self.tick_number % self._viewer_ticks == 0:
            out += self._viewer_messages()
        return out + self._drain()

    def _drain(self) -> list[Outgoing]:
        notes = self.inlet.notes()
        if notes:
            kinds = {note.kind for note in notes}
            self._tuning.heard(self.now, kinds)
            self._faults.heard(self.now, kinds)
        return [self._event(note) for note in (*notes, *self.inlet.notes())]

    def _tell(self, text: str, entry: int, apply_at: int) -> None:
        self.inlet.note(EventKind.CHANGED, text, command=entry, apply_at=apply_at)

    def _tell_fault(self, text: str, number: int, apply_at: int) -> None:
        self.inlet.note(EventKind.FAULT, text, command=number, apply_at=apply_at)

    def _look(self) -> None:
        """After a scan: what begins by the clock or waits for a signal."""
        self._tuning.watch(self.now, self._signal)
        self._faults.watch(self.now, self._signal)
        self.inlet.look(self.now, self._signal)

    def _signal(self, name: str) -> float:
        """A true value, or what the card read where only that has the name, or where it is asked for."""
        at = SEEN_AT.get(name)
        if at is not None:
            return float(self._observed[at])
        topic, _, own = name.rpartition(".")
        if topic == CHANNELS_TOPIC:
            return self.channels.values[self.scenario.daq.channels.index(own)]
        return getattr(self.measurement, own)

    def _event(self, note: Note) -> Outgoing:
        sequence = self._count("event")
        event = Event(run_id=self.run_id, sequence=sequence, stamp=self.now, **note._asdict())
        return Outgoing("event", self.now, sequence, event)

    def _measure(self) -> list[Outgoing]:
        """What the controller is sent: the measurement, and before it the further channels, so that it has them."""
        self._tuning.sense(self.now)
        lies = self._faults.card
        seen = None if lies is None else lies.read(self.tick_number, self.now, self._acquisition.taps)
        reading = dict(zip(CHANNELS, self._acquisition.read(self.tick_number, seen).tolist(), strict=True))
        scan = Scan(self.tick_number, self.now, reading, self._read_further())
        self.heard = []
        link = self._faults.link
        out = [
            message
            for heard in ([scan] if link is None else link.through(scan, self.now))
            for message in self._sent(heard)
        ]
        if link is not None:
            self.measurement = Measurement(run_id=self.run_id, sequence=0, tick=scan.tick, stamp=self.now, **reading)
        return out

    def _sent(self, scan: Scan) -> list[Outgoing]:
        """The messages of a scan as the controller hears them."""
        further, out = None, []
        if scan.further is not None:
            sequence = self._count(CHANNELS_TOPIC)
            further = message(self.run_id, sequence, scan.tick, scan.stamp, scan.further)
            self.channels = further.message
            out.append(further._replace(log_time=self.now))
        sequence = self._count("measurement")
        self.measurement = Measurement(
            run_id=self.run_id, sequence=sequence, tick=scan.tick, stamp=scan.stamp, **scan.reading
        )
        self.heard.append(Heard(self.measurement, None if further is None else further.message))
        return [*out, Outgoing("measurement", self.now, sequence, self.measurement)]

    def _read_further(self) -> Any:
        if self._further is None:
            return None
        taps, lies = self._acquisition.taps, self._faults.further
        return self._further.read(self.tick_number, self._state, self._observed, taps, self.now, lies)

    def true_state(self) -> Any:
        """The message that was last published, or is to be."""
        # in the order of OBSERVED, of which the message is made; keywords would take longer than the whole card
        head = self.run_id, max(0, self.published.get("state", 0) - 1), self.tick_number, self.now, self._reference
        return PlantState(*head, *self._observed.tolist())

    def _true_state(self) -> Outgoing:
        sequence = self._count("state")
        return Outgoing("state", self.now, sequence, self.true_state())

    def _viewer_messages(self) -> list[Outgoing]:
        m = self.measurement
        header = Header(stamp=Time(sec=self.now // NS, nanosec=self.now % NS), frame_id=self.scenario.rig_name)
        joint = JointState(
            header=header,
            name=["piston"],
            position=np.array([m.position]),
            velocity=np.array([m.velocity]),
            effort=np.array([]),
        )
        out = [Outgoing("joint", self.now, self._count("joint"), joint)]
        for tap in PRESSURES:
            topic = of_tap(tap)
            pressure = FluidPressure(header=header, fluid_pressure=getattr(m, tap), variance=0.0)
            out.append(Outgoing(topic, self.now, self._count(topic), pressure))
        out.append(self._lines.message(self._state, self._count("lines"), self.tick_number, self.now))
        return out


class Heard(NamedTuple):
    """What the controller is sent of a scan."""

    measurement: Any
    channels: Any  # None without further channels


def _reading(measurement: Any, spool: float) -> Reading:
    return Reading(measurement.position, tuple(getattr(measurement, name) for name in PRESSURES), spool)
