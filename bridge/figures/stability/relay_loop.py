"""The relay's cycle on the rig over sampling period, delay and derivative time: predicted, and found on the twin.

Not in the thesis, which has the relay without sampling on its dimensionless actuator (5.3.2, 5.3.3). Lines: the reduced
drive under the sampled relay; marks: the full twin in process. The proportional valve with the dead band of its lands
left in, as the relay does not jump it, and without; and the two-way valve. Where (5.22) with hold and delay asks for
more derivative time than there is, the swing grows. A loop of the two-way valve has no frequency of its own where it
switches irregularly: no mark and a gap in the line.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from bridge.drawing.canvas import Array, Columns, Sheet, label, remark, tiles
from bridge.scenario import Scenario, load
from bridge.studies.stability.amplitude import threaded
from bridge.studies.stability.relay_lead import critical_lead
from bridge.studies.stability.relay_swing import Place, found_on_twin, predicted
from bridge.studies.sweep.engine import ALL_CORES, Crew
from controller.stability.amplitude.swing import Swing

ABOUT = Place(5e-3, 0.0, 20e-3)  # what the other two are, where one is varied
LINE, MARKS = 24, 6  # places of theory and of the twin
HIGHEST = 40e-3  # [s], of each axis
VALVES = {
    "proportional, dead band left in": (["rig.valve.kind=proportional"], "#2a6fbb", "o"),
    "proportional, no dead band": (["rig.valve.kind=proportional", "rig.valve.overlap=0"], "#3a9150", "s"),
    "two-way": ([], "#c8413b", "^"),
}
WORDS = {"period": "sampling period [ms]", "delay": "delay [ms]", "derivative": "derivative time [ms]"}


class Course(NamedTuple):
    """One line or one row of marks."""

    times: Array  # [ms], along the axis
    peak: Array  # peak to peak [mm]
    frequency: Array  # [Hz], NaN: irregular


def places(axis: str, count: int) -> list[Place]:
    """Even places along an axis; a period is a whole number of ms, and so is the rest."""
    least = 1e-3 if axis == "period" else 0.0
    values = [round(1e3 * v) * 1e-3 for v in np.linspace(least, HIGHEST, count).tolist()]
    return [ABOUT._replace(**{axis: value}) for value in values]


def course(axis: str, at: Sequence[Place], swings: Sequence[Swing]) -> Course:
    """The swings along an axis."""
    often = np.array([one.frequency for one in swings])
    peaks = np.array([1e3 * one.peak_to_peak for one in swings])
    return Course(np.array([1e3 * getattr(place, axis) for place in at]), peaks, np.where(often > 0.0, often, np.nan))


def theory(scenario: Scenario, axis: str, count: int = LINE) -> Course:
    """The reduced drive along an axis."""
    at = places(axis, count)
    return course(axis, at, threaded(lambda place: predicted(scenario, [place])[0], at))


def twin(scenario: Scenario, count: int = MARKS, crew: Crew = ALL_CORES) -> dict[str, Course]:
    """The twin along each axis."""
    at = {axis: places(axis, count) for axis in WORDS}
    swings = iter(found_on_twin(scenario, [place for row in at.values() for place in row], None, crew))
    return {axis: course(axis, row, [next(swings) for _ in row]) for axis, row in at.items()}


def draw_relay_loop() -> tuple[Columns, Sheet]:
    """The figure."""
    page, panels = tiles("The relay's cycle on the rig: predicted, and found on the twin", 2, 3)
    columns: Columns = {}
    for words, (changes, colour, marker) in VALVES.items():
        scenario = load("relay", changes)
        found = twin(scenario)
        for axis, above, below in zip(WORDS, panels[:3], panels[3:], strict=True):
            columns |= _columns(f"{words}, over {axis}", found[axis], theory(scenario, axis, MARKS))
            _draw((above, below), theory(scenario, axis), found[axis], {"color": colour}, marker, words)
    leads = [1e3 * critical_lead(load("relay", changes)) for changes, _, _ in VALVES.values()]
    for axis, above, below in zip(WORDS, panels[:3], panels[3:], strict=True):
        label(above, "", "peak to peak [mm]")
        label(below, WORDS[axis], "frequency [Hz]")
        above.set_ylim(bottom=0.0)
        below.set_ylim(0.0, 40.0)
    panels[0].legend(fontsize=8, frameon=False)
    rest = f"period {1e3 * ABOUT.period:g}, delay {1e3 * ABOUT.delay:g}, derivative time {1e3 * ABOUT.derivative:g} ms"
    remark(
        page,
        f"Lines: reduced drive. Marks: full twin, step of 2 mm, last third of 6 s or more. Otherwise {rest}; 120 kg at "
        f"130 mm.\nDerivative time of (5.22), without hold and delay: {leads[0]:.2g} ms proportional, "
        f"{leads[2]:.2g} ms two-way. Where the two-way valve switches irregularly, no frequency.",
    )
    return {name: np.nan_to_num(column) for name, column in columns.items()}, page


def _columns(words: str, found: Course, expected: Course) -> Mapping[str, Array]:
    return {
        f"{words} [ms]": found.times,
        f"{words}: twin [mm]": found.peak,
        f"{words}: theory [mm]": expected.peak,
        f"{words}: twin [Hz]": found.frequency,
        f"{words}: theory [Hz]": expected.frequency,
    }


def _draw(panels: tuple[Any, Any], line: Course, marks: Course, style: dict[str, Any], marker: str, words: str) -> None:
    for axes, name in zip(panels, ("peak", "frequency"), strict=True):
        axes.plot(line.times, getattr(line, name), linewidth=1.3, label=words, **style)
        axes.plot(marks.times, getattr(marks, name), marker, markersize=5, **style)
