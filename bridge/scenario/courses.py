"""How the numbers go that change during a run."""

from collections.abc import Collection, Iterable
from typing import Any

from bridge.scenario import Scenario
from bridge.scenario.timeline import Item, plan
from bridge.scenario.tunable import REFERENCE, Tunable, tunables
from bridge.wire.events import setting_of
from bridge.wire.messages import EventKind
from controller.course import Act, Course, Point, Ramp, Step
from controller.grid import NS
from controller.reference import evaluate


def courses_of(scenario: Scenario, items: Collection[Item]) -> dict[str, Course]:
    """How the numbers that the timeline changes go, as far as the clock alone says."""
    acts: dict[str, list[Act]] = {item.target.name: [] for item in items}
    for item in items:
        acts[item.target.name] += [Act(begin, item.shape) for begin in item.begins]
    targets = {item.target.name: item.target for item in items}
    return {name: course_of(targets[name], scenario, own) for name, own in acts.items()}


def course_of(target: Tunable, scenario: Scenario, acts: Collection[Act] = ()) -> Course:
    """How a number goes that has a value of its own in the scenario."""
    if target.name != REFERENCE:
        return Course(lambda _: Point(target.value, 0.0), list(acts))
    reference = scenario.reference.reference()
    return Course(lambda t: Point(*evaluate(reference, t / NS)), list(acts))


def to_be(value: float, over: int) -> Step | Ramp:
    """What makes a number something, at once or over a time [ns]."""
    return Ramp(value, over) if over else Step(value)


def change(text: str, entry: int, apply_at: int, items: list[Item]) -> tuple[str, Act] | None:
    """The number that a `changed` event is about, and what acts on it; None where the clock alone has said so.

    text, entry, apply_at: the fields of the event; entry 0 is what somebody has set.
    """
    if not entry:
        name, value, over = setting_of(text)
        return name, Act(apply_at, to_be(value, over))
    item = items[entry - 1] if entry <= len(items) else None
    return (item.target.name, Act(apply_at, item.shape)) if item is not None and item.condition is not None else None


def reference_course(scenario: Scenario, events: Iterable[Any]) -> Course:
    """The reference of a run whose events are known. The law follows one."""
    items = plan(scenario)
    course = courses_of(scenario, [item for item in items if item.target.name == REFERENCE]).get(REFERENCE)
    course = course or course_of(tunables(scenario)[REFERENCE], scenario)
    for event in events:
        if event.kind == EventKind.CHANGED:
            changed = change(event.text, event.command, event.apply_at, items)
            if changed is not None and changed[0] == REFERENCE:
                course.add(changed[1])
    return course
