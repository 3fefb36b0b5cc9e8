"""The faults of a plant that runs: what each spell of a fault does, and the events that tell of it."""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Protocol

from bridge.errors import ScenarioError, nearest
from bridge.loop.bad_link import BadLink
from bridge.loop.fault_chance import Luck
from bridge.loop.fault_clock import FaultClock, Spell
from bridge.loop.inlet import Inlet
from bridge.loop.sensor_faults import Input, SensorFaults, inputs_of
from bridge.loop.valve_faults import ValveFaults
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.scenario.faults import FURTHER, LINKS, PROCESS_OF, SENSORS, Fault, PlannedFault, plan_fault, planned
from bridge.scenario.fitted_valve import power_off_of
from bridge.scenario.plant_faults import acts_of, is_of_rig, refuse_beyond
from bridge.wire.events import fault_turn, injection, withdrawal
from bridge.wire.limits import FAULTS
from controller.course import Act
from controller.grid import NS, to_ns
from twin.sensors import card_of
from twin.topology import CHANNELS

TOLD = 100  # beginnings and ends of one fault that are recorded one by one
Tell = Callable[[str, int, int], None]  # a text, the number of a fault, and when it acts [ns]


class Altering(Protocol):
    """Who alters the rig's numbers."""

    def alter(self, name: str, act: Act) -> None:
        """Let an act change a number."""
        ...

    def cease(self, name: str, act: Act, now: int) -> None:
        """Let an act end at an instant [ns], before its time."""
        ...

    def refuse(self, numbers: Mapping[str, float]) -> None:
        """Raises ScenarioError for numbers that the rig cannot have."""
        ...


class Faults:
    """The faults of one run. Its link, cards and valve are there once a fault concerns them."""

    def __init__(self, scenario: Scenario, inlet: Inlet, rig: Altering, tell: Tell) -> None:
        self.link: BadLink | None = None
        self.card: SensorFaults | None = None
        self.further: SensorFaults | None = None
        self.valve: ValveFaults | None = None
        self._scenario = scenario
        self._inlet = inlet
        self._rig = rig
        self._tell = tell
        self._now = 0
        self._told: dict[str, int] = {}
        self._values = scenario.rig_values()
        faults = planned(scenario)
        for fault in faults:
            self._refuse(fault)
        self._names = {fault.name: fault for fault in faults}
        self._acts: dict[str, list[tuple[str, Act]]] = {}  # of the rig's numbers, by the names of their faults
        self._clock = FaultClock(faults, scenario.seed, self._start)

    def watch(self, now: int, signal: Callable[[str], float]) -> None:
        """After a scan: tell of what has begun and ended, and begin what waited for a signal."""
        self._now = now
        self._clock.watch(now, signal)
        for instant, begins, spell in self._clock.turns(now):
            self._announce(spell.fault, begins, instant)

    def heard(self, now: int, kinds: Collection[str]) -> None:
        """Begin what waited for an event."""
        self._now = now
        self._clock.heard(now, kinds)

    def inject(self, fault: Fault, now: int) -> PlannedFault:
        """Take one more fault; without `at` and `when` it begins at once. Raises ScenarioError, and takes none."""
        self._now = now
        if len(self._names) >= FAULTS:
            raise ScenarioError(f"there have been {FAULTS} faults in this run: no more are taken")
        given = fault
        if fault.at is None and fault.when is None:
            given = fault.model_copy(update={"at": self._spoken(fault.target.partition(".")[0], now) / NS})
        try:
            one = plan_fault(given, self._scenario, 0)
        except ValueError as error:
            raise ScenarioError(str(error)) from None
        if any(begin < now for begin in one.begins):
            raise ScenarioError(f"at = {given.at:g} s has passed: it is {now / NS:g} s")
        if one.name in self._names:
            one = one._replace(name=f"{one.name} from {now / NS:g} s")
        if one.name in self._names:
            raise ScenarioError(f"there is a fault {one.name!r} already; give it another name")
        self._refuse(one)
        self._names[one.name] = one
        self._tell(injection(given.model_dump_json(exclude_defaults=True)), 0, now)
        self._clock.add(one)
        return one

    def end(self, name: str, now: int) -> PlannedFault:
        """End a fault before its time, and let it begin no more. Raises ScenarioError where there is none to end."""
        self._now = now
        fault = self._names.get(name)
        if fault is None:
            raise ScenarioError(f"there is no fault {name!r}{nearest(name, self._names)}")
        if fault.group == PROCESS_OF:
            raise ScenarioError(f"{name!r} is a fault of a process: it ends by itself, after what `lasts` says")
        instant = self._spoken(fault.group, now)
        if not self._clock.end(name, instant):
            raise ScenarioError(f"the fault {name!r} is over already")
        for number, act in self._acts.pop(name, []):
            self._rig.cease(number, act, now)
        if fault.group == LINKS and self.link is not None:
            self.link.end(fault, instant)
        for suffering in (self.card, self.further, self.valve):
            if suffering is not None:
                suffering.end(name, now)
        self._tell(withdrawal(name), 0, now)
        return fault

    def cut(self, begin: int, end: int) -> Iterator[tuple[int, int]]:
        """[begin, end) where faults of the valve's command begin and end."""
        while self.valve is not None and (stop := self.valve.next(begin)) is not None and stop < end:
            yield begin, stop
            begin = stop
        yield begin, end

    def counts(self) -> dict[str, int]:
        """What the faults of the link have done, by name."""
        return {} if self.link is None else self.link.counts()

    def _spoken(self, group: str, now: int) -> int:
        """When what somebody says acts [ns]: on a link after the messages of this instant, whoever was first."""
        return now + self._scenario.loop.grid().step if group == LINKS else now

    def _refuse(self, fault: PlannedFault) -> None:
        if is_of_rig(fault):
            self._rig.refuse(refuse_beyond(fault, self._values, self._scenario))

    def _start(self, spell: Spell) -> None:
        """A spell of a fault is known: have it act at its time."""
        fault, seed, grid = spell.fault, self._scenario.seed, self._scenario.loop.grid()
        if is_of_rig(fault):
            for begin, lasts in _pieces(spell, seed, to_ns(self._scenario.duration)):
                for name, act in acts_of(fault, begin, lasts, self._values):
                    self._rig.alter(name, act)
                    self._acts.setdefault(fault.name, []).append((name, act))
        elif fault.group == LINKS:
            self.link = self.link or BadLink(seed, grid, self._inlet, self._now)
            self.link.start(spell)
        elif fault.group == SENSORS:
            self.card = self.card or SensorFaults(_own_inputs(self._scenario), seed, grid.daq)
            self.card.start(spell)
        elif fault.group == FURTHER:
            self.further = self.further or SensorFaults(_further_inputs(self._scenario), seed, grid.daq)
            self.further.start(spell)
        elif fault.group != PROCESS_OF:
            self.valve = self.valve or ValveFaults(power_off_of(self._scenario))
            self.valve.start(spell)

    def _announce(self, fault: PlannedFault, begins: bool, instant: int) -> None:
        told = self._told[fault.name] = self._told.get(fault.name, 0) + 1
        if told <= TOLD:
            last = "; further ones are not told" if told == TOLD else ""
            self._tell(fault_turn(fault.name, begins, f"{fault.words}{last}"), fault.number, instant)


def _pieces(spell: Spell, seed: int, end: int) -> Iterator[tuple[int, int]]:
    """When a fault of the rig is there: beginning and length [ns]; one that comes in spells of its own many times."""
    if spell.fault.kind != "contaminated":
        yield spell.begin, spell.end - spell.begin
        return
    sizes, whole = spell.fault.sizes, max(0, min(spell.end, end) - spell.begin) / NS
    for begin, stop in Luck(seed, spell.fault.name).spells(spell.number, sizes["share"], sizes["length"], whole):
        yield spell.begin + to_ns(begin), max(1, to_ns(stop - begin))


def _own_inputs(scenario: Scenario) -> dict[str, Input]:
    card = card_of(scenario.daq)
    return inputs_of([*CHANNELS], dict(zip(CHANNELS, zip(card.low, card.high, strict=True), strict=True)))


def _further_inputs(scenario: Scenario) -> dict[str, Input]:
    ends = {name: sensor.ends(scenario.daq) for name, sensor in chosen(scenario).items()}
    return inputs_of([*ends], ends)
