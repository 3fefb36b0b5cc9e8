"""How the area of a land grows with the way of its spool: in proportion, or by a table of points.

A table is kept as a sum of hinges, share = sum c_k max(0, y - y_k), y the share of the way beyond the edge: nothing
has to be looked up. Which of them is fitted is known when a step is compiled.
"""

from itertools import pairwise
from typing import Any, NamedTuple

from twin.kernel import by_type

MOST_POINTS = 9  # of a table, 0 and 1 included


class InProportion(NamedTuple):
    """The area grows in proportion."""


class ByTable(NamedTuple):
    """Places y_k of the hinges, but for the first, which stands at 0; and their c_k."""

    at_1: float
    at_2: float
    at_3: float
    at_4: float
    at_5: float
    at_6: float
    at_7: float
    by_0: float
    by_1: float
    by_2: float
    by_3: float
    by_4: float
    by_5: float
    by_6: float
    by_7: float


Opening = InProportion | ByTable


@by_type
def share_open(opening: Any, beyond: float) -> float:
    """Share of a land's area at a share of its way beyond the edge, > 0."""
    raise TypeError(f"{opening} is not an opening")


@share_open.register
def _(opening: InProportion, beyond: float) -> float:
    return beyond


@share_open.register
def _(opening: ByTable, beyond: float) -> float:
    return (
        opening.by_0 * beyond
        + opening.by_1 * max(0.0, beyond - opening.at_1)
        + opening.by_2 * max(0.0, beyond - opening.at_2)
        + opening.by_3 * max(0.0, beyond - opening.at_3)
        + opening.by_4 * max(0.0, beyond - opening.at_4)
        + opening.by_5 * max(0.0, beyond - opening.at_5)
        + opening.by_6 * max(0.0, beyond - opening.at_6)
        + opening.by_7 * max(0.0, beyond - opening.at_7)
    )


def hinges(points: tuple[tuple[float, float], ...]) -> ByTable:
    """A table of shares of the area over shares of the way beyond the edge; ValueError says what it lacks."""
    _check_points(points)
    slopes = [(d - b) / (c - a) for (a, b), (c, d) in pairwise(points)]
    changes = [slopes[0], *(after - before for before, after in pairwise(slopes))]
    inner, more = [x for x, _ in points[1:-1]], MOST_POINTS - len(points)
    return ByTable(*inner, *[1.0] * more, *changes, *[0.0] * more)


def _check_points(points: tuple[tuple[float, float], ...]) -> None:
    if not 2 <= len(points) <= MOST_POINTS:
        raise ValueError(f"servo_valve.table has {len(points)} points; take 2 to {MOST_POINTS}")
    if tuple(points[0]) != (0.0, 0.0) or tuple(points[-1]) != (1.0, 1.0):
        raise ValueError(f"servo_valve.table begins at {points[0]} and ends at {points[-1]}; take (0, 0) and (1, 1)")
    for (a, b), (c, d) in pairwise(points):
        if c <= a or d < b:
            raise ValueError(f"servo_valve.table goes from {(a, b)} to {(c, d)}; ways must grow and areas not fall")


def opening_slope(opening: Opening, beyond: float) -> float:
    """Slope of the share of the area by the share of the way, to the right of a place >= 0."""
    if isinstance(opening, InProportion):
        return 1.0
    places, changes = (0.0, *opening[: MOST_POINTS - 2]), opening[MOST_POINTS - 2 :]
    return sum(change for place, change in zip(places, changes, strict=True) if beyond >= place)
