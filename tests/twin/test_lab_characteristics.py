"""The laboratory of lines, characteristics: exact at Courant 1, what interpolation costs, junctions, cavities."""

import numpy as np
import pytest

from twin.lines.lab.exact import exact_history
from twin.lines.lab.friction import friction
from twin.lines.lab.integrate import PAIRS, march, runge_kutta
from twin.lines.lab.network import Net, characteristics, march_net
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
    ramp,
    reservoir,
)
from twin.lines.lab.rig_line import rig_line
from twin.lines.lab.space import grid
from twin.lines.lab.system import line_system

HAMMER = Case(Pipe(10.0, 0.02, 1000.0, 876.56, 40e-6), End(VELOCITY, constant(0.1)), reservoir(10e5), 0.0, 10e5)
OIL = Pipe(2.0, 0.011, 1137.0, 878.0, 40e-6)


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


@pytest.mark.parametrize(("left", "right", "sign"), [("shut", "held", -1.0), ("held", "shut", 1.0)])
def test_a_sudden_stop_is_joukowskys(left: str, right: str, sign: float):
    """rho a v at once, below at the inlet and above at the outlet, from steady flow with friction."""
    ends = {"shut": closed(), "held": reservoir(20e5)}
    case = Case(OIL, ends[left], ends[right], 2.0, 20e5)
    found = characteristics(case, friction("steady"), 20, OIL.travel_time)
    drop = OIL.steady_rate * OIL.hammer * 2.0 * OIL.travel_time
    stopped = (found.p_1 if left == "shut" else found.p_2)[0]
    before = 20e5 + (drop if left == "shut" else -drop)
    assert stopped - before == pytest.approx(sign * OIL.hammer * 2.0, rel=1e-12)


@pytest.mark.parametrize("courant", [0.0, 1.2])
def test_courant_is_refused(courant: float):
    with pytest.raises(ValueError, match=r"Courant number .* is outside 0 < C <= 1"):
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


def test_elastic_wall():
    """(2.8): the rig's oil, B = 1.170e9 Pa, in steel of 11 x 2 mm has the 1137 m/s that were measured."""
    assert elastic(OIL, 1.16977e9, 2e-3, 2.1e11).speed == pytest.approx(1137.0, abs=0.5)


def test_cavity_as_in_the_rig():
    """A column torn off by a pump at the far end: never below the vapour pressure; the cavity opens and closes."""
    low, vapour = 1e5, -1e5
    sucked = Course((0.0, 1e-3, 20e-3, 21e-3), (0.0, 3.0, 3.0, 0.0))
    case, step = Case(OIL, reservoir(low), End(VELOCITY, sucked), 0.0, low), 2e-5
    fit = friction("fit", viscous_time=OIL.viscous_time, step=step)
    found, without = (rig_line(case, fit, "nodes", step, 80e-3, limit) for limit in (vapour, -1e12))
    assert found.ends.p_2.min() == vapour
    assert without.ends.p_2.min() < 10.0 * vapour
    assert without.vapour.max() == 0.0
    assert found.vapour.max() > 1e-6
    assert found.vapour[found.ends.time > 25e-3].min() == 0.0


DRIVEN = Course((0.0, 1e-3, 2e-3, 4e-3), (0.0, 1.0, 0.3, -0.4))


@pytest.mark.parametrize("right", [PRESSURE, VELOCITY])
@pytest.mark.parametrize("left", [PRESSURE, VELOCITY])
def test_exact_line_between_any_two_ends(left: str, right: str):
    """Both ends driven at once, from rest, against characteristics with the whole convolution: 0.5 % rms."""
    size = {PRESSURE: OIL.hammer, VELOCITY: 1.0}
    ends = [
        End(kind, DRIVEN._replace(values=tuple(sign * size[kind] * v for v in DRIVEN.values)))
        for kind, sign in ((left, 1.0), (right, 0.6))
    ]
    case = Case(OIL, ends[0], ends[1], 0.0, 0.0)
    found = characteristics(case, friction("convolution"), 40, 12e-3)
    exact = exact_history(case, "unsteady", found.time[-1], len(found.time) - 1)
    for mine, right_one, scale in zip(found[1:], exact[1:], (OIL.hammer, OIL.hammer, 1.0, 1.0), strict=True):
        assert np.sqrt(np.mean((mine - right_one) ** 2)) < 5e-3 * scale


def test_rates_are_those_of_the_stages():
    """The first stage of a step is the last of the one before, also for the memories: what `rates` would give."""
    system, start = line_system(HAMMER, grid("fem", 8, 10.0), friction("schohl"))
    march_states = march(system, start, "esdirk3", 1e-3)
    _, first = next(march_states)
    frozen = system.freeze(first.y)
    new, rates, _ = runge_kutta(system, PAIRS["esdirk3"], first, 0.0, 1e-3, frozen)
    again = system.rates(1e-3, new, frozen)
    for by_stage, directly in zip(rates, again, strict=True):
        assert by_stage == pytest.approx(directly, rel=1e-6, abs=1e-7 * np.abs(directly).max())
