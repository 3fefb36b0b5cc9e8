"""The laboratory of lines, characteristics: exact at Courant 1, what interpolation costs, junctions, cutting, energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from twin.lines.lab.characteristics import Net, characteristics, march_net
from twin.lines.lab.exact import exact_history
from twin.lines.lab.friction import NAMES, Friction, friction
from twin.lines.lab.integrate import PAIRS, march, runge_kutta
from twin.lines.lab.pipe import (
    PRESSURE,
    VELOCITY,
    Case,
    Course,
    End,
    Pipe,
    closed,
    constant,
    elastic,
    mirrored,
    ramp,
    reservoir,
)
from twin.lines.lab.rig_line import rig_line
from twin.lines.lab.simulate import SCHEMES, Resolution, simulate
from twin.lines.lab.space import grid
from twin.lines.lab.system import State, line_system

HAMMER = Case(Pipe(10.0, 0.02, 1000.0, 876.56, 40e-6), End(VELOCITY, constant(0.1)), reservoir(10e5), 0.0, 10e5)
OIL = Pipe(2.0, 0.011, 1137.0, 878.0, 40e-6)
FEW = {"cds3": 12, "cds5": 12, "fem": 12, "chebyshev": 8}


def model(name: str, pipe: Pipe, step: float) -> Friction:
    """By name, laminar."""
    return friction(name, 20, pipe.viscous_time, step)


def test_source_case_is_exact_at_courant_one():
    """Fig. 2.23: 10 bar +- rho a v in turn every 2 L/a, and 0.2 m/s, 0 at the other end, to rounding."""
    found = characteristics(HAMMER, friction("none"), 10, 0.06)
    rises = (np.floor(found.time * 50.0 + 1e-9) % 2) == 0
    assert 1e-5 * found.p_1 == pytest.approx(np.where(rises, 10.87656, 9.12344), abs=1e-9)
    later = found.time + 0.01 + 1e-9
    assert found.v_2 == pytest.approx(np.where((np.floor(later * 50.0) % 2) == 1, 0.2, 0.0), abs=1e-12)


def test_interpolation_damps():
    """The same at Courant 0.5: after two periods the peak has lost a tenth, and first order is what is left."""
    off = []
    for cells in (10, 20, 40):
        history = characteristics(HAMMER, friction("none"), cells, 0.04, 0.5)
        off.append(history.p_1[(history.time > 0.021) & (history.time < 0.039)].min() - 9.12344e5)
    assert off[0] > 0.0
    assert history.p_1.max() <= 10.87656e5 + 1e-6
    smooth = Case(OIL, End(VELOCITY, lambda t: np.sin(2000.0 * t) ** 4), reservoir(0.0), 0.0, 0.0)
    right = characteristics(smooth, friction("none"), 320, 4e-3)
    errors = []
    for cells in (80, 160):
        history = characteristics(smooth, friction("none"), cells, 4e-3, 0.5)
        errors.append(np.sqrt(np.mean((history.p_1 - np.interp(history.time, right.time, right.p_1)) ** 2)))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.25)


def test_friction_along_characteristics_is_of_second_order():
    """The trapezoidal rule along them, against the exact line with steady friction, fifty times that of OIL."""
    thick = OIL._replace(viscosity=2e-3)
    case = Case(thick, End(VELOCITY, ramp(0.0, 1.0, 1e-3)), reservoir(0.0), 0.0, 0.0)
    errors = []
    for cells in (10, 20, 40):
        found = characteristics(case, friction("steady"), cells, 12e-3)
        right = exact_history(case, "steady", found.time[-1], len(found.time) - 1)
        errors.append(np.sqrt(np.mean((found.p_1 - right.p_1) ** 2)))
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("courant", [0.0, 1.2])
def test_courant_is_refused(courant: float):
    with pytest.raises(ValueError, match="Courant number .* is outside 0 < C <= 1"):
        characteristics(HAMMER, friction("none"), 10, 0.01, courant)


def test_a_junction_of_three_reflects_and_passes():
    """Wave p_i from line 1: p = 2 Y_1/(Y_1 + Y_2 + Y_3) p_i at the junction, Y = A/(rho a), until echoes come."""
    pipes = tuple(OIL._replace(diameter=d, length=2.0) for d in (0.011, 0.008, 0.016))
    step, cells = OIL.travel_time / 20, (20, 20, 20)
    values = np.zeros((56, 4))
    values[:, 0] = 1e5
    net = Net(pipes, ((0, 1), (1, 2), (1, 3)), (1, 0, 1, 1))
    found = march_net(net, [friction("none")] * 3, step, cells, values, [np.zeros(21)] * 3, [0.0] * 3)
    y = np.array([pipe.area / pipe.hammer for pipe in pipes])
    passed = 2.0 * y[0] / y.sum() * 1e5
    at = found[30]
    assert [at[0, 1], at[1, 0], at[2, 0]] == pytest.approx([passed] * 3, rel=1e-12)
    flows = np.array([at[0, 3], -at[1, 2], -at[2, 2]]) @ np.array([pipe.area for pipe in pipes])
    assert flows == pytest.approx(0.0, abs=1e-18)
    assert found[45, 1, 1] == 0.0  # held


def test_inflow_at_a_junction_divides():
    """(2.101) with Q: p = Q/(Y_1 + Y_2)."""
    values = np.zeros((11, 3))
    values[:, 1] = 1e-4
    net = Net((OIL, OIL._replace(diameter=0.02)), ((0, 1), (1, 2)), (1, 0, 1))
    found = march_net(
        net, [friction("none")] * 2, OIL.travel_time / 20, (20, 20), values, [np.zeros(21)] * 2, [0.0] * 2
    )  # fmt: skip
    y = sum(pipe.area / pipe.hammer for pipe in net.pipes)
    assert found[5, 0, 1] == pytest.approx(1e-4 / y, rel=1e-12)


@pytest.mark.parametrize("name", NAMES)
@given(cut=st.integers(1, 19), speed=st.floats(0.1, 6.0))
def test_a_line_is_the_same_wherever_it_is_cut(name: str, cut: int, speed: float):
    """Two lines and a junction without inflow: same ends. 1e-9: rounding. Brunone's u_x is one-sided at ends: 0.1 %."""
    step = OIL.travel_time / 20
    if name in ("quasi-steady", "brunone"):
        speed *= 4.0  # beyond Re 2300
    f = friction(name, 20, OIL.viscous_time, step, speed * OIL.diameter / OIL.viscosity)
    case = Case(OIL, End(VELOCITY, ramp(0.0, speed, 1e-3)), reservoir(20e5), 0.0, 20e5)
    whole = characteristics(case, f, 20, 80 * step)
    values = np.zeros((81, 3))
    values[:, 0] = [OIL.area * case.left.course(k * step) for k in range(81)]
    values[:, 2] = 20e5
    pipes = tuple(OIL._replace(length=OIL.length * n / 20) for n in (cut, 20 - cut))
    net, rest = Net(pipes, ((0, 1), (1, 2)), (0, 0, 1)), [np.full(cut + 1, 20e5), np.full(21 - cut, 20e5)]
    parts = march_net(net, [f, f], step, (cut, 20 - cut), values, rest, [0.0, 0.0])
    off = np.abs(parts[:, 0, 0] - whole.p_1).max() / (OIL.hammer * speed)
    assert off < (1e-3 if name == "brunone" else 1e-9)


PULSES = st.lists(st.floats(-1.0, 1.0), min_size=12, max_size=12)
KINDS = st.sampled_from([PRESSURE, VELOCITY])


def excited(pipe: Pipe, kinds: tuple[str, str], pulses: tuple[list[float], list[float]], spacing: float) -> Case:
    """Ends that do what they like for a while, from rest, and rest again."""
    ends = []
    for kind, values in zip(kinds, pulses, strict=True):
        size = 0.02 * (pipe.hammer if kind == PRESSURE else 1.0)
        times = tuple(spacing * k for k in range(len(values) + 2))
        ends.append(End(kind, Course(times, (0.0, *(size * v for v in values), 0.0))))
    return Case(pipe, ends[0], ends[1], 0.0, 0.0)


@pytest.mark.parametrize("name", ["none", "steady", "quasi-steady", "kagawa", "trikha", "fit", "zielke", "convolution"])
@given(left=PULSES, right=PULSES, kinds=st.tuples(KINDS, KINDS), viscous=st.floats(1e-5, 2e-3))
def test_characteristics_never_give_energy(name: str, left: list, right: list, kinds: tuple, viscous: float):
    """From rest, sum (p_1 v_1 - p_2 v_2) >= 0 at every instant, whatever the ends do."""
    pipe = OIL._replace(viscosity=viscous)
    step = pipe.travel_time / 8
    case = excited(pipe, kinds, (left, right), step)
    found = characteristics(case, model(name, pipe, step), 8, 60 * step)
    work = np.cumsum(found.p_1 * found.v_1 - found.p_2 * found.v_2)
    assert work.min() >= -1e-9 * max(1.0, np.abs(found.p_1 * found.v_1).sum())


@pytest.mark.parametrize("kind", ["ends", "nodes", "lumped"])
@given(left=PULSES, right=PULSES, kinds=st.tuples(KINDS, KINDS))
def test_lines_of_the_rig_never_give_energy(kind: str, left: list, right: list, kinds: tuple):
    """The same of the real-time lines. In `lumped` what enters in a step is (p + p_before)/2 q, so it is left alone."""
    step = 1e-4
    case = excited(OIL, kinds, (left, right), 3 * step)
    found = rig_line(case, model("fit", OIL, step), kind, step, 100 * step).ends
    p = [found.p_1, found.p_2]
    if kind == "lumped":
        q = [found.v_1, -found.v_2]
        means = [0.5 * (x + np.append(0.0, x[:-1])) for x in (*p, *q)]
        work = means[0] * means[2] + means[1] * means[3]
    else:
        work = p[0] * found.v_1 - p[1] * found.v_2
    assert np.cumsum(work).min() >= -1e-9 * max(1.0, np.abs(work).sum())


@pytest.mark.parametrize("time", ["backward-euler", "bdf2", *PAIRS])
@pytest.mark.parametrize("space", ["cds3", "cds5", "fem"])
@given(
    seed=st.integers(0, 2**31), ends=st.sampled_from([(closed, closed), (closed, None), (None, None)]),
    name=st.sampled_from(["none", "steady", "kagawa"]), courant=st.floats(0.05, 20.0),
)  # fmt: skip
def test_the_method_of_lines_never_makes_energy(space: str, time: str, seed: int, ends: tuple, name: str, courant: float):
    """Any start between passive ends: the energy in oil and memories falls (BDF2: (|y|^2 + |2 y - y_before|^2)/4)."""
    left, right = (end() if end else reservoir(0.0) for end in ends)
    system, start = line_system(Case(OIL, left, right, 0.0, 0.0), grid(space, 10, OIL.length), friction(name))
    random = np.random.default_rng(seed)
    y = random.standard_normal(22)
    y[system.rows] = 0.0
    step, energies, before = courant * OIL.travel_time / 10, [], None
    for (_, state), _ in zip(march(system, State(y, random.standard_normal(start.w.shape)), time, step), range(12)):
        if time == "bdf2" and before is not None:
            ahead = State(2.0 * state.y - before.y, 2.0 * state.w - before.w)
            energies.append(0.5 * (system.energy(state) + system.energy(ahead)))
        elif time != "bdf2":
            energies.append(system.energy(state))
        before = state
    assert np.all(np.diff(energies) <= 1e-10 * energies[0])


@pytest.mark.parametrize("scheme", SCHEMES)
@given(closure=st.floats(2e-4, 3e-3), speed=st.floats(-1.0, 1.0), name=st.sampled_from(["none", "steady", "fit"]))
def test_ends_are_alike(scheme: str, closure: float, speed: float, name: str):
    """The mirrored case gives the mirrored answer: to rounding, which is 1e-7 of rho a v in the worst of them."""
    case = Case(OIL, End(VELOCITY, ramp(speed, 0.0, closure)), reservoir(20e5), speed, 20e5)
    space = scheme.split("/")[0]
    fine = Resolution(cells=FEW.get(space, 12), step=1e-4 if space in ("ends", "nodes", "lumped") else 0.0)
    one, other = (simulate(c, scheme, name, 4e-3, fine) for c in (case, mirrored(case)))
    scale = OIL.hammer * max(abs(speed), 1e-3)
    assert other.p_2 == pytest.approx(one.p_1, abs=1e-7 * scale + 1e-6)
    assert -other.v_1 * OIL.hammer == pytest.approx(one.v_2 * OIL.hammer, abs=1e-7 * scale + 1e-6)


def test_a_line_without_an_answer_to_mirror():
    with pytest.raises(ValueError, match="exactly one end that holds pressure"):
        mirrored(Case(OIL, reservoir(1e5), reservoir(0.0), 0.0, 0.0))


def test_elastic_wall():
    """(2.8): the rig's oil, B = 1.170e9 Pa, in steel of 11 x 2 mm has the 1137 m/s that were measured."""
    assert elastic(OIL, 1.16977e9, 2e-3, 2.1e11).speed == pytest.approx(1137.0, abs=0.5)


def test_cavity_as_in_the_rig():
    """A column torn off at the valve: never below the vapour pressure, V_max by rigid column v^2 L rho/(2 dp)."""
    low, vapour = 1e5, -1e5
    case = Case(OIL, reservoir(low), End(VELOCITY, ramp(0.0, 0.0, 0.0)), 0.0, low)
    pulled = case._replace(right=End(VELOCITY, Course((0.0, 1e-3, 20e-3, 21e-3), (0.0, 3.0, 3.0, 0.0))))
    found = rig_line(pulled, friction("none"), "nodes", 2e-5, 60e-3, vapour)
    assert found.ends.p_2.min() == vapour
    assert found.vapour.max() > 0.0
    assert found.vapour[-1] < found.vapour.max()
    without = rig_line(pulled, friction("none"), "nodes", 2e-5, 60e-3)
    assert without.ends.p_2.min() < vapour
    assert without.vapour.max() == 0.0


def test_stages_reach_the_end_of_the_step():
    """The last stage is the step: b is the last row of a, so the state is that of `march`."""
    system, start = line_system(HAMMER, grid("fem", 8, 10.0), friction("none"))
    march_states = march(system, start, "esdirk3", 1e-3)
    _, first = next(march_states)
    _, second = next(march_states)
    frozen = system.freeze(first.y)
    assert runge_kutta(system, PAIRS["esdirk3"], first, 0.0, 1e-3, frozen)[0].y == pytest.approx(second.y, rel=1e-12)
