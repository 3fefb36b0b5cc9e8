"""A branch from a pipe: three pipes that meet at a junction, (2.99) to (2.101), by characteristics.

The branch leaves the pipe at a distance from its left end. Its far end is closed, or held at the pressure that the
junction has before t = 0, so that nothing flows in it until then.
"""

from typing import NamedTuple

import numpy as np

from bridge.errors import UsageError, nearest
from bridge.scenario.units import option
from twin.lines.friction import turbulence
from twin.lines.lab.friction import Friction
from twin.lines.lab.network import Net, march_net
from twin.lines.lab.pipe import PRESSURE, Array, Case, History, Pipe, sampled, steady_pressure

BRANCH_ENDS = ("closed", "reservoir")
MOST_CELLS, MOST_WORK = 20_000, 4e8  # cells, and cells times steps: some seconds
LEFT, JUNCTION, RIGHT, FAR = range(4)  # junctions of the net


class Branch(NamedTuple):
    """What leaves the pipe."""

    pipe: Pipe
    at: float  # from the left end of the main pipe [m]
    end: str  # of BRANCH_ENDS


class BranchHistory(NamedTuple):
    """A run of a pipe with a branch."""

    ends: History  # of the main pipe
    junction: Array  # pressure where they meet [Pa]
    far: Array  # pressure at the branch's far end [Pa]
    inflow: Array  # into the branch at the junction [m^3/s]
    courant: tuple[float, float, float]  # left part, right part, branch


def branch_of(case: Case, length: str, diameter: str | None, at: str | None, end: str) -> Branch:
    """What a person writes. UsageError: an unknown end; ValueError: a place outside the pipe."""
    if end not in BRANCH_ENDS:
        raise UsageError(f"branch end {end!r} is unknown{nearest(end, BRANCH_ENDS)}")
    main = case.pipe
    place = option("branch-at", at, "m", above=0.0) if at else 0.5 * main.length
    if not place < main.length:
        raise ValueError(f"--branch-at {place:g} m is not inside the pipe of {main.length:g} m; take less")
    bore = option("branch-diameter", diameter, "m", above=0.0) if diameter else main.diameter
    return Branch(main._replace(length=option("branch", length, "m", above=0.0), diameter=bore), place, end)


def with_branch(
    case: Case, branch: Branch, model: Friction, cells: int, span: float, courant: float = 1.0
) -> BranchHistory:
    """Run the three pipes. cells: along the main pipe, the parts alike; no Courant number is above the given one."""
    if not 0.0 < courant <= 1.0:
        raise ValueError(f"Courant number {courant} is outside 0 < C <= 1, where characteristics are stable")
    main = case.pipe
    parts = (main._replace(length=branch.at), main._replace(length=main.length - branch.at), branch.pipe)
    counts, step = _mesh(parts, cells / main.length, span, courant)
    times = step * np.arange(round(span / step) + 1)
    net = Net(parts, ((LEFT, JUNCTION), (JUNCTION, RIGHT), (JUNCTION, FAR)), _held(case, branch))
    places = [np.linspace(0.0, parts[0].length, counts[0] + 1), np.linspace(branch.at, main.length, counts[1] + 1)]
    start = [steady_pressure(case, x, _steady_rate(case, model)) for x in places]
    start.append(np.full(counts[2] + 1, start[1][0]))
    found = march_net(net, [model] * 3, step, counts, _values(case, branch, times, start[1][0]), start,
                      [case.velocity, case.velocity, 0.0])  # fmt: skip
    ends = History(times, found[:, 0, 0], found[:, 1, 1], found[:, 0, 2], found[:, 1, 3])
    c = tuple(step * n / part.travel_time for part, n in zip(parts, counts, strict=True))
    return BranchHistory(ends, found[:, 0, 1], found[:, 2, 1], found[:, 2, 2] * branch.pipe.area, (c[0], c[1], c[2]))


def _mesh(parts: tuple[Pipe, ...], per_metre: float, span: float, courant: float) -> tuple[list[int], float]:
    """Cells of each part, at least one, and the step [s]. ValueError: too much work."""
    cells = [max(1.0, part.length * per_metre) for part in parts]
    if sum(cells) > MOST_CELLS:
        raise ValueError(f"pipe and branch have {sum(cells):.3g} cells, limit {MOST_CELLS}; take a shorter --branch")
    counts = [round(n) for n in cells]
    step = courant * min(part.travel_time / n for part, n in zip(parts, counts, strict=True))
    if span / step * sum(counts) > MOST_WORK:
        least = min(part.length for part in parts)
        raise ValueError(f"a part of {least:g} m makes {span / step:.2g} steps; take a longer one, or a shorter --span")
    return counts, step


def _held(case: Case, branch: Branch) -> tuple[int, ...]:
    ends = case.left.holds == PRESSURE, False, case.right.holds == PRESSURE, branch.end == "reservoir"
    return tuple(int(held) for held in ends)


def _values(case: Case, branch: Branch, times: Array, at_junction: float) -> Array:
    """What the net's junctions hold: pressures [Pa], or inflows [m^3/s]."""
    values = np.zeros((len(times), 4))
    for junction, end, sign in ((LEFT, case.left, 1.0), (RIGHT, case.right, -1.0)):
        values[:, junction] = sampled(end, times) * (1.0 if end.holds == PRESSURE else sign * case.pipe.area)
    if branch.end == "reservoir":
        values[:, FAR] = at_junction
    return values


def _steady_rate(case: Case, model: Friction) -> float:
    """Steady friction over u [1/s] before t = 0."""
    pipe = case.pipe
    reynolds = abs(case.velocity) * pipe.diameter / pipe.viscosity if model.turbulent else 0.0
    return model.steady * pipe.steady_rate * turbulence(reynolds)
