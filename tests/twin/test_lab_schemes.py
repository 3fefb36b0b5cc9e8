"""The laboratory of lines, space and time: orders, dispersion, stability of closures, steps chosen by the error."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvals

from twin.lines.lab.friction import friction
from twin.lines.lab.integrate import TIMES, march_adaptive, until
from twin.lines.lab.pipe import PRESSURE, VELOCITY, Array, Case, End, Pipe, closed, reservoir
from twin.lines.lab.space import SPACES, Grid, grid, periodic_grid, relative_speed
from twin.lines.lab.system import LineSystem, State, line_system
from twin.lines.lab.tableau import PAIRS, Tableau

UNIT = Pipe(1.0, 0.02, 1.0, 1.0, 1e-6)  # L = a = rho a = 1
NONE = friction("none")
UNIFORM = ("cds3", "cds5", "fem")
TIME_ORDER = {"backward-euler": 1, "bdf2": 2, "esdirk3": 3, "esdirk4": 4, "esdirk5": 5}
SPACE_ORDER = {
    ("cds3", "reflecting"): 2, ("cds5", "reflecting"): 3, ("fem", "reflecting"): 4,
    ("cds3", "driven"): 2, ("cds5", "driven"): 3, ("fem", "driven"): 2,
}  # fmt: skip


def travelling(x: Array, t: float) -> Array:
    """(p, u) of a wave that runs through."""
    return np.tile(np.sin(2.0 * np.pi * (x - t)), 2)


def standing(x: Array, t: float) -> Array:
    """(p, u) of a wave between a shut and an open end, three quarters of it long."""
    k = 1.5 * np.pi
    return np.concatenate([np.cos(k * x) * np.cos(k * t), np.sin(k * x) * np.sin(k * t)])


CASES = {
    "driven": (
        Case(
            UNIT,
            End(VELOCITY, lambda t: float(np.sin(-2.0 * np.pi * t))),
            End(PRESSURE, lambda t: float(np.sin(2.0 * np.pi * (1.0 - t)))),
            0.0,
            0.0,
        ),
        travelling,
    ),
    "reflecting": (Case(UNIT, closed(), reservoir(0.0), 0.0, 0.0), standing),
}


def error(space: str, time: str, ends: str, cells: int, steps: int, held_over_step: bool = False) -> float:
    """rms of (p, u) after one travel time."""
    case, solution = CASES[ends]
    places = grid(space, cells, 1.0)
    system, start = line_system(case, places, NONE)
    start = State(solution(places.x, 0.0), start.w)
    found = until(system, start, time, 1.0 / steps, 1.0, held_over_step).y
    return float(np.sqrt(np.mean((found - solution(places.x, 1.0)) ** 2)))


def order_of(first: float, second: float) -> float:
    return math.log2(first / second)


@pytest.mark.parametrize("ends", CASES)
@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("space", UNIFORM)
def test_a_pair_has_the_lower_order_of_both(space: str, time: str, ends: str):
    """Step and cell halved together: FEM loses two orders where waves come in, cds5 has the three of its closure."""
    cells = 64 if time == "backward-euler" else 32
    found = order_of(error(space, time, ends, cells, cells), error(space, time, ends, 2 * cells, 2 * cells))
    assert found == pytest.approx(min(SPACE_ORDER[space, ends], TIME_ORDER[time]), abs=0.2)


@pytest.mark.parametrize("ends", CASES)
@pytest.mark.parametrize("time", TIMES)
def test_collocation_leaves_the_order_of_the_time_scheme(time: str, ends: str):
    """20 cells are exact to 1e-9 here."""
    steps = {"backward-euler": 200, "bdf2": 60, "esdirk3": 60, "esdirk4": 50, "esdirk5": 40}[time]
    found = order_of(error("chebyshev", time, ends, 20, steps), error("chebyshev", time, ends, 20, 2 * steps))
    assert found == pytest.approx(TIME_ORDER[time], abs=0.35)


@pytest.mark.parametrize("ends", CASES)
def test_collocation_converges_faster_than_any_power(ends: str):
    """Twelve cells err by some 1e-7 to 1e-6, sixteen by a hundred times less."""
    coarse, fine = (error("chebyshev", "esdirk5", ends, cells, 400) for cells in (12, 16))
    assert coarse < 2e-6
    assert fine < coarse / 100.0


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("space", UNIFORM)
def test_boundary_values_held_over_a_step_leave_first_order(space: str, time: str):
    """The flaw of the thesis; at 128 cells it costs a factor of 10 to 1000 where the time scheme is of order 2 up."""
    coarse, fine = (error(space, time, "driven", n, n, held_over_step=True) for n in (64, 128))
    assert order_of(coarse, fine) == pytest.approx(1.0, abs=0.2)
    if time != "backward-euler":
        assert fine > 5.0 * error(space, time, "driven", 128, 128)


@pytest.mark.parametrize("space", UNIFORM)
def test_dispersion_on_a_ring(space: str):
    """M^-1 D of a wave is i kappa times its wave number, for every wave on the ring."""
    cells = 24
    ring = periodic_grid(space, cells, float(cells))
    for mode in range(1, cells // 2):
        angle = 2.0 * np.pi * mode / cells
        wave = np.exp(1j * angle * np.arange(cells))
        slope = np.linalg.solve(ring.mass.toarray(), ring.derivative @ wave)
        assert slope == pytest.approx(1j * angle * relative_speed(space, np.array(angle)) * wave, abs=1e-12)


@pytest.mark.parametrize(
    ("space", "errors"),
    [
        ("cds3", [6.4750e-1, 1.6505e-1, 4.1331e-2, 1.0335e-2]),
        ("cds5", [8.2938e-3, 5.2129e-4, 3.2627e-5, 2.0399e-6]),
        ("fem", [1.4032e-3, 8.7209e-5, 5.4429e-6, 3.4006e-7]),
    ],
)
def test_ten_periods_on_a_ring(space: str, errors: list[float]):
    """Exact in time: the phase is late by 20 pi (1 - kappa), so the relative error is 2 |sin(10 pi (1 - kappa))|."""
    angle = 2.0 * np.pi / np.array([25.0, 50.0, 100.0, 200.0])
    late = 2.0 * np.abs(np.sin(10.0 * np.pi * (1.0 - relative_speed(space, angle))))
    assert late == pytest.approx(errors, rel=2e-4)


def test_a_ring_in_time_carries_the_dispersion():
    """march without ends: ten periods of FEM with 25 cells and short steps."""
    ring = periodic_grid("fem", 25, 1.0)
    system = LineSystem(UNIT, ring, NONE, {})
    start = State(travelling(ring.x, 0.0), np.zeros((0, 25)))
    found = until(system, start, "esdirk5", 0.02, 10.0).y
    assert np.sqrt(2.0 * np.mean((found - start.y) ** 2)) == pytest.approx(1.4032e-3, rel=1e-2)


def spectrum(places: Grid) -> Array:
    """Eigenvalues [a/L] between a shut and an open end."""
    system, _ = line_system(CASES["reflecting"][0], places, NONE)
    inner = np.flatnonzero(system.free)
    rate, mass = (np.asarray(matrix.toarray())[inner][:, inner] for matrix in (system.rate, system.mass))
    return np.asarray(eigvals(rate, mass))


@pytest.mark.parametrize(
    ("closure", "cells", "growth"),
    [("one-sided 5", 50, 2.63), ("one-sided 5", 100, 5.26), ("one-sided 4", 50, 0.55), ("one-sided 4", 100, 0.55)],
)
def test_one_sided_closures_grow(closure: str, cells: int, growth: float):
    """Five points: faster the finer the grid, hence unstable. Four: exp(0.55 a t/L) whatever the grid."""
    assert spectrum(grid("cds5", cells, 1.0, closure)).real.max() == pytest.approx(growth, rel=0.03)


@pytest.mark.parametrize("cells", [16, 50, 100])
@pytest.mark.parametrize("space", SPACES)
def test_closures_in_use_do_not_grow(space: str, cells: int):
    """Summation by parts: neutral, all eigenvalues on the imaginary axis. Collocation: none to the right of it."""
    found = spectrum(grid(space, cells, 1.0))
    rounding = 1e-13 * np.abs(found).max() * cells
    assert found.real.max() < rounding
    if space != "chebyshev":
        assert found.real.min() > -rounding


@pytest.mark.parametrize("space", ["cds3", "fem"])
def test_reflecting_ends_have_the_frequencies_of_the_ring(space: str):
    """sin(th)/h and 3 sin(th)/((2 + cos th) h), th = (2 m + 1) pi h/2: no order is lost at the ends."""
    cells = 20
    angle = (2.0 * np.arange(cells) + 1.0) * np.pi / (2.0 * cells)
    right = np.sort(angle * relative_speed(space, angle)) * cells
    found = np.sort(spectrum(grid(space, cells, 1.0)).imag)[cells:]
    assert found == pytest.approx(right, rel=1e-9)


def test_collocation_is_stiff():
    """Spectral radius 0.436 N^2 of N cells."""
    for cells in (30, 60):
        assert np.abs(spectrum(grid("chebyshev", cells, 1.0))).max() == pytest.approx(0.436 * cells**2, rel=0.02)


@pytest.mark.parametrize("space", UNIFORM)
def test_summation_by_parts(space: str):
    """H M^-1 D + its transpose is +-1 at the ends and nothing else: no energy is made inside."""
    places = grid(space, 17, 2.0)
    q = places.norm @ np.linalg.solve(places.mass.toarray(), places.derivative.toarray())
    ends = np.zeros_like(q)
    ends[0, 0], ends[-1, -1] = -1.0, 1.0
    assert q + q.T == pytest.approx(ends, abs=1e-14)


def conditions(weights: Array, pair: Tableau) -> list[list[Any]]:
    """What is left of the order conditions of each order, 17 up to the fifth."""
    a, b, c = pair.a, weights, pair.c
    return [
        [b.sum() - 1.0],
        [b @ c - 1 / 2],
        [b @ c**2 - 1 / 3, b @ a @ c - 1 / 6],
        [b @ c**3 - 1 / 4, b @ (c * (a @ c)) - 1 / 8, b @ a @ c**2 - 1 / 12, b @ a @ a @ c - 1 / 24],
        [
            b @ c**4 - 1 / 5, b @ (c**2 * (a @ c)) - 1 / 10, b @ (c * (a @ c**2)) - 1 / 15,
            b @ (c * (a @ a @ c)) - 1 / 30, b @ (a @ c) ** 2 - 1 / 20, b @ a @ c**3 - 1 / 20,
            b @ a @ (c * (a @ c)) - 1 / 40, b @ a @ a @ c**2 - 1 / 60, b @ a @ a @ a @ c - 1 / 120,
        ],
    ]  # fmt: skip


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_tableaux(pair: Tableau):
    """Both members meet all conditions of their order and not those of the next; stage order 2; stiffly accurate."""
    for weights, order in ((pair.b, pair.order), (pair.embedded, pair.order - 1)):
        left = conditions(weights, pair)
        assert max(abs(value) for row in left[:order] for value in row) < 1e-14
        if order < 5:
            assert max(abs(value) for value in left[order]) > 1e-5
    assert pair.a.sum(axis=1) == pytest.approx(pair.c, abs=2e-15)
    assert (pair.a @ pair.c)[1:] == pytest.approx(pair.c[1:] ** 2 / 2.0, abs=2e-15)
    assert pair.a[-1] == pytest.approx(pair.b, abs=0.0)


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_tableaux_are_stable_to_the_left(pair: Tableau):
    """|R| <= 1 on the imaginary axis, 0 at infinity; R = 1 + z b (1 - z A)^-1 1."""
    one = np.ones(len(pair.c))

    def size(z: complex) -> float:
        return float(abs(1.0 + z * pair.b @ np.linalg.solve(np.eye(len(one)) - z * pair.a, one)))

    assert max(size(1j * y) for y in np.geomspace(1e-3, 1e4, 400)) <= 1.0 + 1e-12
    assert size(-1e6) < 1e-3


@pytest.mark.parametrize("time", PAIRS)
def test_steps_follow_the_tolerance(time: str):
    """A hundredth of the tolerance: an error smaller by at least five times, from more steps; ends at the span."""
    case, solution = CASES["driven"]
    places = grid("chebyshev", 20, 1.0)
    system, start = line_system(case, places, NONE)
    off, counts = [], []
    for tolerance in (1e-4, 1e-6):
        states = list(march_adaptive(system, State(solution(places.x, 0.0), start.w), time, tolerance, 1.3))
        assert states[-1][0] == pytest.approx(1.3, rel=1e-12)
        off.append(float(np.abs(states[-1][1].y - solution(places.x, 1.3)).max()))
        counts.append(len(states))
    assert off[0] < 1e-2
    assert off[1] < off[0] / 5.0
    assert counts[1] > counts[0]


def test_only_pairs_have_an_error_to_choose_steps_by():
    system, start = line_system(CASES["driven"][0], grid("fem", 8, 1.0), NONE)
    with pytest.raises(ValueError, match=r"bdf2.*embedded.*esdirk3"):
        next(march_adaptive(system, start, "bdf2", 1e-3, 1.0))


@pytest.mark.parametrize(("space", "cells"), [("cds5", 7), ("fem", 1), ("cds7", 30)])
def test_refusals_of_a_grid(space: str, cells: int):
    with pytest.raises(ValueError, match=f"{cells} cells.*{space}.*or more|{space}.*known"):
        grid(space, cells, 1.0)
