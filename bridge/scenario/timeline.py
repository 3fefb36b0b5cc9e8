"""What happens to a run while it goes on: `[[timeline]]` entries, in simulated time or on a condition."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from pydantic import Field

from bridge.errors import ScenarioError
from bridge.scenario.conditions import Crossing as Crossing
from bridge.scenario.conditions import crosses as crosses
from bridge.scenario.conditions import crossing
from bridge.scenario.fields import Hertz, Line, Part, Seconds
from bridge.scenario.tunable import Tunable, difference_in_si, in_si, tunable, within
from bridge.wire.messages import EventKind
from controller.course import NEVER, Altered, Pulse, Ramp, Shape, Sine, Step, Table
from controller.grid import NS, whole

if TYPE_CHECKING:
    from bridge.scenario.model import Scenario

MOST_TIMES = 10_000
MOST_TOGETHER = 100_000  # of all entries: each is planned before the run
EVENTS = (
    *(EventKind.SAFE, EventKind.RESET, EventKind.RESUMED, EventKind.LATE, EventKind.MISSED, EventKind.REFUSED),
    *(EventKind.LATCHED, EventKind.DEGRADED, EventKind.RESTORED, EventKind.ALARM, EventKind.CLEARED),
)
Value = float | str


class Happening(Part):
    """One change of one number."""

    set: str = Field(description="what changes: rig.load.force, sensor.p2.offset, controller.gain, reference, ...")
    at: Seconds | None = Field(default=None, ge=0.0, description="when it begins, whole internal steps")
    when: Line | None = Field(default=None, description='or on what: "p2 > 60 bar", "position < 50 mm", "safe"')
    after: Seconds = Field(default=0.0, ge=0.0, description="how long after that it begins")
    to: Value | None = Field(default=None, description="the new value")
    over: Seconds | None = Field(default=None, gt=0.0, description="with `to`: a ramp that takes so long")
    lasts: Seconds | None = Field(default=None, gt=0.0, description="with `to`: a pulse; of a sine: how long")
    amplitude: Value | None = Field(default=None, description="of a sine on top of what goes on")
    frequency: Hertz | None = Field(default=None, gt=0.0, description="of the sine")
    table: list[tuple[Seconds, Value]] | None = Field(
        default=None, min_length=2, description="pairs of a time from the beginning and a value, linear between them"
    )
    every: Seconds | None = Field(default=None, gt=0.0, description="with `at`: again so long after each beginning")
    times: int = Field(default=1, ge=1, le=MOST_TIMES, description="how often it happens")


class Item(NamedTuple):
    """An entry, ready to act."""

    number: int  # from 1, in the order of the scenario
    target: Tunable
    shape: Shape
    begins: tuple[int, ...]  # [ns]; none of what waits for a condition
    condition: Crossing | EventKind | None
    after: int  # [ns]
    times: int
    words: str


def plan(scenario: "Scenario") -> list[Item]:
    """The entries of a scenario. Raises ScenarioError that names the entry, what is wrong and the way out."""
    refuse_many("timeline", scenario.timeline)
    return [_item(number, entry, scenario) for number, entry in enumerate(scenario.timeline, 1)]


def refuse_many(what: str, entries: Sequence["Timed"]) -> None:
    """Raises ScenarioError for entries that happen too often, all together."""
    if (often := sum(entry.times for entry in entries)) > MOST_TOGETHER:
        raise ScenarioError(f"{what}: its entries happen {often} times in all; at most {MOST_TOGETHER}")


def _item(number: int, entry: Happening, scenario: "Scenario") -> Item:
    try:
        target, step = tunable(entry.set, scenario), scenario.loop.grid().step

        def instant(name: str, seconds: float) -> int:
            return whole(name, seconds, "internal step", step)

        shape, words = _shape(entry, target, scenario, instant)
        begins, condition = begins_of(entry, instant), None if entry.when is None else condition_of(entry.when)
        after = instant("after", entry.after)
    except (ScenarioError, ValueError) as error:
        raise ScenarioError(f"timeline {number}: {error}") from None
    return Item(number, target, shape, begins, condition, after, entry.times, f"{entry.set} {words}")


class Timed(Protocol):
    """What says when it begins: at an instant, again and again, or on a condition."""

    at: Any
    when: Any
    after: Any
    every: Any
    times: Any


def begins_of(entry: Timed, instant: Callable[[str, float], int]) -> tuple[int, ...]:
    """When it begins [ns]; nothing where it waits for a condition. Raises ValueError where both or none are given."""
    if (entry.at is None) == (entry.when is None):
        raise ValueError('give either at = "2 s" or when = "p2 > 60 bar"')
    if entry.at is None:
        if entry.every is not None:
            raise ValueError("every goes with at; on a condition, times says how often")
        return ()
    if (entry.times > 1) != (entry.every is not None):
        raise ValueError('every and times go together: every = "1 s", times = 5')
    first = instant("at", entry.at) + instant("after", entry.after)
    period = instant("every", entry.every) if entry.every is not None else 0
    return tuple(first + k * period for k in range(entry.times))


def condition_of(text: str) -> Crossing | EventKind:
    """What "p2 > 60 bar" or "safe" waits for. Raises ValueError."""
    if text in EVENTS:
        return EventKind(text)
    return crossing(text, f", or one of {', '.join(EVENTS)}")


Made = tuple[Shape, str]
Instant = Callable[[str, float], int]


def _shape(entry: Happening, target: Tunable, scenario: "Scenario", instant: Instant) -> Made:
    given = {name for name in ("to", "over", "lasts", "amplitude", "frequency", "table") if getattr(entry, name)}
    given |= {"to"} if entry.to is not None else set()
    for keys, make in SHAPES.items():
        if given in (set(required) for required in keys):
            return make(entry, target, scenario, instant)
    raise ValueError(
        f"{', '.join(sorted(given)) or 'nothing'} given; write to (a step), to and over (a ramp), to and lasts (a "
        "pulse), amplitude and frequency (a sine, lasts ends it), or table"
    )


def _said(value: Value | None, target: Tunable) -> str:
    return value if isinstance(value, str) else f"{value:g} {target.unit}".rstrip()


def _step(entry: Happening, target: Tunable, scenario: "Scenario", _: Instant) -> Made:
    return Step(in_si(entry.to, target, scenario)), f"= {_said(entry.to, target)}"


def _ramp(entry: Happening, target: Tunable, scenario: "Scenario", instant: Instant) -> Made:
    over = instant("over", entry.over or 0.0)
    return Ramp(in_si(entry.to, target, scenario), over), f"to {_said(entry.to, target)} over {over / NS:g} s"


def _pulse(entry: Happening, target: Tunable, scenario: "Scenario", instant: Instant) -> Made:
    lasts = instant("lasts", entry.lasts or 0.0)
    return Pulse(in_si(entry.to, target, scenario), lasts), f"= {_said(entry.to, target)} for {lasts / NS:g} s"


def _sine(entry: Happening, target: Tunable, scenario: "Scenario", instant: Instant) -> Made:
    amplitude, frequency = difference_in_si(entry.amplitude, target, scenario), entry.frequency or 0.0
    for other in _plain_values(target, scenario):
        for reached in (other - amplitude, other + amplitude):
            within(reached, target, scenario)
    lasts = NEVER if entry.lasts is None else instant("lasts", entry.lasts)
    end = "" if entry.lasts is None else f" for {lasts / NS:g} s"
    return Sine(amplitude, frequency, lasts), f"+- {_said(entry.amplitude, target)} at {frequency:g} Hz{end}"


def _table(entry: Happening, target: Tunable, scenario: "Scenario", instant: Instant) -> Made:
    rows = entry.table or []
    times = [instant("time", time) for time, _ in rows]
    if times[0] != 0 or any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError("table: times count from the beginning: the first is 0, and they increase")
    values = tuple(in_si(value, target, scenario) for _, value in rows)
    return Table(tuple(times), values), f"by a table of {times[-1] / NS:g} s"


Keys = tuple[tuple[str, ...], ...]
SHAPES: dict[Keys, Callable[[Happening, Tunable, "Scenario", Instant], Made]] = {
    (("to",),): _step,
    (("to", "over"),): _ramp,
    (("to", "lasts"),): _pulse,
    (("amplitude", "frequency"), ("amplitude", "frequency", "lasts")): _sine,
    (("table",),): _table,
}


def _plain_values(target: Tunable, scenario: "Scenario") -> Iterator[float]:
    """What a number is in the scenario, and what its other entries make it."""
    yield target.value
    for entry in scenario.timeline:
        if entry.set == target.name:
            yield from (in_si(entry.to, target, scenario),) if entry.to is not None else ()
            yield from (in_si(value, target, scenario) for _, value in entry.table or [])


def reached(item: Item) -> Iterator[float]:
    """The values that an entry makes of its number."""
    shape = item.shape
    if isinstance(shape, Table):
        yield from shape.values
    elif not isinstance(shape, Sine | Altered):
        yield shape.to
