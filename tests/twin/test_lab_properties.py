"""Properties of every line of the laboratory: no energy out of nothing, ends alike, the same wherever it is cut."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from twin.lines.lab.friction import NAMES, Friction, friction
from twin.lines.lab.integrate import PAIRS, march
from twin.lines.lab.network import Net, characteristics, march_net
from twin.lines.lab.pipe import (
    PRESSURE,
    VELOCITY,
    Case,
    Course,
    End,
    Pipe,
    closed,
    mirrored,
    ramp,
    reservoir,
)
from twin.lines.lab.rig_line import rig_line
from twin.lines.lab.simulate import SCHEMES, Resolution, simulate
from twin.lines.lab.space import grid
from twin.lines.lab.system import State, line_system

OIL = Pipe(2.0, 0.011, 1137.0, 878.0, 40e-6)
FEW = {"cds3": 12, "cds5": 12, "fem": 12, "chebyshev": 8}


def model(name: str, pipe: Pipe, step: float) -> Friction:
    """By name, laminar."""
    return friction(name, 20, pipe.viscous_time, step)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=4)
@given(cut=st.integers(1, 19), speed=st.floats(0.1, 6.0))
def test_a_line_is_the_same_wherever_it_is_cut(name: str, cut: int, speed: float):
    """Two lines and a junction without inflow: same ends. 1e-9: rounding. Brunone's u_x is one-sided at ends: 1 %."""
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
    assert off < (0.02 if name == "brunone" else 1e-9)


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
@settings(max_examples=12)
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
@settings(max_examples=12)
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
@settings(max_examples=5)
@given(
    seed=st.integers(0, 2**31), ends=st.sampled_from([(closed, closed), (closed, None), (None, None)]),
    name=st.sampled_from(["none", "steady", "kagawa"]), courant=st.floats(0.05, 20.0),
)  # fmt: skip
def test_the_method_of_lines_never_makes_energy(
    space: str, time: str, seed: int, ends: tuple, name: str, courant: float
):
    """Any start between passive ends: the energy in oil and memories falls (BDF2: (|y|^2 + |2 y - y_before|^2)/4)."""
    left, right = (end() if end else reservoir(0.0) for end in ends)
    system, start = line_system(Case(OIL, left, right, 0.0, 0.0), grid(space, 10, OIL.length), friction(name))
    random = np.random.default_rng(seed)
    y = random.standard_normal(22)
    y[system.rows] = 0.0
    step, energies, before = courant * OIL.travel_time / 10, [], None
    for (_, state), _ in zip(
        march(system, State(y, random.standard_normal(start.w.shape)), time, step), range(12), strict=False
    ):
        if time == "bdf2" and before is not None:
            ahead = State(2.0 * state.y - before.y, 2.0 * state.w - before.w)
            energies.append(0.5 * (system.energy(state) + system.energy(ahead)))
        elif time != "bdf2":
            energies.append(system.energy(state))
        before = state
    assert np.all(np.diff(energies) <= 1e-10 * energies[0])


@pytest.mark.parametrize("scheme", SCHEMES)
@settings(max_examples=2)
@given(closure=st.floats(2e-4, 3e-3), speed=st.floats(-1.0, 1.0), name=st.sampled_from(["none", "steady", "fit"]))
def test_ends_are_alike(scheme: str, closure: float, speed: float, name: str):
    """The mirrored case gives the mirrored answer: to rounding, 1e-3 Pa of 20 bar."""
    case = Case(OIL, End(VELOCITY, ramp(speed, 0.0, closure)), reservoir(20e5), speed, 20e5)
    space = scheme.split("/")[0]
    fine = Resolution(cells=FEW.get(space, 12), step=1e-4 if space in ("ends", "nodes", "lumped") else 0.0)
    one, other = (simulate(c, scheme, name, 2.5e-3, fine) for c in (case, mirrored(case)))
    scale = OIL.hammer * max(abs(speed), 1e-3)
    assert other.p_2 == pytest.approx(one.p_1, abs=1e-7 * scale + 1e-3)
    assert -other.v_1 * OIL.hammer == pytest.approx(one.v_2 * OIL.hammer, abs=1e-7 * scale + 1e-3)


def test_a_line_without_an_answer_to_mirror():
    with pytest.raises(ValueError, match="exactly one end that holds pressure"):
        mirrored(Case(OIL, reservoir(1e5), reservoir(0.0), 0.0, 0.0))
