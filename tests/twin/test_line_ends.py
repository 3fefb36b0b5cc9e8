"""Lines seen from their ends: against the exact line, what they keep, and what they never do."""

import math

import numpy as np
import pytest

from tests.support.exact_line import (
    CORNERS,
    ENDS,
    HELD_FLOW,
    HELD_PRESSURE,
    HOSE,
    MIDDLE,
    PEER,
    PEER_SPAN,
    RAMP,
    RIG,
    STEEL,
    TRAVELS,
    Pipe,
    at_rest,
    drive,
    echoes,
    error,
    exact,
    inside,
    ramped,
    rms,
    run,
    simulate,
)
from twin.kernel import interpreted
from twin.lines.bank import (
    Bank,
    arriving,
    bank_of,
    departing,
    memory_size,
    packed,
    profile,
    settle,
    steady_drop,
    steady_slope,
    unpacked,
)
from twin.lines.friction import turbulence

LONG_LOSSY = Pipe(40.0, 8e-3, 100e-6, 600.0)  # Dn 0.42, the worst of all at 8 poles
SHORT = Pipe(0.5, 20e-3, 10e-6, 600.0)  # 8.3 steps of 100 us
SHORTEST = Pipe(0.5, 20e-3, 10e-6, 1330.0)  # 3.8 steps of 100 us
WATER = Pipe(40.0, 0.02, 1.46e-6, 1319.0, 1000.0)  # fig. 2.27: 2L/a 60.652 ms, nu/R^2 0.0146 1/s
PAIR = RIG[1]


def ramp_by_echoes(pipe: Pipe, t: float, time: float) -> float:
    """Pressure at end 1 [Z0 dq], end 2 held, for a flow that rises to one over a time."""
    return (echoes(pipe, t, 2) - (echoes(pipe, t - time, 2) if t > time else 0.0)) / time


@pytest.mark.parametrize("t", [0.3e-3, 2.55e-3, 10.05e-3, 20e-3])
def test_two_inversions_agree(t: float):
    """One FFT of the whole answer, and Talbot's contour echo by echo. 1e-5: the FFT's end at 16 points per step."""
    at = round(t / 50e-6) - 1
    assert exact(RIG[0], "flow", 50e-6, 500)[0][at] == pytest.approx(ramp_by_echoes(RIG[0], t, RAMP), abs=1e-5)


@pytest.mark.parametrize(
    ("t", "bar"), [(0.095978, 11.263803), (0.121317, 11.295954), (0.217282, 11.181358), (0.242665, 11.239402)]
)
def test_exact_line_reproduces_the_table_of_the_source(t: float, bar: float):
    """Fig 2.27: rho a v0 = 1.319 bar, shut linearly in 10 ms (only so the peaks follow)."""
    drop = 11.68 * 40.0 / 1e5
    assert 10.0 + drop - 1.319 * ramp_by_echoes(WATER, t, 0.01) == pytest.approx(bar, abs=2e-6)


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize(
    ("pipe", "step", "bar"),
    [(pipe, step, bar) for pipe in RIG for step, bar in ((50e-6, 0.003), (100e-6, 0.008))]
    + [(pipe, step, bar) for pipe in MIDDLE for step, bar in ((50e-6, 0.010), (100e-6, 0.016))]
    + [(SHORT, 50e-6, 0.010), (SHORT, 100e-6, 0.016), (SHORTEST, 50e-6, 0.025), (SHORTEST, 100e-6, 0.025)],
)
def test_error_against_the_exact_line(pipe: Pipe, ends: str, step: float, bar: float):
    """rms over 20 travel times in Joukowsky pressures: the bars of the study, all lines in `tests.benchmarks lines`."""
    assert error(pipe, ends, step, "ends") <= bar


@pytest.mark.parametrize(("step", "bar"), [(50e-6, 0.010), (100e-6, 0.016)])
def test_long_lossy_line(step: float, bar: float):
    assert error(LONG_LOSSY, "flow", step, "ends") <= bar


@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_a_three_metre_line_of_another_simulator(step: float):
    """100 ms: at most 0.003 of Joukowsky's pressure, where a hose with steady friction misses by 0.43 to 0.57."""
    assert error(PEER, "flow", step, "ends", PEER_SPAN) <= 0.003


@pytest.mark.parametrize(("m", "step", "bar"), [(38, 50e-6, 0.003), (19, 100e-6, 0.005)])
def test_nothing_depends_on_how_the_travel_time_rounds(m: int, step: float, bar: float):
    """31 lengths between two whole M: the fraction is in the taps."""
    lengths = (m + np.linspace(0.0, 1.0, 31)) * step * STEEL
    assert max(error(Pipe(length, 11e-3, 40e-6, STEEL, 878.0), "flow", step, "ends") for length in lengths) <= bar


@pytest.mark.parametrize("ends", ["flow", "press", "closed"])
@pytest.mark.parametrize("dissipation", [1e-5, 5e-4, 1e-2])
def test_eight_steps_are_enough(dissipation: float, ends: str):
    """M from 8 to 9 at 100 us, where a front of five steps meets the fewest taps."""
    for m in (8.0, 8.06, 8.125, 8.2, 8.35, 8.49, 8.5, 8.65, 8.8, 8.99999):
        diameter = math.sqrt(4.0 * 40e-6 * m * 100e-6 / dissipation)
        assert error(Pipe(m * 0.1, diameter, 40e-6, 1000.0), ends, 100e-6, "ends") <= 0.016


@pytest.mark.parametrize("friction", ["none", "steady", "quasi-steady", "unsteady"])
@pytest.mark.parametrize("pipe", [RIG[1], MIDDLE[3]])
def test_each_friction_meets_its_own_exact_line_and_no_other(pipe: Pipe, friction: str):
    """Laminar; steady and quasi-steady are one, they part with Re (below)."""
    step, count = 50e-6, int(TRAVELS * pipe.travel_time / 50e-6)
    p = simulate(pipe, "flow", step, count, "ends", friction)[0]
    same = "steady" if friction == "quasi-steady" else friction
    for other in ("none", "steady", "unsteady"):
        off = rms(p, exact(pipe, "flow", step, count, other)[0])
        assert off <= 0.003 if other == same else off >= 0.1


BLASIUS = 0.3164 * 1e4**0.75 / 64.0  # over Hagen-Poiseuille, at Re = 10^4


@pytest.mark.parametrize(
    ("friction", "factor"), [("none", 0.0), ("steady", 1.0), ("quasi-steady", BLASIUS), ("unsteady", BLASIUS)]
)
@pytest.mark.parametrize("model", ["lumped", "ends", "nodes"])
def test_only_frictions_that_know_reynolds_turn_turbulent(model: str, friction: str, factor: float):
    bank = bank_of([PAIR.spec(model, friction)], 50e-6, -1e5)
    q = 1e4 * math.pi / 4.0 * 11e-3 * 40e-6
    laminar = 128.0 * 878.0 * 40e-6 * PAIR.length / (math.pi * 11e-3**4) * q
    assert steady_drop(bank, 0, q) == pytest.approx(factor * laminar, rel=1e-9)


@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_tenth_peak(step: float):
    """Fig. 2.27: within 1 % of its amplitude after ten periods of friction with memory."""
    shut, flow = 0.01, 1e-6
    travel = WATER.travel_time
    times = 40.0 * travel + np.linspace(-2e-3, 4e-3, 121)
    right = max(-ramp_by_echoes(WATER, t, shut) for t in times)
    bank, memory = at_rest(WATER.spec(), step)
    steps = math.ceil(times[-1] / step)
    values = np.zeros((steps, 2))
    values[:, 0] = -flow * np.minimum(1.0, step * np.arange(1, steps + 1) / shut)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), values)[:, 0] / (flow * WATER.impedance)
    assert p[round(38.0 * travel / step) :].max() == pytest.approx(right, rel=0.01)


@pytest.mark.parametrize("friction", ["steady", "unsteady"])
@pytest.mark.parametrize("pipe", [*RIG, SHORTEST, LONG_LOSSY])
def test_steady_drop_is_exact(pipe: Pipe, friction: str):
    """S-(1) is a constraint of the fit: reached from rest, smoothly: what rings near Nyquist dies slowly.
    Eight t_v: e^-32 of ringing with steady friction."""
    bank, memory = at_rest(pipe.spec("ends", friction), 100e-6)
    flow, steps = 1e-7, round((8.0 * pipe.viscous_time + 200.0 * pipe.travel_time) / 100e-6)
    values = np.tile([flow, 0.0], (steps, 1))
    values[:200, 0] *= 0.5 - 0.5 * np.cos(np.pi * np.arange(200) / 200.0)
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), values)
    assert out[-1, 0] == pytest.approx(steady_drop(bank, 0, flow), rel=1e-6)
    assert out[-1, 3] == pytest.approx(-flow, rel=1e-9)


@pytest.mark.parametrize("pipe", [*RIG, SHORTEST, LONG_LOSSY])
def test_mass_is_exact(pipe: Pipe):
    """Charged and at rest again, a shut line holds (V/B) p of what flowed in, S+'(1): pressure to 1e-9 of it."""
    bank, memory = at_rest(pipe.spec(), 100e-6)
    charge, steps = 100, round((3.0 * pipe.viscous_time + 400.0 * pipe.travel_time) / 100e-6)
    values = np.zeros((steps, 2))
    values[:charge, 0] = 1e-7
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), values)
    held = bank.capacity[0] * out[-1, :2].mean()
    assert held == pytest.approx(charge * 1e-7 * 100e-6, rel=1e-9)


def test_lossless_line_of_whole_steps_is_a_pure_delay():
    """No fraction, no friction: the wave comes back unchanged, Joukowsky's pressure to rounding."""
    pipe = Pipe(2.0, 11e-3, 40e-6, 1000.0)
    bank, memory = at_rest(pipe.spec("ends", "none"), 100e-6)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([1e-4, 0.0], (400, 1)))[:, 0] / (1e-4 * pipe.impedance)
    assert p == pytest.approx(np.where(np.arange(400) // 40 % 2 == 0, 1.0, -1.0), abs=1e-12)


@pytest.mark.parametrize(("flow", "friction"), [(1e-5, "unsteady"), (8e-4, "unsteady"), (8e-4, "quasi-steady")])
def test_steady_start_stays_steady(flow: float, friction: str):
    """Laminar and turbulent: nothing moves. 1e-9: rounding, summed over 20000 steps."""
    bank = bank_of([PAIR.spec("ends", friction)], 50e-6, -1e5)
    memory = np.zeros(memory_size(bank))
    drop = steady_drop(bank, 0, flow)
    settle(bank, memory, np.array([5e6 + drop, 5e6]), np.array([flow]))
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([flow, 5e6], (20000, 1)))
    assert out[:, 0] == pytest.approx(5e6 + drop, rel=1e-9)
    assert out[:, 3] == pytest.approx(-flow, rel=1e-9)


def test_turbulent_drop_is_that_of_blasius():
    """0.3164 Re^-1/4 rho v^2/2 l/d at Re 10000, reached from rest."""
    q = 1e4 * math.pi / 4.0 * 11e-3 * 40e-6
    v = q / (math.pi / 4.0 * 11e-3**2)
    bank, memory = at_rest(PAIR.spec(), 50e-6)
    p = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([q, 0.0], (60000, 1)))[-1, 0]
    assert p == pytest.approx(0.3164 * 1e4**-0.25 * 878.0 * v**2 / 2.0 * PAIR.length / 11e-3, rel=1e-6)


@pytest.mark.parametrize("reynolds", [2300.0, 4000.0])
def test_friction_is_continuous_through_transition(reynolds: float):
    assert turbulence(reynolds * (1.0 + 1e-12)) == pytest.approx(turbulence(reynolds * (1.0 - 1e-12)), rel=1e-10)


@pytest.mark.parametrize("reynolds", [1000.0, -1000.0, 3000.0, 8000.0, -8000.0])
@pytest.mark.parametrize("model", ["lumped", "ends", "nodes"])
def test_slope_is_that_of_the_pressure_drop(reynolds: float, model: str):
    bank = bank_of([PAIR.spec(model)], 50e-6, -1e5)
    q = reynolds * math.pi / 4.0 * 11e-3 * 40e-6
    above, below = (steady_drop(bank, 0, q + d) for d in (1e-5 * q, -1e-5 * q))
    assert steady_slope(bank, 0, q) == pytest.approx((above - below) / (2e-5 * q), rel=1e-6)


def test_ends_are_alike():
    """Driven at the other end, the same answers at the other end, bit by bit."""
    values = np.zeros((2000, 2))
    values[:, 0] = np.random.default_rng(1).normal(size=2000) * 1e-5
    left = run(*at_rest(PAIR.spec(), 50e-6), (HELD_FLOW, HELD_PRESSURE), values)
    right = run(*at_rest(PAIR.spec(), 50e-6), (HELD_PRESSURE, HELD_FLOW), values[:, ::-1].copy())
    assert np.array_equal(left, right[:, [1, 0, 3, 2]])


def test_lines_of_a_bank_do_not_disturb_each_other():
    """Nine lines of all models, in two chunks, beside each alone."""
    models = ["ends"] * 5 + ["nodes", "lumped"] + ["ends"] * 4
    specs = [pipe.spec(m) for pipe, m in zip([*RIG, *RIG, SHORT], models, strict=True)]
    together, memory, n = (bank := bank_of(specs, 50e-6, -1e5)), np.zeros(memory_size(bank)), len(specs)
    settle(together, memory, np.zeros(2 * n), np.zeros(n))
    q = np.random.default_rng(2).normal(size=(300, 2 * n)) * 1e-7
    c, z, pressures = np.zeros(2 * n), np.zeros(2 * n), np.zeros((300, 2 * n))
    for tick in range(300):
        arriving(together, memory, tick, c, z)
        pressures[tick] = c + z * q[tick]
        departing(together, memory, tick, q[tick])
    for i, spec in enumerate(specs):
        alone = run(*at_rest(spec, 50e-6, -1e5), (HELD_FLOW, HELD_FLOW), q[:, 2 * i : 2 * i + 2].copy())
        assert np.array_equal(alone[:, :2], pressures[:, 2 * i : 2 * i + 2])


def test_profile_is_exact_at_the_ends_and_in_steady_flow():
    bank, memory = at_rest(PAIR.spec(), 50e-6)
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([1e-5, 1e5], (777, 1)))[-1]
    shape = np.zeros(3)
    profile(bank, memory, 776, 0, np.array([0.0, 0.5, 1.0]), shape)
    assert shape[[0, 2]] == pytest.approx(out[:2], rel=1e-9)
    drop = steady_drop(bank, 0, 1e-5)
    settle(bank, memory, np.array([1e6 + drop, 1e6]), np.array([1e-5]))
    run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.array([[1e-5, 1e6]]))
    profile(bank, memory, 0, 0, np.array([0.25, 0.5, 1.0]), shape)
    assert shape == pytest.approx([1e6 + 0.75 * drop, 1e6 + 0.5 * drop, 1e6], rel=1e-9)


@pytest.mark.parametrize("step", [50e-6, 100e-6])
@pytest.mark.parametrize("pipe", RIG)
def test_profile_against_the_exact_line(pipe: Pipe, step: float):
    """At 1/4, 1/2, 3/4: rms 0.026 of the Joukowsky pressure. Its friction is shared out in straight lines."""
    bank, memory = at_rest(pipe.spec(), step)
    xi, count = np.array([0.25, 0.5, 0.75]), int(TRAVELS * pipe.travel_time / step)
    c, z, q, shape, found = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(3), np.zeros((3, count))
    for k in range(count):
        arriving(bank, memory, k, c, z)
        q[:] = 1e-7 * min(1.0, (k + 1) * step / RAMP), -c[1] / z[1]
        departing(bank, memory, k, q)
        profile(bank, memory, k, 0, xi, shape)
        found[:, k] = shape / (1e-7 * pipe.impedance)
    for place, p in zip(xi, found, strict=True):
        assert rms(p, ramped(lambda s, x=place: inside(s, pipe, x), step, count)) <= 0.026


def test_profile_without_friction_is_exact():
    """Whole steps: two waves, each where it was; a ramp of 10 steps on a line of 40."""
    pipe = Pipe(2.0, 11e-3, 40e-6, 1000.0)
    bank, memory = at_rest(pipe.spec("ends", "none"), 50e-6)
    values = np.zeros((25, 2))
    values[:, 0] = 1e-5 * np.minimum(1.0, np.arange(1, 26) / 10.0)
    run(bank, memory, (HELD_FLOW, HELD_PRESSURE), values)
    xi, shape = np.linspace(0.0, 1.0, 41), np.zeros(41)
    profile(bank, memory, 24, 0, xi, shape)
    assert shape == pytest.approx(1e-5 * pipe.impedance * np.clip((25 - np.arange(41)) / 10.0, 0.0, 1.0), abs=1e-6)


def test_a_packed_bank_is_the_same_bank():
    """Every field, in its place; in Python, as kernels without numba's memory runtime hand out no arrays."""
    models = ("ends", "volume", "nodes", "lumped", "ends", "volume", "lumped")
    bank = bank_of([RIG[i % 5].spec(model) for i, model in enumerate(models)], 50e-6, -1e5)
    for name, ours, back in zip(Bank._fields, bank, interpreted(unpacked)(*packed(bank)), strict=True):
        assert np.array_equal(ours, back), name
        assert np.shape(ours) == np.shape(back), name


def bounded(pipe: Pipe, steps: int) -> None:
    """Random ends that switch at random, then silence: what was stored dies, nothing grows.

    The bound: a wave of noise s meets ends that reflect at most 1; a passive line cannot hold more than has come in
    over its friction time, here far below 1000 s.
    """
    rng = np.random.default_rng(3)
    bank, memory = at_rest(pipe.spec(), 100e-6)
    scale = 1e-7
    kinds = np.repeat(rng.integers(0, 2, size=(steps // 50 + 1, 2)), 50, axis=0)[:steps].copy()
    values = rng.normal(size=(steps, 2)) * scale * np.where(kinds == HELD_FLOW, 1.0, pipe.impedance)
    out = np.zeros((steps, 4))
    drive(bank, memory, kinds, values, np.zeros(2), out)
    loud = np.abs(out[:, :2]).max() / (scale * pipe.impedance)
    assert loud < 1000.0
    silence = round((3.0 * pipe.viscous_time + 100.0 * pipe.travel_time) / 100e-6)
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.zeros((silence, 2)))
    assert np.abs(out[-10:, 0]).max() / (scale * pipe.impedance) < 1e-6 * loud


@pytest.mark.parametrize("pipe", [RIG[0], RIG[3], SHORT, LONG_LOSSY])
def test_random_switching_ends_stay_bounded(pipe: Pipe):
    bounded(pipe, 100_000)


@pytest.mark.endurance
@pytest.mark.timeout(600)
@pytest.mark.parametrize("pipe", [*RIG, *CORNERS])
def test_random_switching_ends_stay_bounded_for_long(pipe: Pipe):
    bounded(pipe, 1_000_000)


@pytest.mark.parametrize(("friction", "shortest"), [("unsteady", 3.5), ("none", 3.5)])
def test_a_line_too_short_is_refused(friction: str, shortest: float):
    """On both sides of the limit, with the way out."""
    for steps, refused in ((shortest - 0.01, True), (shortest + 0.01, False)):
        spec = Pipe(steps * 50e-6 * HOSE, 11e-3, 40e-6, HOSE).spec("ends", friction)
        if refused:
            with pytest.raises(ValueError, match=r"pipe_1, 0\.1.* m: .* limit 3\.5 .* smaller loop\.step.*lumped"):
                bank_of([spec], 50e-6, -1e5)
        else:
            bank_of([spec], 50e-6, -1e5)
