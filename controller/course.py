"""How a quantity goes over simulated time: what it would be, and acts that change it, one on top of the other.

Times are whole nanoseconds since the start of the run, values in SI. Every course is right-continuous: from its own
instant on an act holds.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import NamedTuple

from controller.grid import NS

NEVER = 1 << 62


class Step(NamedTuple):
    to: float  # from now on


class Ramp(NamedTuple):
    to: float
    over: int  # [ns], > 0, from what the quantity is when the ramp begins


class Pulse(NamedTuple):
    to: float
    lasts: int  # [ns], then what was before goes on


class Sine(NamedTuple):
    amplitude: float  # added to what goes on meanwhile
    frequency: float  # [Hz], phase 0 at the beginning
    lasts: int  # [ns]; NEVER: to the end of the run


class Table(NamedTuple):
    times: tuple[int, ...]  # [ns] from the beginning, increasing, the first 0
    values: tuple[float, ...]  # linear between the points, the last one is held


class Altered(NamedTuple):
    """What goes on meanwhile times a factor, and something added; both come about linearly."""

    factor: float
    add: float
    over: int  # [ns] until it is there
    lasts: int  # [ns]; NEVER: to the end of the run


Shape = Step | Ramp | Pulse | Sine | Table | Altered


class Act(NamedTuple):
    """A change that begins at an instant [ns]."""

    begin: int
    shape: Shape


class Point(NamedTuple):
    """A value, and its slope to the right [1/s]."""

    value: float
    slope: float


Plain = Callable[[int], Point]


def ends(shape: Shape) -> int:
    """How long a shape moves, or lasts [ns]; 0 for a step."""
    if isinstance(shape, Ramp):
        return shape.over
    if isinstance(shape, Pulse | Sine | Altered):
        return shape.lasts
    return shape.times[-1] if isinstance(shape, Table) else 0


def moving(shape: Shape) -> int:
    """How long it moves all the time [ns]."""
    if isinstance(shape, Altered):
        return min(shape.over, shape.lasts)
    return ends(shape) if isinstance(shape, Ramp | Sine | Table) else 0


class Course:
    """A quantity of a run. `plain`: what it is where nothing acts."""

    def __init__(self, plain: Plain, acts: Sequence[Act] = ()) -> None:
        self._plain = plain
        self._acts = sorted(acts, key=lambda act: act.begin)
        self._begins = [act.begin for act in self._acts]
        self._starts: dict[int, float] = {}  # of ramps, by their places

    def add(self, act: Act) -> None:
        """Let something act, on top of what began no later."""
        place = bisect_right(self._begins, act.begin)
        self._acts.insert(place, act)
        self._begins.insert(place, act.begin)
        self._starts = {at: start for at, start in self._starts.items() if at < place}

    def cease(self, act: Act, now: int) -> None:
        """Let an act end at an instant; one that has not begun by then does not come."""
        if act not in self._acts or not isinstance(act.shape, Altered) or act.begin + act.shape.lasts <= now:
            return
        place = self._acts.index(act)
        self._starts = {at: start for at, start in self._starts.items() if at < place}
        if act.begin < now:
            self._acts[place] = act._replace(shape=act.shape._replace(lasts=now - act.begin))
        else:
            del self._acts[place], self._begins[place]

    def at(self, t: int) -> Point:
        """Value and slope at an instant."""
        return self._upto(bisect_right(self._begins, t), t)

    def next(self, t: int) -> int:
        """The first instant after t at which an act begins or ends; NEVER without one."""
        marks = ((0, moving(act.shape), ends(act.shape)) for act in self._acts)
        instants = (act.begin + mark for act, own in zip(self._acts, marks, strict=True) for mark in own)
        return min((instant for instant in instants if instant > t), default=NEVER)

    def moves(self, t: int) -> bool:
        """Does something act at t that moves all the time?"""
        return any(act.begin <= t < act.begin + moving(act.shape) for act in self._acts)

    def _upto(self, count: int, t: int) -> Point:
        """Where only the first acts are there."""
        while count:
            count -= 1
            begin, shape = self._acts[count]
            since = t - begin
            if isinstance(shape, Pulse | Sine | Altered) and since >= shape.lasts:
                continue
            if isinstance(shape, Altered):
                return _altered(self._upto(count, t), shape, since)
            if isinstance(shape, Sine):
                return _swung(self._upto(count, t), shape, since / NS)
            if isinstance(shape, Ramp) and since < shape.over:
                start = self._start(count, begin)
                slope = (shape.to - start) / (shape.over / NS)
                return Point(start + slope * (since / NS), slope)
            return _between(shape, since) if isinstance(shape, Table) else Point(shape.to, 0.0)
        return self._plain(t)

    def _start(self, place: int, begin: int) -> float:
        """Where a ramp begins: found once, since ramps may follow one another for long."""
        if place not in self._starts:
            self._starts[place] = self._upto(place, begin).value
        return self._starts[place]


def _swung(about: Point, sine: Sine, since: float) -> Point:
    omega = 2.0 * math.pi * sine.frequency
    value = about.value + sine.amplitude * math.sin(omega * since)
    return Point(value, about.slope + sine.amplitude * omega * math.cos(omega * since))


def _altered(plain: Point, shape: Altered, since: int) -> Point:
    share = since / shape.over if since < shape.over else 1.0
    growth = NS / shape.over if since < shape.over else 0.0
    by = 1.0 + share * (shape.factor - 1.0)
    slope = plain.slope * by + growth * ((shape.factor - 1.0) * plain.value + shape.add)
    return Point(plain.value * by + share * shape.add, slope)


def _between(table: Table, since: int) -> Point:
    right = bisect_right(table.times, since)
    if right == len(table.times):
        return Point(table.values[-1], 0.0)
    (t_1, t_2), (v_1, v_2) = table.times[right - 1 : right + 1], table.values[right - 1 : right + 1]
    slope = (v_2 - v_1) / ((t_2 - t_1) / NS)
    return Point(v_1 + slope * ((since - t_1) / NS), slope)
