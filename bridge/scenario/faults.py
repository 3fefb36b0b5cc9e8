"""What goes wrong in a run: `[[fault]]` entries, each a target, a kind, its numbers, and when."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import Field

from bridge.errors import ScenarioError, nearest
from bridge.scenario.channels import chosen
from bridge.scenario.fault_kinds import DIRECTIONS, LAWS, LINK, PLANT, PROCESS, PROCESSES, SENSOR, Kind, Size
from bridge.scenario.fields import Line, Part, Seconds
from bridge.scenario.timeline import MOST_TIMES, Crossing, Value, begins_of, condition_of, refuse_many
from bridge.scenario.units import quantity
from bridge.wire.messages import EventKind
from controller.course import NEVER
from controller.grid import whole
from twin.topology import CHANNELS

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

LINKS, SENSORS, FURTHER, PROCESS_OF = "link", "sensor", "channel", "process"
OF_WHEN = ("name", "target", "kind", "at", "when", "after", "lasts", "every", "times", "probability")


class Fault(Part):
    """One fault. Which numbers it takes follows from its kind, docs/faults.md."""

    target: Line = Field(description="link.command, sensor.p2, valve, pump, process.controller, ...")
    kind: Line = Field(description="what happens to it: delay, stuck, leak, crash, ...")
    name: Line = Field(default="", description="in events and tables; by default target and kind")
    at: Seconds | None = Field(default=None, ge=0.0, description="when it begins, whole internal steps")
    when: Line | None = Field(default=None, description='or on what: "p2 > 60 bar", "safe"')
    after: Seconds = Field(default=0.0, ge=0.0, description="how long after that it begins")
    lasts: Seconds | None = Field(default=None, gt=0.0, description="how long; without it, to the end of the run")
    every: Seconds | None = Field(default=None, gt=0.0, description="with `at`: again so long after each beginning")
    times: int = Field(default=1, ge=1, le=MOST_TIMES, description="how often it begins")
    probability: float = Field(
        default=1.0, ge=0.0, le=1.0, description="that it happens at each beginning, by the seed"
    )
    law: Line | None = Field(default=None, description="of a link's delay: constant, uniform, normal, ...")
    instead: Line | None = Field(default=None, description="of a wrong channel: the one that is read")
    time: Value | None = None
    spread: Value | None = None
    share: Value | None = None
    length: Value | None = None
    growth: Value | None = None
    offset: Value | None = None
    drift: Value | None = None
    size: Value | None = None
    rate: Value | None = None
    factor: Value | None = None
    friction: Value | None = None
    to: Value | None = None
    over: Value | None = None
    low: Value | None = None
    high: Value | None = None
    width: Value | None = None
    limit: Value | None = None
    diameter: Value | None = None
    mass: Value | None = None
    force: Value | None = None
    impulse: Value | None = None


class PlannedFault(NamedTuple):
    """A fault, ready to act."""

    number: int  # from 1, in the order of the scenario; 0 of one that somebody has injected
    name: str
    target: str
    kind: str
    sizes: dict[str, float]  # SI
    word: str  # its law, or the channel that is read instead; else ""
    begins: tuple[int, ...]  # [ns]; none of what waits for a condition
    condition: Crossing | EventKind | None
    after: int  # [ns]
    times: int
    lasts: int  # [ns]; NEVER: to the end of the run
    probability: float
    words: str  # what happens, for events

    @property
    def group(self) -> str:
        """Of its target: link, sensor, channel, process, or the target itself."""
        return self.target.partition(".")[0]

    @property
    def part(self) -> str:
        """What of a group: a direction, a channel, a process."""
        return self.target.partition(".")[2]


def planned(scenario: "Scenario") -> list[PlannedFault]:
    """The faults of a scenario. Raises ScenarioError that names the fault, what is wrong and the way out."""
    found: list[PlannedFault] = []
    refuse_many("fault", scenario.fault)
    for number, fault in enumerate(scenario.fault, 1):
        try:
            one = plan_fault(fault, scenario, number)
        except (ScenarioError, ValueError) as error:
            raise ScenarioError(f"fault {number}: {error}") from None
        if one.name in (other.name for other in found):
            given = f"{one.name} {number}"
            if fault.name:
                raise ScenarioError(f"fault {number}: the name {fault.name!r} is taken by another fault")
            one = one._replace(name=given)
        found.append(one)
    return found


def plan_fault(fault: Fault, scenario: "Scenario", number: int) -> PlannedFault:
    """One fault, ready to act. Raises ValueError or ScenarioError."""
    kind, unit, words = _kind_of(fault, scenario), _unit_of(fault.target, scenario), fault.kind
    step = scenario.loop.grid().step

    def instant(name: str, seconds: float) -> int:
        return whole(name, seconds, "internal step", step)

    if set(fault.name) & {"'", '"'}:
        raise ValueError(f"name {fault.name!r}: write it without quotation marks")
    if kind.lasting and fault.lasts is None:
        raise ValueError(f'{fault.target} {words}: say how long, lasts = "0.2 s"')
    return PlannedFault(
        number,
        fault.name or f"{fault.target} {fault.kind}",
        fault.target,
        fault.kind,
        _sizes(fault, kind, unit),
        _word(fault, scenario),
        begins_of(fault, instant),
        None if fault.when is None else condition_of(fault.when),
        instant("after", fault.after),
        fault.times,
        NEVER if fault.lasts is None else instant("lasts", fault.lasts),
        fault.probability,
        _in_words(fault),
    )


def _in_words(fault: Fault) -> str:
    given = ((name, value) for name, value in _numbers(fault).items() if value is not None)
    sizes = ", ".join(f"{name} {value}" for name, value in given)
    words = " ".join(filter(None, (fault.target, fault.kind, fault.law, fault.instead)))
    return f"{words}{f' ({sizes})' if sizes else ''}"


def targets(scenario: "Scenario") -> Iterator[tuple[str, dict[str, Kind]]]:
    """What of a scenario can suffer a fault, and its kinds."""
    yield from ((f"{LINKS}.{direction}", LINK) for direction in DIRECTIONS)
    yield from ((f"{SENSORS}.{channel}", SENSOR) for channel in CHANNELS)
    yield from ((f"{FURTHER}.{channel}", SENSOR) for channel in chosen(scenario))
    yield from PLANT.items()
    yield from ((f"{PROCESS_OF}.{process}", PROCESS) for process in PROCESSES)


def _kind_of(fault: Fault, scenario: "Scenario") -> Kind:
    known = dict(targets(scenario))
    if fault.target not in known:
        raise ValueError(f"no target {fault.target!r}{nearest(fault.target, known)}")
    kinds = known[fault.target]
    if fault.kind not in kinds:
        raise ValueError(f"{fault.target} has no fault {fault.kind!r}{nearest(fault.kind, kinds)}")
    return kinds[fault.kind]


def _unit_of(target: str, scenario: "Scenario") -> str:
    """Of a sensor's channel; "" for others."""
    group, _, name = target.partition(".")
    if group == SENSORS:
        return CHANNELS[name].unit
    return chosen(scenario)[name].unit if group == FURTHER else ""


def _sizes(fault: Fault, kind: Kind, unit: str) -> dict[str, float]:
    given = {name: value for name, value in _numbers(fault).items() if value is not None}
    for name in given:
        if name not in kind.sizes:
            raise ValueError(f"{fault.target} {fault.kind} takes no {name}{nearest(name, kind.sizes)}")
    return {name: _size(name, given.get(name), size, unit, fault) for name, size in kind.sizes.items()}


def _numbers(fault: Fault) -> dict[str, Any]:
    words = (*OF_WHEN, "law", "instead")
    return {name: getattr(fault, name) for name in type(fault).model_fields if name not in words}


def _size(name: str, value: Value | None, size: Size, channel: str, fault: Fault) -> float:
    unit = channel if size.unit == "*" else size.unit
    if value is None:
        if size.default is None:
            of = f" in {unit}" if unit else ""
            raise ValueError(f"{fault.target} {fault.kind} needs {name}, a number{of}: {size.words or 'its value'}")
        return size.default
    if name == "rate" and isinstance(value, str):
        value = value.removesuffix("/s")
    number = quantity(value, unit)
    if not size.low <= number <= size.high:
        raise ValueError(f"{name} = {number:g} {unit}: must be from {size.low:g} to {size.high:g}".replace(" :", ":"))
    return number


def _word(fault: Fault, scenario: "Scenario") -> str:
    if fault.kind == "delay" and fault.target.startswith(LINKS):
        law = fault.law or "constant"
        if law not in LAWS:
            raise ValueError(f"no law of delays {law!r}{nearest(law, LAWS)}")
        if fault.instead is not None:
            raise ValueError(f"{fault.target} {fault.kind} takes no instead")
        return law
    if fault.law is not None:
        raise ValueError(f"{fault.target} {fault.kind} takes no law")
    if fault.kind != "wrong-channel":
        if fault.instead is not None:
            raise ValueError(f"{fault.target} {fault.kind} takes no instead")
        return ""
    group, _, name = fault.target.partition(".")
    others = [other for other in (CHANNELS if group == SENSORS else chosen(scenario)) if other != name]
    if fault.instead not in others:
        raise ValueError(f"instead = {fault.instead!r}: one of {', '.join(others)}")
    return fault.instead or ""
