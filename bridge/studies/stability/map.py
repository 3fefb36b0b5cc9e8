"""From what a person asks for to a chart of stability and its files."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import RunError, nearest
from bridge.scenario import Scenario, load
from bridge.scenario.units import interval
from bridge.studies.stability.actuator_runs import OWN, actuator_runs
from bridge.studies.stability.chart import (
    AXES,
    RANGES,
    Chart,
    Family,
    OfRig,
    Plainly,
    chart,
)
from bridge.studies.stability.chart_drawing import NOTHING, write
from bridge.studies.stability.equivalent import scaled
from bridge.studies.stability.matrices_chart import OfMatrices
from bridge.studies.stability.matrices_chart import refuse_axes as refuse_matrices_axes
from bridge.studies.stability.relay_drawing import write_relay
from bridge.studies.stability.relay_map import LEAST as SHORTEST
from bridge.studies.stability.relay_map import (
    MOST_CELLS,
    WIDEST,
    own_numbers,
    refuse_axes,
    relay_chart,
    relay_runs,
)
from bridge.studies.stability.twin_runs import twin_runs
from bridge.studies.stability.watched_theory import watching
from bridge.studies.sweep.engine import Crew

AROUND = {"gain": (0.0, 4.0), "derivative": (0.0, 4.0), "period": (0.2, 5.0), "delay": (0.0, 5.0)}  # of the rig's own
DAMPINGS = (0.0, 2000.0)  # [N s/m]
LEAST = {"gain": 1.0, "derivative": 0.02, "period": 20.0, "delay": 20.0}  # what stands in for 0, rig units


class Wanted(NamedTuple):
    """A chart, as asked for."""

    across: str
    up: str
    x: str | None  # LOW:HIGH
    y: str | None
    rig: str | None  # a scenario
    about: str  # point of the rig
    changes: tuple[str, ...]  # of the scenario
    fixed: tuple[str, ...]  # NAME=NUMBER
    cells: int  # a side
    runs: int  # a side
    simulate: bool  # run the dimensionless actuator
    derivative: str  # of the dimensionless controller
    filter_time: float | None  # [sampling periods], of "filtered"
    mark: str | None = None  # a scenario whose numbers are marked


def make(wanted: Wanted, output: Path, workers: int, scheduler: str | None) -> list[Path]:
    """Compute, run, write. Raises ValueError or UsageError that says what would do, RunError when interrupted."""
    scenario = None if wanted.rig is None else load(wanted.rig, list(wanted.changes))
    if scenario is None and (wanted.changes or wanted.about):
        raise ValueError("--set and --about are of a scenario's rig; name one with --rig, or use --at NAME=NUMBER")
    if scenario is not None and (wanted.simulate or wanted.derivative != "measured"):
        raise ValueError(
            "--simulate and --derivative are of the dimensionless actuator; with --rig runs are of the twin, and its "
            "controller is set by --set controller.velocity"
        )
    if scenario is not None and wanted.mark:
        raise ValueError("--mark puts a rig on the dimensionless chart; without --rig")
    if (wanted.derivative == "filtered") != (wanted.filter_time is not None):
        raise ValueError("--derivative filtered and --filter-time, in sampling periods, go together")
    if scenario is not None and scenario.controller.kind == "relay":
        return _relay(wanted, scenario, output, Crew(workers, scheduler))
    plain = Plainly({}, wanted.derivative, wanted.filter_time or 0.0)
    family: Family = plain if scenario is None else _of_rig(scenario, wanted)
    given = numbers(wanted.fixed, [*family.numbers, *(OWN if wanted.simulate else ())])
    family.numbers |= given
    x, y = (span(axis, text, family, wanted.cells) for axis, text in ((wanted.across, wanted.x), (wanted.up, wanted.y)))
    with watching(len(x)) as watch:
        drawn = chart(family, wanted.across, wanted.up, x, y, watch)
    if len(drawn.x) < len(x):
        raise RunError(_interrupted(drawn, x, output))
    places = [(a, b) for a in inner(x, wanted.runs) for b in inner(y, wanted.runs)]
    part, crew = output.with_name(f"{output.name}.part"), Crew(workers, scheduler)
    overlay = NOTHING
    if isinstance(family, OfRig) and places:
        overlay = twin_runs(family, wanted.across, wanted.up, places, part, crew)
    elif wanted.simulate and places:
        overlay = actuator_runs(plain, wanted.across, wanted.up, places, part, crew)
    marked = None if wanted.mark is None else scaled(load(wanted.mark))
    return write(drawn, overlay, output, marked)


def _interrupted(drawn: Chart, x: NDArray[np.float64], output: Path) -> str:
    """Write what there is of a chart; what to say of it."""
    if len(drawn.x) < 2:
        return "interrupted before two columns were there: nothing is written"
    paths = ", ".join(str(path) for path in write(drawn, NOTHING, output))
    return (
        f"interrupted at {drawn.across} {drawn.x[-1]:.4g} of {x[-1]:.4g}, {len(drawn.x)} of {len(x)} columns: {paths}"
    )


def _of_rig(scenario: Scenario, wanted: Wanted) -> OfRig:
    """The loops of a rig under the scenario's law."""
    if scenario.controller.kind != "state-space":
        return OfRig(scenario, wanted.about)
    refuse_matrices_axes(wanted.across, wanted.up, *(entry.partition("=")[0] for entry in wanted.fixed))
    return OfMatrices(scenario, wanted.about)


def _relay(wanted: Wanted, scenario: Scenario, output: Path, crew: Crew) -> list[Path]:
    """The chart of a relay's loop, which has no gain and no linear point."""
    refuse_axes(wanted.across, wanted.up)
    if wanted.about:
        raise ValueError(f"--about {wanted.about}: a relay's loop has no linear point; leave it out")
    own = own_numbers(scenario)
    own |= numbers(wanted.fixed, [*own])
    cells = min(wanted.cells, MOST_CELLS)
    axes = ((wanted.across, wanted.x), (wanted.up, wanted.y))
    x, y = (_times(axis, text, max(WIDEST[axis], 2.0 * own[axis]), cells) for axis, text in axes)
    drawn = relay_chart(scenario, wanted.across, wanted.up, x, y, own)
    places = [(a, b) for a in inner(x, wanted.runs) for b in inner(y, wanted.runs)]
    part, overlay = output.with_name(f"{output.name}.part"), NOTHING
    if places:
        overlay = relay_runs(scenario, wanted.across, wanted.up, places, own, part, crew)
    return write_relay(drawn, overlay, output)


def _times(axis: str, text: str | None, top: float, cells: int) -> NDArray[np.float64]:
    """Values [ms] along an axis of a relay's chart."""
    least = SHORTEST if axis == "period" else 0.0
    ends = (least, top) if text is None else interval(f"range of {axis}", text, above=axis == "period")
    if not least <= ends[0] < ends[1]:
        raise ValueError(f"range {ends[0]:g} to {ends[1]:g} ms of {axis}: it must rise, and start at {least:g} or more")
    return np.linspace(*ends, cells)


def numbers(fixed: tuple[str, ...], known: list[str]) -> dict[str, float]:
    """NAME=NUMBER, read. Raises ValueError for another name or no number."""
    found = {}
    for entry in fixed:
        name, sign, value = entry.partition("=")
        if name not in known or not sign:
            raise ValueError(f"--at {entry!r}: write NAME=NUMBER with one of {', '.join(known)}")
        try:
            found[name] = float(value)
        except ValueError:
            raise ValueError(f"--at {entry!r}: {value!r} is not a number") from None
    return found


def span(axis: str, text: str | None, family: Family, cells: int) -> NDArray[np.float64]:
    """Values along an axis: from LOW:HIGH, or around what the loop has."""
    if axis not in AXES:
        raise ValueError(f"axis {axis!r} is unknown{nearest(axis, AXES)}")
    if text is not None:
        ends = interval(f"range of {axis}", text, above=axis == "period")
    elif isinstance(family, OfRig):
        own = family.numbers[axis] or LEAST.get(axis, 0.0)
        around = AROUND.get(axis)
        ends = (own * around[0], own * around[1]) if around else DAMPINGS
    else:
        ends = RANGES[axis]
    if not 0.0 <= ends[0] < ends[1]:
        raise ValueError(f"range {ends[0]:g} to {ends[1]:g} of {axis}: it must rise, and start at 0 or more")
    return np.linspace(*ends, cells)


def inner(values: NDArray[np.float64], count: int) -> list[float]:
    """So many even places between the ends."""
    return [float(v) for v in np.linspace(values[0], values[-1], count + 2)[1:-1]]
