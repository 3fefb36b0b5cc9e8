"""What changes while a controller runs: by the timeline, or because somebody says so.

A change acts from the first sample at its instant or after it.
"""

from collections.abc import Iterator

from bridge.scenario import Scenario
from bridge.scenario.courses import change, course_of, courses_of
from bridge.scenario.timeline import plan, reached
from bridge.scenario.tunable import CONTROLLER, REFERENCE, Tunable, tunables, with_controller
from controller.course import Course
from controller.reference import Target


class ControllerTuning:
    """Changes of a controller that runs."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._items = plan(scenario)
        own = [item for item in self._items if item.target.owner == CONTROLLER]
        self._courses = courses_of(scenario, own)
        self._values: dict[str, float] = {}
        self._known: dict[str, Tunable] = {}
        self._heard: set[tuple[str, int]] = set()

    def heed(self, text: str, entry: int, apply_at: int) -> None:
        """Take what the plant says has changed, where it is the controller's; what is told twice counts once.

        entry: of the timeline; 0 for what somebody has set.
        """
        if (text, apply_at) in self._heard:
            return
        self._heard.add((text, apply_at))
        found = change(text, entry, apply_at, self._items)
        if found is not None and self._is_ours(found[0]):
            self._course(self._known[found[0]]).add(found[1])

    def foreseen(self) -> Iterator[Scenario]:
        """The scenario with each value that an entry of the timeline gives to a number of the law."""
        for item in self._items:
            if item.target.owner == CONTROLLER and item.target.name != REFERENCE:
                for value in reached(item):
                    yield with_controller(self._scenario, {item.target.name: value})

    def changed(self, stamp: int) -> Scenario | None:
        """The scenario with the gains of a sample, if they are others than at the last one."""
        values = {name: course.at(stamp).value for name, course in self._courses.items() if name != REFERENCE}
        if all(self._values.get(name, self._plain(name)) == value for name, value in values.items()):
            return None
        self._values = values
        return with_controller(self._scenario, values)

    def target(self, target: Target, stamp: int) -> Target:
        """What is wanted at a sample, where the scenario alone wants a target."""
        course = self._courses.get(REFERENCE)
        return target if course is None else Target(*course.at(stamp))

    def _is_ours(self, name: str) -> bool:
        self._known = self._known or tunables(self._scenario)
        return name in self._known and self._known[name].owner == CONTROLLER

    def _plain(self, name: str) -> float:
        self._known = self._known or tunables(self._scenario)
        return self._known[name].value

    def _course(self, target: Tunable) -> Course:
        return self._courses.setdefault(target.name, course_of(target, self._scenario))
