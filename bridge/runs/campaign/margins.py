"""The margin of a controller: runs with more and more of one disturbance of its loop, until bands break.

MARGINS is the one table: each row says how a value of the disturbance becomes a piece of a scenario.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from bridge.errors import UsageError
from bridge.scenario.units import UNITS, split
from bridge.studies.sweep.journal import Point, Result

if TYPE_CHECKING:
    from bridge.runs.campaign.made import Plain
    from bridge.runs.campaign.matrix import Matrix
    from bridge.runs.sweep.axes import Axis
    from bridge.studies.sweep.engine import Rounds

MOST_RUNS = 10_000


class MarginKind(NamedTuple):
    """A disturbance of the loop."""

    words: str
    si_unit: str
    piece: Callable[[str], dict[str, Any]]  # of a value with its unit


class MarginRun(NamedTuple):
    """One run with so much of a disturbance."""

    place: int  # on the axis
    seed: int
    result: Result

    @property
    def passed(self) -> bool:
        """Did it go well, in all its bands?"""
        return not self.result["reason"] and all(band["passed"] for band in self.result["bands"])


class Margin(NamedTuple):
    """A scenario against one disturbance."""

    scenario: str
    kind: str  # of MARGINS
    axis: "Axis"
    runs: list[MarginRun]
    theory: dict[str, float]  # edge of the linear loop by its point, in the unit of the axis; inf: none

    @property
    def kept(self) -> int:
        """How many values, from the first on, are kept by every seed without a gap."""
        places = range(len(self.axis.texts))
        return next((p for p in places if not all(run.passed for run in self.runs if run.place == p)), len(places))

    @property
    def broken(self) -> str:
        """What breaks first beyond that; empty where nothing does."""
        failing = [run for run in self.runs if run.place == self.kept and not run.passed]
        if not failing:
            return ""
        bands = [band["band"] for run in failing for band in run.result["bands"] if not band["passed"]]
        return failing[0].result["reason"] or bands[0]


def _delay(text: str) -> dict[str, Any]:
    return {"loop": {"delay": text}}


def _jitter(text: str) -> dict[str, Any]:
    """The way of a command takes from 0 to so long, even between them."""
    number, unit = split(text)
    half = f"{0.5 * number:.9g} {unit}"
    way = {"kind": "delay", "law": "uniform", "time": half, "spread": half}
    return {"fault": [{"target": "link.command", "at": 0.0, **way}]} if number else {}


def _loss(text: str) -> dict[str, Any]:
    return {"fault": [{"target": "link.command", "at": 0.0, "kind": "loss", "share": text}]} if split(text)[0] else {}


MARGINS = {
    "delay": MarginKind("delay from sample to action", "s", _delay),
    "jitter": MarginKind("longest way of a command, even from 0", "s", _jitter),
    "loss": MarginKind("share of commands lost", "", _loss),
}


def margin_axes(matrix: "Matrix") -> "list[tuple[str, Axis]]":
    """The values of each disturbance that the file names. Raises UsageError with one line."""
    from bridge.runs.sweep.axes import axis, listed

    first = next(iter(matrix.scenarios.values()))
    found = []
    for kind, given in matrix.file.margins.items():
        name = f"margin.{kind}"
        if isinstance(given, str):
            one = axis(name, given, first)
        elif isinstance(given, list) and given and all(isinstance(value, str) for value in given):
            one = listed(name, given, first)
        else:
            raise UsageError(f"{name}: {given!r}: write FROM:TO:COUNT, such as '0 ms:60 ms:13', or a list of values")
        if one.numbers is None or list(one.numbers) != sorted(set(one.numbers)) or len(one.numbers) < 2:
            raise UsageError(f"{name}: {given!r}: the values must be at least two numbers, and rise")
        _refuse(matrix, kind, one)
        found.append((kind, one))
    runs = sum(len(one.texts) for _, one in found) * len(matrix.scenarios) * len(seeds(matrix))
    if runs > MOST_RUNS:
        raise UsageError(f"margin: {runs} runs are more than {MOST_RUNS}; take fewer values or seeds")
    return found


def _refuse(matrix: "Matrix", kind: str, axis: "Axis") -> None:
    """Raises UsageError for a value without its unit, and for one that a scenario cannot have."""
    from bridge.runs.campaign.made import scenario_of

    if not axis.unit:
        known = ", ".join(filter(None, UNITS[MARGINS[kind].si_unit]))
        raise UsageError(f"margin.{kind}: {axis.texts[-1]} has no unit; write one of {known} behind it")
    for name in matrix.scenarios:
        for text in axis.texts:
            try:
                scenario_of(point_of(matrix, name, kind, text, 1), matrix.bases, {})
            except UsageError as error:
                raise UsageError(f"margin.{kind} = {text}: {str(error).splitlines()[0]}") from None


def seeds(matrix: "Matrix") -> list[int]:
    """The seeds of the campaign, or the scenarios' own."""
    return matrix.file.seeds or [next(iter(matrix.scenarios.values())).seed]


def point_of(matrix: "Matrix", scenario: str, kind: str, text: str, seed: int) -> Point:
    """The point of a run with so much of a disturbance, and without a fault."""
    piece = MARGINS[kind].piece(text)
    return {"scenario": scenario, "fault": "", "changes": [f"seed={seed}"], "piece": piece}


def margins_of(matrix: "Matrix", ask: "Rounds") -> list[Margin]:
    """Run all of them."""
    axes, own = margin_axes(matrix), seeds(matrix)
    cells = [(name, kind, axis) for name in matrix.scenarios for kind, axis in axes]
    wanted = [
        [
            (place, seed, point_of(matrix, name, kind, text, seed))
            for place, text in enumerate(axis.texts)
            for seed in own
        ]
        for name, kind, axis in cells
    ]
    results = iter(ask([point for rows in wanted for _, _, point in rows]))
    edges = ask([{"theory": kind, "scenario": name} for name, kind, _ in cells])
    return [
        Margin(
            name,
            kind,
            axis,
            [MarginRun(place, seed, next(results)) for place, seed, _ in rows],
            {point: edge / UNITS[MARGINS[kind].si_unit][axis.unit].factor for point, edge in found.items()},
        )
        for (name, kind, axis), rows, found in zip(cells, wanted, edges, strict=True)
    ]


def theory_of(point: Point, bases: "Mapping[str, Plain]") -> Result:
    """The edges of a scenario's linear loop, SI, by its points; none where the theory knows no such loop."""
    from bridge.scenario import changed
    from bridge.studies.stability.link_margins import EDGES, loops_of

    scenario = changed(bases[point["scenario"]], [], point["scenario"])
    return {loop.point: EDGES[point["theory"]](loop) for loop in loops_of(scenario)}
