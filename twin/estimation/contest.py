"""Which of several faults explains what a rig does: twins with one number changed each, beside it in short shots.

Each hypothesis has twins of several sizes s, and the baseline one of none. r(s) are a twin's residuals in units of what
the baseline's were while the rig was in order, between the sizes that run taken as linear in the number itself and
not in ln of its factor: what a leak, a drop or a rub does is proportional to it. J(s) is their mean square in a shot.
How large they are differs from shot to shot, as the motion does; with nothing known of their scale but that it is no
less than when the rig was in order, n independent residuals of a shot have the log likelihood

    -n/2 ln(1 + J),

which is that of Student's t but for constants, so that no single shot decides. Its sum over the shots is greatest at
the size of a hypothesis, and tells hypotheses apart. The deviation of the size is the jackknife's, over the shots, and
that of the places at which it is looked for.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.actuator import areas
from twin.estimation.filter import Filter
from twin.estimation.hypotheses import CREEP, DOWN, HYPOTHESES, UP, Hypothesis
from twin.estimation.quantities import LEAKS_OUTSIDE, UNKNOWNS
from twin.estimation.shots import Shots, known_to
from twin.kernel import interpreted

Array = NDArray[np.float64]
SIZES = (0.5, 1.0, 2.0, 4.0, 8.0)  # in deviations of the unknown at the start
INDEPENDENT = 4.0  # residuals of a shot, assumed: five channels that swing together for some periods
BETWEEN = np.linspace(0.0, 1.0, 33)  # of two sizes, where one is looked for


class Ranking(NamedTuple):
    """What the shots say so far; by name of hypotheses."""

    behind: dict[str, float]  # ln of how much less likely than the first; the likeliest comes first
    nothing: float  # the same of the baseline
    sizes: dict[str, tuple[float, float]]  # ln of the factor, or an offset in SI, and its deviation
    square: float  # J of the first, median of the shots
    without: float  # the same of the baseline
    shots: int


class Link(NamedTuple):
    """Two twins of neighbouring sizes of a hypothesis."""

    name: str
    rows: tuple[int, int]
    sizes: tuple[float, float]
    factor: bool = False  # sizes are ln of one

    def shares(self) -> Array:
        """How far from the first to the second the number is, at places evenly between their sizes."""
        first, second = self.sizes
        return np.expm1((second - first) * BETWEEN) / math.expm1(second - first) if self.factor else BETWEEN


class Contest:
    """From now on, beside one estimate."""

    def __init__(self, estimate: Filter, baseline: Array, scales: Array) -> None:
        """baseline: of the unknowns of the estimate; scales: of a residual by channel, with the rig in order."""
        names = known_to(estimate)
        self._links, z = _twins(estimate, names, baseline)
        self._scales = scales
        self._pairs = np.array([link.rows for link in self._links]).T
        self._shots = Shots(estimate, names, z)
        self._squares: list[Array] = []  # a row for each shot: J of each twin
        self._products: list[Array] = []  # and the mean product of the residuals of each link
        self._begin()

    @property
    def over(self) -> bool:
        """Is a shot at its end?"""
        return self._shots.over

    @property
    def shots(self) -> int:
        """That are finished."""
        return len(self._squares)

    def advance(self, reference: float, steps: int) -> None:
        """Move on under a spool reference."""
        self._shots.advance(reference, steps)

    def look(self, readings: Mapping[str, float]) -> None:
        """Take a scan, after the estimate."""
        away = self._shots.look(readings)
        if away is None:
            return
        away = away / self._scales
        self._count += int(np.count_nonzero(~np.isnan(away[0])))
        away = np.nan_to_num(away)
        self._square += np.einsum("ij,ij->i", away, away)
        self._product += np.einsum("ij,ij->i", away[self._pairs[0]], away[self._pairs[1]])

    def turn(self) -> None:
        """End a shot, and begin the next at the estimate as it is now."""
        if self._count:
            self._squares.append(self._square / self._count)
            self._products.append(self._product / self._count)
        self._begin()

    def ranking(self) -> Ranking:
        """After one shot at least."""
        return rank(self._links, np.array(self._squares), np.array(self._products))

    def _begin(self) -> None:
        self._square, self._product, self._count = np.zeros(1 + self._pairs.max()), np.zeros(len(self._links)), 0
        self._shots.begin()


def rank(links: Sequence[Link], squares: Array, products: Array) -> Ranking:
    """What some shots say; squares: shots x twins, J of each; products: shots x links, of the residuals of its two."""
    low, high = np.array([link.rows for link in links]).T
    t = np.array([link.shares() for link in links])
    between = (
        squares[:, low, None] * (1.0 - t) ** 2
        + squares[:, high, None] * t**2
        + 2.0 * products[:, :, None] * t * (1.0 - t)
    )
    each = _likelihood(between)  # shots x links x places
    likely, sizes, left = {}, {}, {}
    for name in dict.fromkeys(link.name for link in links):
        mine = [k for k, link in enumerate(links) if link.name == name]
        places = np.array([np.interp(BETWEEN, (0.0, 1.0), links[k].sizes) for k in mine])
        of_shots, total = each[:, mine], each[:, mine].sum(axis=0)
        at = np.unravel_index(np.argmax(total), total.shape)
        without = [float(places.flat[np.argmax(total - one)]) for one in of_shots]
        likely[name] = float(total[at])
        apart = float(abs(places[at[0], 1] - places[at[0], 0]))
        sizes[name] = float(places[at]), math.sqrt((len(without) - 1) * float(np.var(without)) + apart**2 / 12.0)
        left[name] = float(np.median(between[:, mine][:, at[0], at[1]]))
    order = sorted(likely, key=likely.__getitem__, reverse=True)
    first = likely[order[0]]
    nothing = first - float(_likelihood(squares[:, 0]).sum())
    behind = {name: first - likely[name] for name in order}
    return Ranking(behind, nothing, sizes, left[order[0]], float(np.median(squares[:, 0])), len(squares))


def _likelihood(squares: Array) -> Array:
    return -0.5 * INDEPENDENT * np.log1p(squares)


def _twins(estimate: Filter, names: tuple[str, ...], baseline: Array) -> tuple[list[Link], Array]:
    """The links of all hypotheses, and the unknowns of their twins; that of the baseline is the first."""
    links, rows = [], [np.concatenate([baseline, np.zeros(len(names) - len(baseline))])]
    for name, hypothesis in HYPOTHESES.items():
        if hypothesis.unknown not in names:
            continue
        place, unit = names.index(hypothesis.unknown), _unit(estimate, hypothesis)
        factor = not UNKNOWNS[hypothesis.unknown].unit
        for sign in _signs(hypothesis):
            before, size = 0, 0.0
            for share in SIZES:
                row = rows[0].copy()
                row[place] += sign * share * unit
                links.append(Link(name, (before, len(rows)), (size, sign * share * unit), factor))
                before, size = len(rows), sign * share * unit
                rows.append(row)
    return links, np.array(rows)


def _signs(hypothesis: Hypothesis) -> Iterator[float]:
    if hypothesis.sign != DOWN:
        yield 1.0
    if hypothesis.sign != UP:
        yield -1.0


def _unit(estimate: Filter, hypothesis: Hypothesis) -> float:
    """Of sizes: the deviation of an unknown at the start."""
    if hypothesis.unknown in LEAKS_OUTSIDE:
        area = interpreted(areas)(estimate.circuit.parts.cylinder, 0.0)
        return CREEP * float(area.lower)
    return estimate.priors[hypothesis.unknown].deviation
