"""Oil without inertia: one volume, its oil and energy to the last bit, order 2, any step; and a wall that creeps."""

import cmath
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.exact_line import HELD_FLOW, HELD_PRESSURE, SOURCE, Array, at_rest, run
from twin.integration import integrate
from twin.lines.bank import bank_of, memory_size, profile, settle, steady_drop
from twin.lines.spec import Creep, LineSpec
from twin.lines.volume import CALM

STEP = 50e-6
CREEP = (Creep(0.4, 2e-3), Creep(0.25, 30e-3))


def spec(model: str = "volume", creep: tuple[Creep, ...] = (), length: float = 0.21) -> LineSpec:
    """20 cm^3 of oil in a pipe of 11 mm."""
    return LineSpec(length, 11e-3, 1.17e9, 878.0, 40e-6, model, "unsteady", creep)


def noise(count: int) -> Array:
    return np.random.default_rng(3).standard_normal((count, 2)) * 1e-4


@pytest.mark.parametrize("step", [1e-6, 50e-6, 1e-3, 1.0])
def test_oil_is_that_of_the_mean_pressure_to_the_last_bit(step: float):
    """C P = h sum(q_1 + q_2) at every step; the mean of the ends is that halfway, and e/2 of what the step changes."""
    bank, memory = at_rest(spec(), step)
    q = noise(300)
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), q)
    stored = np.append(0.0, np.cumsum(step / bank.capacity[0] * q.sum(axis=1)))
    rise = np.diff(stored, prepend=0.0)
    expected = 0.5 * (stored[1:] + stored[:-1]) + 0.5 * CALM * np.diff(rise)
    assert 0.5 * (out[:, 0] + out[:, 1]) == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(stored).max())
    assert memory[bank.volume_place[0]] == pytest.approx(stored[-1], rel=1e-12)


@pytest.mark.parametrize("creep", [(), CREEP[:1], CREEP])
@pytest.mark.parametrize("step", [1e-6, 50e-6, 1e-3])
def test_what_goes_in_is_stored_or_heat(step: float, creep: tuple[Creep, ...]):
    """h sum p q = C P^2/2 + h Z_e f^2/4 + h e Z g^2/4 + sum C_k e_k^2/2 + heat, and no step has negative heat: of any
    size passive."""
    bank, memory = at_rest(spec(creep=creep), step)
    c, z = float(bank.capacity[0]), step / float(bank.capacity[0])
    m = memory[bank.volume_place[0] :]

    def stored() -> float:
        late = [0.25 * c * w.share * (m[5 + k] ** 2 + m[7 + k] ** 2) for k, w in enumerate(creep)]
        moving = (1.0 + CALM) * (m[1] - m[2]) ** 2 + CALM * (m[1] + m[2]) ** 2
        return 0.5 * c * m[0] ** 2 + 0.25 * step * z * moving + sum(late)

    for flows in noise(200):
        before = stored()
        p = run(bank, memory, (HELD_FLOW, HELD_FLOW), flows.reshape(1, 2))[0, :2]
        put = step * float(p @ flows)
        assert put - (stored() - before) >= -1e-12 * (abs(put) + before)


def test_the_difference_of_the_ends_is_an_inertance_beside_a_resistance():
    """q_1 = -q_2 = sin: p_1 - p_2 = 2 Z_e (1 - 1/z) q, at any frequency; nothing steady, 4 Z_e at Nyquist."""
    bank, memory = at_rest(spec(), STEP)
    z, theta = (1.0 + CALM) * STEP / bank.capacity[0], 0.3
    q = 1e-4 * np.sin(theta * np.arange(1, 401))
    out = run(bank, memory, (HELD_FLOW, HELD_FLOW), np.column_stack([q, -q]))
    answer = 2.0 * z * (1.0 - cmath.exp(-1j * theta)) * 1e-4
    expected = (answer * np.exp(1j * theta * np.arange(1, 401))).imag
    assert (out[5:, 0] - out[5:, 1]) == pytest.approx(expected[5:], abs=1e-9 * abs(answer))
    inertance, resistance = bank.inertance[0], 4.0 * z
    s = 1j * 0.01 / STEP
    model = 1.0 / (1.0 / (s * inertance) + 1.0 / resistance)
    assert 2.0 * z * (1.0 - cmath.exp(-s * STEP)) == pytest.approx(model, rel=2e-5)


def test_nothing_swings_from_step_to_step():
    """Held pressures at both ends, suddenly apart: the flow between them grows like that of the inertance and does not
    alternate; |S-| = 1/3 at Nyquist leaves a third per step."""
    bank, memory = at_rest(spec(), STEP)
    out = run(bank, memory, (HELD_PRESSURE, HELD_PRESSURE), np.tile([1e5, -1e5], (100, 1)))
    through = out[:, 2] - out[:, 3]
    assert np.diff(through) == pytest.approx(2e5 * 2.0 * STEP / bank.inertance[0], rel=1e-9)


def test_flows_do_not_swing_where_both_ends_are_held():
    """Both ends at a pressure at once, as between two cavities: what must flow has flowed after 20 steps, to 1e-6."""
    bank, memory = at_rest(spec(), STEP)
    out = run(bank, memory, (HELD_PRESSURE, HELD_PRESSURE), np.full((40, 2), -1e5))
    flow = 1e5 * bank.capacity[0] / STEP
    assert STEP * out[:, 2:].sum() == pytest.approx(-1e5 * bank.capacity[0], rel=1e-6)
    assert np.abs(out[20:, 2:]).max() < 1e-6 * flow


def rates_of(bank, creep: tuple[Creep, ...], flow, load: float):
    """One volume that a flow fills and a resistance empties, with a wall of its own states: stated apart."""
    c = float(bank.capacity[0])

    def rates(t: float, y: NDArray[np.floating]) -> list[float]:
        p, late = y[0], [(y[0] - e) / w.time for e, w in zip(y[1:], creep, strict=True)]
        taken = sum(c * w.share * rate for w, rate in zip(creep, late, strict=True))
        return [(flow(t) - p / load - taken) / c, *late]

    return rates


@pytest.mark.parametrize(("model", "creep"), [("volume", ()), ("volume", CREEP)])
def test_order_is_two_towards_one_volume(model: str, creep: tuple[Creep, ...]):
    """In at one end, out of the other through 2e10 Pa s/m^3 (the volume may have no steady drop), against scipy. The
    error is that of the inertance, 2.5 h^2/C dq/dt, dq/dt up to 0.03 m^3/s^2."""
    load = 2e10

    def flow(t: float) -> float:
        return 1e-4 * math.sin(300.0 * t) ** 2

    def miss(step: float) -> float:
        bank, memory = at_rest(spec(model, creep), step)
        times = step * np.arange(1, round(0.02 / step) + 1)
        kinds, values = (HELD_FLOW, SOURCE), np.column_stack([[flow(t) for t in times], np.zeros(len(times))])
        out = run(bank, memory, kinds, values, (0.0, load))
        solution = integrate(
            rates_of(bank, creep, flow, load), (0.0, 0.02), [0.0] * (1 + len(creep)), "DOP853",
            most=200_000, rtol=1e-11, atol=1e-6, t_eval=times,
        )  # fmt: skip
        return float(np.abs(out[:, :2] - solution.y[0][:, None]).max())

    errors = [miss(step) for step in (100e-6, 50e-6, 25e-6)]
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)
    assert errors[1] < 1.1 * bank_of([spec()], 50e-6, -1e5).inertance[0] * 0.03


@pytest.mark.parametrize("model", ["volume", "lumped"])
def test_a_settled_wall_holds_its_share_and_gives_it_back(model: str):
    """Filled under 10 bar for 20 times of retardation: C (1 + w_1 + w_2) p of oil, which then comes out again."""
    bank, memory = at_rest(spec(model, CREEP, length=2.1), STEP)
    assert bank.settled_capacity[0] == pytest.approx(1.65 * bank.capacity[0], rel=1e-12)
    count = round(20.0 * CREEP[1].time / STEP)
    for pressure in (1e6, 0.0):
        out = run(bank, memory, (SOURCE, SOURCE), np.full((count, 2), pressure), (1e9, 1e9))
        oil = STEP * out[:, 2:].sum() * (1.0 if pressure else -1.0)
        assert oil == pytest.approx(1e6 * bank.settled_capacity[0], rel=1e-6)


@pytest.mark.parametrize("model", ["volume", "lumped"])
def test_a_creeping_wall_answers_as_its_complex_compliance(model: str):
    """Both ends alike, a sine of 60 Hz: q/p = i w C (1 + sum w_k/(1 + i w tau_k)), of the trapezoidal rule's frequency
    tan(w h/2) 2/h. Both ends alike leave a line's inertia at rest; 2e-4: (w h)^2 e/2 of that of a volume's scheme."""
    bank, memory = at_rest(spec(model, CREEP, length=2.1), STEP)
    omega = 2.0 * math.pi * 60.0
    count = round(0.4 / STEP)
    phase = omega * STEP * np.arange(1, count + 1)
    out = run(bank, memory, (HELD_PRESSURE, HELD_PRESSURE), np.tile(1e5 * np.sin(phase), (2, 1)).T)
    s = 2j / STEP * math.tan(0.5 * omega * STEP)
    expected = s * bank.capacity[0] * (1.0 + sum(w.share / (1.0 + s * w.time) for w in CREEP)) * 1e5
    last = round(0.1 / STEP)  # six periods
    found = 2.0 / last * complex(np.sum(out[-last:, 2:].sum(axis=1) * np.exp(-1j * phase[-last:]))) * 1j
    assert found == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize(("model", "creep"), [("volume", ()), ("volume", CREEP), ("lumped", CREEP)])
def test_steady_start_stays_steady(model: str, creep: tuple[Creep, ...]):
    bank, q = bank_of([spec(model, creep, 2.1)], STEP, -1e5), 3e-4
    memory, drop = np.zeros(memory_size(bank)), steady_drop(bank, 0, q)
    assert (drop > 0.0) == (model == "lumped")
    settle(bank, memory, np.array([5e6 + drop, 5e6]), np.array([q]))
    out = run(bank, memory, (HELD_FLOW, HELD_PRESSURE), np.tile([q, 5e6], (2000, 1)))
    assert out[:, 0] == pytest.approx(5e6 + drop, rel=1e-9)
    assert out[:, 3] == pytest.approx(-q, rel=1e-9)
    shape = np.zeros(3)
    profile(bank, memory, 1999, 0, np.array([0.0, 0.5, 1.0]), shape)
    assert shape == pytest.approx([5e6 + drop, 5e6 + 0.5 * drop, 5e6], rel=1e-9)


@pytest.mark.parametrize(("model", "creep", "way"), [
    ("nodes", CREEP, r"pipe_1: 2 elements of creep, limit 0 in model nodes; take model ends, lumped or volume"),
    ("volume", (*CREEP, *CREEP), r"pipe_1: 4 elements of creep, limit 2 in model volume; take fewer"),
])  # fmt: skip
def test_what_a_model_does_not_know_is_refused(model: str, creep: tuple[Creep, ...], way: str):
    with pytest.raises(ValueError, match=way):
        bank_of([spec(model, creep, 2.1)], STEP, -1e5)
