"""Lines with nodes inside: against the exact line, what they keep, and cavities inside the pipe."""

import math

import numpy as np
import pytest

from tests.support.exact_line import (
    CORNERS,
    ENDS,
    HELD_FLOW,
    HELD_PRESSURE,
    MIDDLE,
    RIG,
    STEEL,
    Pipe,
    at_rest,
    error,
    run,
)
from twin.lines.bank import arriving, bank_of, departing, inner_cavity, memory_size, profile, settle, steady_drop
from twin.lines.mesh import MIDDLE as SHORTEST_MIDDLE
from twin.lines.mesh import SEGMENTS, cut, friction_poles

PIPE = RIG[1]
VAPOUR = -1e5


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize(
    ("pipe", "step", "bar"),
    [(pipe, 50e-6, 0.012) for pipe in RIG] + [(pipe, 50e-6, 0.025) for pipe in MIDDLE] + [(CORNERS[12], 50e-6, 0.05)],
)
def test_error_against_the_exact_line(pipe: Pipe, ends: str, step: float, bar: float):
    """rms over 20 travel times in Joukowsky pressures. Friction is lumped in at most 15 places."""
    assert error(pipe, ends, step, "nodes") <= bar


@pytest.mark.parametrize("m", [3.2, 8.8, 17.6, 44.0, 63.5, 1333.3])
def test_cut_fills_the_line(m: float):
    segments, delay, middle = cut(m)
    assert (segments - 1) * delay + middle == pytest.approx(m)
    assert segments % 2 == 1
    assert segments <= SEGMENTS
    assert middle >= SHORTEST_MIDDLE


@pytest.mark.parametrize("pipe", [*RIG, *CORNERS])
@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_friction_is_positive_real(pipe: Pipe, step: float):
    """r_j >= 0 and 0 < p_j < 1: every term is, whatever the step."""
    p, r = friction_poles(pipe.viscous_time, "unsteady", step)
    assert np.all(r >= 0.0)
    assert np.all((p > 0.0) & (p < 1.0))
    assert r.sum() > 0.0


def test_frictionless_whole_steps_are_exact():
    """Courant one: Joukowsky's pressure, and the wave comes back unchanged."""
    pipe = Pipe(2.0, 11e-3, 40e-6, 1000.0)
    bank, memory = at_rest(pipe.spec("nodes", "none"), 100e-6)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([1e-4, 0.0], (400, 1)))[:, 0] / (1e-4 * pipe.impedance)
    assert p == pytest.approx(np.where(np.arange(400) // 40 % 2 == 0, 1.0, -1.0), abs=1e-12)


@pytest.mark.parametrize("flow", [1e-5, 8e-4])
def test_steady_start_stays_steady(flow: float):
    """Laminar and turbulent; the profile is a straight line."""
    bank = bank_of([PIPE.spec("nodes")], 50e-6, VAPOUR)
    memory = np.zeros(memory_size(bank))
    drop = steady_drop(bank, 0, flow)
    settle(bank, memory, np.array([5e6 + drop, 5e6]), np.array([flow]))
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([flow, 5e6], (20000, 1)))
    assert out[:, 0] == pytest.approx(5e6 + drop, rel=1e-9)
    assert out[:, 3] == pytest.approx(-flow, rel=1e-9)
    shape, xi = np.zeros(5), np.linspace(0.0, 1.0, 5)
    profile(bank, memory, 19999, 0, xi, shape)
    assert shape == pytest.approx(5e6 + (1.0 - xi) * drop, rel=1e-9)


def test_turbulent_drop_is_that_of_blasius():
    """0.3164 Re^-1/4 rho v^2/2 l/d at Re 10000, reached from rest."""
    q = 1e4 * math.pi / 4.0 * 11e-3 * 40e-6
    v = q / (math.pi / 4.0 * 11e-3**2)
    bank, memory = at_rest(PIPE.spec("nodes"), 50e-6)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([q, 0.0], (60000, 1)))[-1, 0]
    assert p == pytest.approx(0.3164 * 1e4**-0.25 * 878.0 * v**2 / 2.0 * PIPE.length / 11e-3, rel=1e-6)


@pytest.mark.parametrize("pipe", [*RIG, CORNERS[0]])
def test_mass_is_exact(pipe: Pipe):
    """Charged and at rest again, a shut line holds (V/B) p of what flowed in."""
    bank, memory = at_rest(pipe.spec("nodes"), 100e-6)
    steps = round((3.0 * pipe.viscous_time + 400.0 * pipe.travel_time) / 100e-6)
    values = np.zeros((steps, 2))
    values[:100, 0] = 1e-7
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), values)
    assert bank.capacity[0] * out[-1, :2].mean() == pytest.approx(100 * 1e-7 * 100e-6, rel=1e-9)


def test_ends_are_alike():
    """Driven at the other end, the same answers at the other end; 1e-9: sums in another order."""
    values = np.zeros((2000, 2))
    values[:, 0] = np.random.default_rng(1).normal(size=2000) * 1e-5
    left = run(*at_rest(PIPE.spec("nodes"), 50e-6), (HELD_FLOW, HELD_PRESSURE), values)
    right = run(*at_rest(PIPE.spec("nodes"), 50e-6), (HELD_PRESSURE, HELD_FLOW), values[:, ::-1].copy())[
        :, [1, 0, 3, 2]
    ]
    assert left == pytest.approx(right, rel=1e-9, abs=1e-9 * np.abs(left).max(axis=0).min())


def drained(steps: int, vapour: float = VAPOUR) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Oil drawn at both ends of a line, later given back: ports, cavity, least pressure inside, per tick."""
    bank = bank_of([PIPE.spec("nodes")], 50e-6, vapour)
    memory = np.zeros(memory_size(bank))
    settle(bank, memory, np.full(2, 2e5), np.zeros(1))
    size = 0.6 * 3e5 / PIPE.impedance  # neither wave alone reaches vapour pressure, both together do
    ports, cavity, least = np.zeros((steps, 4)), np.zeros(steps), np.zeros(steps)
    xi, shape = np.linspace(0.0, 1.0, 101), np.zeros(101)
    for k in range(steps):
        draw = -size if 10 <= k < 80 else size if 200 <= k < 270 else 0.0
        ports[k] = step_at(bank, memory, k, draw)
        profile(bank, memory, k, 0, xi, shape)
        cavity[k], least[k] = inner_cavity(bank, memory, 0), shape[(xi > 0.1) & (xi < 0.9)].min()
    return ports, cavity, least


def step_at(bank, memory, tick: int, flow: float) -> np.ndarray:
    c, z, q = np.zeros(2), np.zeros(2), np.full(2, flow)
    arriving(bank, memory, tick, c, z)
    departing(bank, memory, tick, q)
    return np.concatenate([c + z * q, q])


def test_cavity_opens_and_closes_inside_and_no_oil_is_lost():
    """Nothing inside falls below vapour pressure; without the cavity it would; given back, the oil closes it, and the
    line ends at the pressure of before: the sum of its flows is zero. 1e-5: the mean of what still rings by 1 %."""
    ports, cavity, least = drained(60_000)
    assert least.min() >= VAPOUR
    assert drained(300, -1e12)[2].min() < 2.0 * VAPOUR
    assert cavity.max() > 1e-8
    assert cavity[-1] == 0.0
    assert ports[-20_000:, :2].mean() == pytest.approx(2e5, rel=1e-5)


def test_cavity_is_what_the_oil_leaves_free():
    """Drawn and left alone: V = drawn - (V/B)(p0 - p_v) once the line is at vapour pressure; to 0.1 % of the drawn."""
    bank = bank_of([PIPE.spec("nodes")], 50e-6, VAPOUR)
    memory = np.zeros(memory_size(bank))
    settle(bank, memory, np.full(2, 2e5), np.zeros(1))
    size = 0.6 * 3e5 / PIPE.impedance
    drawn = 0.0
    for k in range(60_000):
        flow = -size if k < 400 else 0.0
        drawn -= 2.0 * 50e-6 * flow
        step_at(bank, memory, k, flow)
    free = drawn - bank.capacity[0] * 3e5
    assert inner_cavity(bank, memory, 0) == pytest.approx(free, abs=1e-3 * drawn)


@pytest.mark.parametrize("model", ["ends", "lumped"])
def test_other_models_have_no_inner_cavity(model: str):
    bank, memory = at_rest(PIPE.spec(model), 50e-6)
    assert inner_cavity(bank, memory, 0) == 0.0


def test_a_line_too_short_is_refused():
    with pytest.raises(ValueError, match=r"pipe_1, 0\.15.* m: .* limit 3 .* smaller loop\.step.*lumped"):
        bank_of([Pipe(0.15, 11e-3, 40e-6, STEEL).spec("nodes")], 50e-6, VAPOUR)
