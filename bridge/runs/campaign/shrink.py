"""The smallest fault that breaks a band: one number of a fault halved towards harmless, again and again.

Bisection finds one edge between a value that keeps all bands and one that does not, and gives both. Where a fault
breaks a band, lets go and breaks it again, other edges lie between; those it does not see.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from bridge.errors import UsageError, nearest
from bridge.runs.campaign.file import Fault
from bridge.runs.campaign.matrix import Matrix, Run, fault_of
from bridge.runs.campaign.places import number_at, numbers_in, on_grid
from bridge.scenario.tunable import tunables
from bridge.scenario.units import UNITS, split
from bridge.studies.sweep.journal import Point, Result

if TYPE_CHECKING:
    from bridge.studies.sweep.engine import Rounds

HALVINGS = 7  # of the way from harmless to harmful: the edge is known to 1/128 of it
DIGITS = 6  # of a value between


class Wish(NamedTuple):
    """A number to shrink."""

    fault: Fault
    place: str  # in its piece
    harmless: float  # in the unit
    harmful: float
    unit: str
    step: float  # [s], the grid of times

    def text(self, number: float) -> str:
        """As a scenario takes it; of a time at least one step."""
        if self.unit in UNITS["s"]:
            number = max(on_grid(number, self.unit, self.step), self.step / UNITS["s"][self.unit].factor)
        return f"{number:.{DIGITS}g} {self.unit}".rstrip()

    @property
    def words(self) -> str:
        """Its name, that of its fault first."""
        return f"{self.fault.name}.{self.place}"


class Shrunk(NamedTuple):
    """Where the edge lies, for one cell of the matrix."""

    wish: Wish
    scenario: str
    parameters: tuple[str, ...]
    keeps: float | None  # in the unit; None: even the harmless value breaks a band
    breaks: float | None  # None: even the harmful value keeps all bands
    band: str  # that breaks there

    @property
    def words(self) -> str:
        """For people."""
        wish = self.wish
        if self.breaks is None:
            return f"keeps all bands up to {wish.text(wish.harmful)}"
        if self.keeps is None:
            return f"breaks {self.band!r} even at {wish.text(wish.harmless)}"
        return f"keeps all bands at {wish.text(self.keeps)}, breaks {self.band!r} at {wish.text(self.breaks)}"


def wishes_of(texts: Sequence[str], matrix: Matrix) -> list[Wish]:
    """What "push.timeline.1.to", or "push.timeline.1.to=0 N:-1500 N", ask for. Raises UsageError with one line."""
    return [_wish(text, matrix) for text in texts]


def _wish(text: str, matrix: Matrix) -> Wish:
    name, _, ends = text.partition("=")
    name = name.strip()
    faults = {fault.name: fault for fault in matrix.file.faults if fault.piece}
    fault = faults.get(name) or fault_of(name, matrix.file)
    if fault is None:
        raise UsageError(f"shrink {name!r}: no such fault{nearest(name.partition('.')[0], faults)}")
    known = [place for place, _ in numbers_in(fault.piece)]
    place = name.removeprefix(fault.name).removeprefix(".")
    if not place:
        if len(known) != 1:
            raise UsageError(f"shrink {name}: name one of its numbers: {', '.join(f'{name}.{k}' for k in known)}")
        place = known[0]
    written = number_at(fault.piece, place, fault.name)
    step = max(scenario.loop.step for scenario in matrix.scenarios.values())
    return _between(fault, place, ends.strip() or f"{_harmless(fault, place, written, matrix)}:{written}", step)


def _between(fault: Fault, place: str, ends: str, step: float) -> Wish:
    harmless, sign, harmful = ends.partition(":")
    try:
        pairs = [split(harmless), split(harmful)]
    except ValueError:
        pairs = []
    units = {unit for _, unit in pairs if unit}
    if not sign or not pairs or len(units) > 1:
        raise UsageError(f"shrink {fault.name}.{place}={ends}: write HARMLESS:HARMFUL in one unit, such as 0 N:1500 N")
    (low, _), (high, _) = pairs
    if low == high:
        raise UsageError(f"shrink {fault.name}.{place}: {harmless} and {harmful} are the same; write HARMLESS:HARMFUL")
    return Wish(fault, place, low, high, units.pop() if units else "", step)


def _harmless(fault: Fault, place: str, written: str, matrix: Matrix) -> str:
    """What the number is without the fault: that of the scenario where it is known, else 0."""
    scenario, (_, unit) = next(iter(matrix.scenarios.values())), split(written)
    known = tunables(scenario)
    *path, last = place.split(".")
    name = place
    if path[:1] == ["timeline"] and last == "to":
        name = fault.piece["timeline"][int(path[1]) - 1]["set"]
    if name in known and (own := _in_unit(known[name].value, known[name].unit, unit)) is not None:
        return f"{own:.{DIGITS}g} {unit}"
    return f"0 {unit}"


def _in_unit(value: float, si_unit: str, unit: str) -> float | None:
    """A number in SI in another unit of it; None where that is not one."""
    one = UNITS.get(si_unit, {}).get(unit or si_unit)
    return None if one is None else (value - one.offset) / one.factor


class _Search:
    """The halving for one cell."""

    def __init__(self, wish: Wish, runs: list[Run]) -> None:
        self.wish, self.runs = wish, runs
        self.keeps: float | None = None
        self.breaks: float | None = None
        self.band = ""

    def points(self, value: float) -> list[Point]:
        """The runs of the cell with a value in place of the file's."""
        own = {self.wish.place: self.wish.text(value)}
        return [{**run.point, "placed": {**run.point.get("placed", {}), **own}} for run in self.runs]

    def learn(self, value: float, results: list[Result]) -> None:
        """What the runs with a value came to."""
        if broken := next(filter(None, map(_broken, results)), ""):
            self.breaks, self.band = (value, broken) if self.keeps is not None or not self.band else (value, self.band)
        else:
            self.keeps = value

    @property
    def next(self) -> float | None:
        """The value to try; None where the ends agree."""
        return None if self.keeps is None or self.breaks is None else 0.5 * (self.keeps + self.breaks)

    @property
    def found(self) -> Shrunk:
        """What is known."""
        scenario, _, parameters = self.runs[0].cell
        return Shrunk(self.wish, scenario, parameters, self.keeps, self.breaks, self.band)


def _broken(result: Result) -> str:
    """What a run breaks first; empty for nothing."""
    return result["reason"] or next((band["band"] for band in result["bands"] if not band["passed"]), "")


def shrunk(wishes: Sequence[Wish], matrix: Matrix, runs: Sequence[Run], ask: "Rounds") -> list[Shrunk]:
    """The edge of each wish in each cell of its fault; a value breaks a band when it does in any run of the cell."""
    found: list[_Search] = []
    for wish in wishes:
        cells: dict[tuple, list[Run]] = {}
        for run in runs:
            if run.fault == wish.fault.name:
                cells.setdefault(run.cell, []).append(run)
        found += [_Search(wish, cell) for cell in cells.values()]
    _try(found, [one.wish.harmless for one in found], ask)
    _try(found, [one.wish.harmful for one in found], ask)
    for _ in range(HALVINGS):
        open_ = [(one, value) for one in found if (value := one.next) is not None]
        _try([one for one, _ in open_], [value for _, value in open_], ask)
    return [one.found for one in found]


def _try(searches: list[_Search], values: list[float], ask: "Rounds") -> None:
    points = [one.points(value) for one, value in zip(searches, values, strict=True)]
    results = iter(ask([point for rows in points for point in rows]))
    for one, value, rows in zip(searches, values, points, strict=True):
        one.learn(value, [next(results) for _ in rows])
