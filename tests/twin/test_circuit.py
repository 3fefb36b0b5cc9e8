"""The whole circuit against the facts of the rig: speeds, pressures, rest, sinking, ringing."""

import math

import numpy as np
import pytest
from scipy.optimize import root_scalar

from tests.support.plant import (
    BAR,
    FRICTIONLESS,
    SMOOTH,
    TIGHT,
    circuit,
    cylinder_of,
    pump_of,
    run,
    states,
)
from twin.actuator import chamber_cavities, chamber_volumes
from twin.circuit.equilibrium import equilibrium, state_at
from twin.circuit.linear import moving_point
from twin.circuit.state import (
    State,
    flatten,
    flows,
    pressures,
)
from twin.circuit.step import Circuit, Piston, Spool
from twin.pump import pump_flow


def rising(c: Circuit) -> State:
    """0.5 s after the valve was thrown open: the relief valve is shut, pressures have settled."""
    return run(equilibrium(c, 0.01), 1.0, c, 0.5)


@pytest.mark.parametrize("mass", [120.0, 302.0])
@pytest.mark.parametrize("leak", [1.04e12, math.inf])
def test_piston_rises_with_the_oil_of_the_pump(mass: float, leak: float):
    """(Q_pump(p) - leak)/A_l, within 0.1 %: 5 bar of line loss compress 0.04 %, the rest is ringing."""
    c = circuit(pump=SMOOTH, seal=FRICTIONLESS, cylinder={"leakage_resistance": leak}, load={"mass": mass})
    end = rising(c)
    p = pressures(end)
    oil = pump_flow(p.pump, 1.0, pump_of(c)) - (p.lower - p.upper) / leak
    assert end.core.relief.flow == 0.0
    assert end.piston.velocity == pytest.approx(oil / c.parts.cylinder.area_lower, rel=1e-3)


def test_piston_rises_at_0_384_m_per_s_when_p1_is_35_bar():
    """26.7 l/min over the annulus, pi/4 (50^2 - 32^2) mm^2."""

    def loaded(force: float) -> Circuit:
        return circuit(pump=SMOOTH, seal=FRICTIONLESS, cylinder=TIGHT, load={"force": force})

    def p1(force: float) -> float:
        c = loaded(force)
        return pressures(moving_point(c, 0.135, 1.0)).tee

    c = loaded(root_scalar(lambda force: p1(force) - 35 * BAR, bracket=(-1e3, 4e3), xtol=1e-3).root)
    end = rising(c)
    assert pressures(end).tee / BAR == pytest.approx(35.0, abs=0.1)
    assert end.piston.velocity == pytest.approx(0.384, abs=1e-3)


@pytest.mark.parametrize("mass", [120.0, 302.0])
def test_force_balance_of_steady_motion(mass: float):
    """p_l A_l - p_u A_u = m g without friction, within 0.01 bar of the annulus."""
    c = circuit(pump=SMOOTH, seal=FRICTIONLESS, load={"mass": mass})
    p, cylinder = pressures(run(moving_point(c, 0.05, 1.0), 1.0, c, 0.4)), c.parts.cylinder
    force = p.lower * cylinder.area_lower - p.upper * cylinder.area_upper
    assert force == pytest.approx(mass * 9.81, abs=0.01 * BAR * cylinder.area_lower)
    assert p.upper > 5 * BAR


@pytest.mark.parametrize("limit", [0.0, 0.25])
def test_a_tight_cylinder_does_not_creep_in_ten_minutes(limit: float):
    c = circuit(200e-6, cylinder=TIGHT, seal={"limit": limit})
    start = equilibrium(c, 0.1)
    assert run(start, 0.0, c, 600.0).piston.position == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize(("mass", "mm_per_s"), [(120.0, 0.785), (302.0, 2.06)])
def test_a_leaking_cylinder_sinks_at_the_rate_of_the_leak(mass: float, mm_per_s: float):
    """(p_l - p_u)/(R_h A_l), p_u = -1 bar under its cavity, down to the stop, which holds it.

    The leak counts oil at reference density: 1 + p_l/B, 0.2 %.
    """
    c = circuit(seal=FRICTIONLESS, load={"mass": mass})
    start = run(equilibrium(c, 0.02), 0.0, c, 2.0)
    end = run(start, 0.0, c, 4.0)
    p, cylinder = pressures(end), cylinder_of(c)
    speed = (p.lower - p.upper) * cylinder.leakage / cylinder.area_lower
    speed /= 1.0 + p.lower / cylinder.bulk_modulus
    assert p.upper == -1 * BAR
    assert chamber_cavities(end.core.chambers, end.piston.position, cylinder).upper > 0.0
    assert (start.piston.position - end.piston.position) / 4.0 == pytest.approx(speed, rel=1e-3)
    assert speed * 1e3 == pytest.approx(mm_per_s, rel=3e-3)
    landed = run(end, 0.0, c, 25.0)
    assert landed.piston == (0.0, 0.0)


@pytest.mark.parametrize("mass", [120.0, 210.0, 302.0])
def test_shut_valve_rings_at_the_oil_spring_frequency(mass: float):
    """Trapped oil is a spring, m omega^2 = sum A^2/C with C = V/B and the line's oil; hoses short, so without inertia.

    A quarter period after a push of 1 mm/s the piston turns: steepest there, sees 0.1 % in omega. Each spring is
    stiffer by 1 + p/B, below 0.25 %.
    """
    short = {"length": 0.02, "model": "lumped"}
    c = circuit(2e-6, seal=FRICTIONLESS, cylinder=TIGHT, load={"mass": mass}, pipe_3=short, pipe_4=short)
    start, cylinder = equilibrium(c, 0.135), cylinder_of(c)
    p, volumes = pressures(start), chamber_volumes(0.135, cylinder)
    stiffness = sum(
        area**2 * (1.0 + at / cylinder.bulk_modulus) / (volume / cylinder.bulk_modulus + c.lines.capacity[line])
        for area, at, volume, line in (
            (cylinder.area_lower, p.lower, volumes[0], 2),
            (cylinder.area_upper, p.upper, volumes[1], 3),
        )
    )
    pushed = start.with_core(piston=Piston(0.135, 1e-3))
    quarter = run(pushed, 0.0, c, math.pi / 2.0 / math.sqrt(stiffness / mass))
    assert quarter.piston.velocity == pytest.approx(0.0, abs=3e-6)  # two steps and 0.1 %


def test_friction_ends_the_ringing_at_a_true_rest():
    """Stopped from full speed: within a second the speed is exactly zero and stays so."""
    c = circuit(cylinder=TIGHT)
    stopped = run(rising(c), 0.0, c, 2.0)
    assert stopped.piston.velocity == 0.0
    assert run(stopped, 0.0, c, 5.0).piston == stopped.piston


@pytest.mark.parametrize("share", [0.95, -0.95, 1.05, -1.05])
def test_the_seal_holds_a_quarter_of_the_pressure_across_the_piston(share: float):
    """0.25 |p_l - p_u| b pi (D + d), 10 bar above and p_l for a share of it: at rest below, off beyond."""
    c = circuit(cylinder=TIGHT)
    start, cylinder, p_upper = equilibrium(c, 0.135), c.parts.cylinder, 10 * BAR
    hold = share * 0.25 * 0.01 * math.pi * 0.082  # [m^2]
    p_lower = (120.0 * 9.81 + (cylinder.area_upper - hold) * p_upper) / (cylinder.area_lower - hold)
    p = pressures(start)._replace(a=p_lower, lower=p_lower, b=p_upper, upper=p_upper)
    loaded = state_at(p, flows(start), Piston(0.135, 0.0), Spool(0.0, 0.0), c)
    velocity = run(loaded, 0.0, c, c.parts.step).piston.velocity
    assert velocity * share > 0.0 if abs(share) > 1.0 else velocity == 0.0


def test_the_top_stop_holds_and_the_relief_valve_takes_the_pump():
    """Impingement: the piston runs into the top, p1 settles where the relief valve passes what the pump gives."""
    c = circuit(pump=SMOOTH)
    end = run(equilibrium(c, 0.2), 1.0, c, 3.0)
    p = pressures(end)
    assert end.piston == (c.parts.cylinder.stroke, 0.0)
    assert p.tee == pytest.approx(pressures(equilibrium(c, 0.1)).tee, abs=0.05 * BAR)
    assert p.lower == pytest.approx(p.tee, abs=0.05 * BAR)


def test_positive_spool_lifts_and_negative_lowers():
    c = circuit()
    assert run(equilibrium(c, 0.1), 0.5, c, 0.3).piston.position > 0.12
    assert run(equilibrium(c, 0.1), -0.5, c, 0.3).piston.position < 0.08


def test_inside_the_overlap_nothing_passes_the_lands():
    """Full pump pressure at P: chamber and line together keep their oil to rounding, the return line stands still."""
    c = circuit(cylinder=TIGHT)
    start = equilibrium(c, 0.1)
    end = run(start, 0.05, c, 0.5)  # a step to 0.05 does not overshoot to the overlap, 0.1
    kept = end.core.chambers.lower + end.ends.oil[2]
    assert kept == pytest.approx(start.core.chambers.lower + start.ends.oil[2], rel=1e-13)
    assert end.ends.oil[4] == start.ends.oil[4]


def test_a_run_can_be_cut_anywhere():
    """1000 steps are 10 times 100 steps, to the last bit."""
    c = circuit()
    start = equilibrium(c, 0.1)
    *_, last = states(start, 0.6, c, 0.05, every=100)
    assert np.array_equal(flatten(last), flatten(run(start, 0.6, c, 0.05)))


def test_full_speed_down_starves_the_upper_chamber_at_the_vapour_pressure():
    """The pump cannot fill the cap side: p_u stays at -1 bar over a cavity that grows while it runs down."""
    c = circuit(load={"mass": 302.0})
    seen = list(states(equilibrium(c, 0.25), -1.0, c, 0.5, every=20))
    assert min(pressures(s).upper for s in seen) == -1 * BAR
    cylinder = c.parts.cylinder
    assert max(chamber_cavities(s.core.chambers, s.piston.position, cylinder).upper for s in seen) > 1e-6
