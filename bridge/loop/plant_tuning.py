"""What changes while a plant runs: by the timeline, or because somebody says so.

A change of the rig acts at its own instant, to the internal step. What moves all the time acts as a staircase: a stair
per scan of the card. Each change is an event, which tells a controller of what it cannot know by itself: that a
condition has come, and what somebody has set.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridge.loop.altered_rig import AlteredRig
from bridge.scenario import Scenario
from bridge.scenario.conditions import Crossing, crosses
from bridge.scenario.courses import course_of, courses_of, to_be
from bridge.scenario.timeline import Item, plan, reached
from bridge.scenario.tunable import PLANT, Tunable, tunables
from bridge.wire.events import setting, timeline_entry
from controller.course import NEVER, Act, Course, Ramp, Table, moving
from controller.grid import NS, next_sample
from twin.circuit.block import Compiled

RIG = "rig."
Tune = Callable[[str, str, float], None]  # takes a channel, what of its transducer, and the value
DEAR = ("rig.oil.", "rig.relief.setting")  # take some 40 ms to build
STAIR = NS // 10  # of these [ns]
TOLD = 100  # changes by one entry of the timeline that are recorded one by one
Told = Callable[[str, int, int], None]  # takes a text, the number of an entry of the timeline, and when it acts [ns]


class PlantTuning:
    """Changes of a plant that runs."""

    def __init__(
        self,
        scenario: Scenario,
        plant: Compiled,
        state: NDArray[np.float64],
        transducers: Mapping[str, Tune],
        tell: Told,
    ) -> None:
        """transducers: who changes those whose numbers begin so."""
        self._scenario = scenario
        self._grid = scenario.loop.grid()
        self._plant = plant
        self._state = state
        self._transducers = transducers
        self._tell = tell
        self._rig = AlteredRig(scenario)
        self._items = plan(scenario)
        self._courses = courses_of(scenario, self._items)
        self._known: dict[str, Tunable] = {}  # of all, once somebody asks
        self._values: dict[str, float] = {}  # of the rig's and the sensors' numbers that have changed
        self._waiting = {item.number: item.times for item in self._items if item.condition is not None}
        self._met = dict.fromkeys(self._waiting, True)  # a condition that is met at the start has not been crossed
        self._clocked = sorted((begin, item.number) for item in self._items for begin in item.begins)
        self._told: dict[int, int] = {}
        self.said: list[dict[str, Any]] = []  # changes that the scenario and the clock do not tell
        self._due = 0 if self._courses else NEVER  # when something of the rig changes next [ns]
        _refuse_impossible(self._items, self._rig)
        self._prepare()

    def _prepare(self) -> None:
        """Build what takes long before the clock starts, as far as it is known; the rig remembers it."""
        for item in self._items:
            if item.target.name.startswith(DEAR) and isinstance(item.shape, Ramp | Table):
                for begin in item.begins:
                    self._foresee(item.target.name, Act(begin, item.shape))

    def _foresee(self, name: str, act: Act) -> None:
        """Build what an act makes of a number, stair by stair."""
        for t in range(act.begin // STAIR * STAIR, act.begin + moving(act.shape) + 1, STAIR):
            self._rig.refuse({name: self._courses[name].at(max(t, act.begin)).value})

    def cut(self, begin: int, end: int) -> Iterator[tuple[int, int]]:
        """[begin, end) where the rig's numbers change; they have changed when a piece is handed out."""
        while True:
            if begin >= self._due:
                self._change(begin)
            stop = min(end, self._due)
            yield begin, stop
            if stop >= end:
                return
            begin = stop

    def sense(self, now: int) -> None:
        """Before a scan: change the sensors."""
        for name, course in self._courses.items():
            group, _, rest = name.partition(".")
            if group in self._transducers:
                value = course.at(now).value
                if value != self._values.get(name, self.target(name).value):
                    self._values[name] = value
                    channel, what = rest.split(".")
                    self._transducers[group](channel, what, value)

    def watch(self, now: int, signal: Callable[[str], float]) -> None:
        """After a scan: tell of what has begun, and begin what waited for a signal."""
        while self._clocked and self._clocked[0][0] <= now:
            begin, number = self._clocked.pop(0)
            self._announce(self._items[number - 1], begin, now)
        for number in list(self._waiting):
            item = self._items[number - 1]
            if isinstance(item.condition, Crossing):
                met = crosses(item.condition, signal(item.condition.signal))
                if met and not self._met[number]:
                    self._begin(item, now)
                self._met[number] = met

    def heard(self, now: int, kinds: Collection[str]) -> None:
        """Begin what waited for an event."""
        for number in list(self._waiting):
            if self._items[number - 1].condition in kinds:
                self._begin(self._items[number - 1], now)

    def set(self, numbers: Mapping[str, float], now: int, over: int = 0) -> dict[str, int]:
        """Change numbers because somebody says so, at once or over a time [ns]; from when on each acts [ns].

        They are within their limits.

        Raises ScenarioError, and changes none, where the rig cannot be so.
        """
        targets = [self.target(name) for name in numbers]
        self._rig.refuse({name: value for name, value in numbers.items() if name.startswith(RIG)})
        following = next_sample(now + self._grid.daq + 1, self._grid)
        begins = {target.name: now if target.owner == PLANT else following for target in targets}
        for target in targets:
            value, at = numbers[target.name], begins[target.name]
            self._course(target).add(Act(at, to_be(value, over)))
            self._due = min(self._due, at)
            self._say(setting(target.name, value, over), 0, at)
        return begins

    def alter(self, name: str, act: Act) -> None:
        """Let an act change a number of the rig, on top of what else does; call it before its instant."""
        course = self._course(self.target(name))
        course.add(act)
        self._due = min(self._due, act.begin)
        if name.startswith(DEAR):
            self._foresee(name, act)

    def cease(self, name: str, act: Act, now: int) -> None:
        """Let an act end at an instant that has just been reached, before its time."""
        self._course(self.target(name)).cease(act, now)
        self._due = min(self._due, now)

    def refuse(self, numbers: Mapping[str, float]) -> None:
        """Raises ScenarioError for numbers that the rig cannot have now."""
        self._rig.refuse(numbers)

    def value(self, name: str, now: int) -> float:
        """What a number is now, SI."""
        course = self._courses.get(name)
        return course_of(self.target(name), self._scenario).at(now).value if course is None else course.at(now).value

    def target(self, name: str) -> Tunable:
        """A number that may change, by its name. Raises KeyError."""
        return self.known()[name]

    def known(self) -> dict[str, Tunable]:
        """All numbers that may change."""
        self._known = self._known or tunables(self._scenario)
        return self._known

    def _course(self, target: Tunable) -> Course:
        return self._courses.setdefault(target.name, course_of(target, self._scenario))

    def _begin(self, item: Item, now: int) -> None:
        """A condition has come."""
        self._waiting[item.number] -= 1
        if not self._waiting[item.number]:
            del self._waiting[item.number]
        begin = now + item.after
        self._course(item.target).add(Act(begin, item.shape))
        self._due = min(self._due, begin)
        self._announce(item, begin, now)

    def _announce(self, item: Item, begin: int, now: int) -> None:
        told = self._told[item.number] = self._told.get(item.number, 0) + 1
        if item.condition is not None or told <= TOLD:
            last = "; further ones are not told" if told == TOLD and item.condition is None else ""
            later = f", from {begin / NS:g} s on" if begin > now else ""
            text = timeline_entry(item.number, item.words) + later + last
            (self._tell if item.condition is None else self._say)(text, item.number, begin)

    def _say(self, text: str, entry: int, apply_at: int) -> None:
        """Tell what a controller cannot know by itself, and remember it for one that comes later."""
        self.said.append({"text": text, "command": entry, "apply_at": apply_at})
        self._tell(text, entry, apply_at)

    def _change(self, t: int) -> None:
        """Make the rig's numbers what they are from an instant on, and find the next."""
        due = NEVER
        changed = {}
        for name, course in self._courses.items():
            if not name.startswith(RIG):
                continue
            value = course.at(t).value
            if value != self._values.get(name, self.target(name).value):
                self._values[name] = changed[name] = value
            due = min(due, course.next(t), self._stair(name, t) if course.moves(t) else NEVER)
        self._due = due
        if changed:
            self._rig.take(changed)
            self._rig.write(self._plant, self._state)

    def _stair(self, name: str, t: int) -> int:
        """The next instant at which a number that moves all the time has a new value [ns]."""
        long = -(-STAIR // self._grid.daq) * self._grid.daq if name.startswith(DEAR) else self._grid.daq
        return (t // long + 1) * long


def refuse_impossible(scenario: Scenario) -> None:
    """Raises ScenarioError for an entry of the timeline that the rig cannot take, whatever else happens."""
    _refuse_impossible(plan(scenario), AlteredRig(scenario))


def _refuse_impossible(items: Collection[Item], rig: AlteredRig) -> None:
    """Raises ScenarioError for a change by itself that the rig cannot take."""
    for item in items:
        if item.target.name.startswith(RIG):
            for value in reached(item):
                rig.refuse({item.target.name: value})
