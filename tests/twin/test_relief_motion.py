"""Numerics of the relief valve: network, contacts, order, stability, energy, and any input at all."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.relief_valve import (
    BAR,
    FLOW,
    IMPEDANCE,
    LITRE_PER_MINUTE,
    PRESSURE,
    bracketed,
    follow,
    run,
    steadily,
    valve,
)
from twin.contact import Stops
from twin.relief.main_stage import main_opening, spool_drag, spool_spring
from twin.relief.motion import FINEST, predict_lift
from twin.relief.network import drop, pilot_node
from twin.relief.poppet import pilot_opening, spring_force
from twin.relief.steady import precompression_for, rest, steady_pressure
from twin.relief.valve import SHUT, Relief, ReliefState

VALVE = valve()
LINE = PRESSURE + IMPEDANCE * FLOW
P = 5
POWER = st.floats(-1.0, 1.0)
IMPEDANCES = st.one_of(st.just(0.0), st.floats(7.0, 11.0).map(lambda x: 10.0**x))


def varied(powers: list[float]) -> Relief:
    """The rig's valve with some sizes multiplied by up to 2 or 1/2."""
    names = ("pilot_precompression", "nozzle_diameter", "orifice_diameter", "spool_precompression", "pilot_mass")
    base = (0.18e-3, 0.8e-3, 0.6e-3, 5e-3, 10.6e-3)
    return valve(**{n: b * 2.0**e for n, b, e in zip(names, base, powers, strict=True)})


def network(s: ReliefState, c: float, z: float, v: Relief, swept: float | None = None) -> tuple[float, float, float]:
    """(Q, p, p2) of a state by brackets alone; swept: the speed at which the poppet sweeps oil, if not its own."""
    o, conductance = v.orifices, pilot_opening(s.pilot_lift, v.pilot)[0]
    k = main_opening(s.spool_lift, v.main).conductance
    speed = s.pilot_velocity if swept is None else swept
    pushed = v.main.area * s.spool_velocity - v.pilot.area * speed

    def total(p: float) -> float:
        y = bracketed(lambda y: y * abs(y) + drop(conductance * y - pushed, o.a_12, o.b_12) - p, -1e6, 1e6)
        return k * math.copysign(math.sqrt(abs(p)), p) + conductance * y + v.pilot.area * speed

    p = c if z == 0.0 else bracketed(lambda p: p + z * total(p) - c, -1e9, 1e9)
    y = pilot_node(p, pushed, conductance, o)
    return total(p), p, y * abs(y)


def rates(state: np.ndarray, c: float, z: float, v: Relief) -> np.ndarray:
    """The open valve as an ordinary differential equation: the two equations of motion."""
    s = ReliefState(*state)
    _, p, p2 = network(s, c, z, v)
    p3 = p2 + drop(v.main.area * s.spool_velocity, v.orifices.a_3, v.orifices.b_3)
    pilot = (
        pilot_opening(s.pilot_lift, v.pilot)[1] * p2
        - spring_force(s.pilot_lift, v.pilot)
        - v.pilot.drag * s.pilot_velocity
    )
    spool = main_opening(s.spool_lift, v.main).area * p - v.main.area * p3 - spool_spring(s.spool_lift, v.main)
    spool -= spool_drag(math.sqrt(p), v.main) * s.spool_velocity
    return np.array([s.pilot_velocity, pilot / v.pilot.mass, s.spool_velocity, spool / v.main.mass])


def eigenvalue(pressure: float, v: Relief) -> complex:
    """Of the pilot's swing about the steady state, by differences."""
    at, width = np.array(rest(pressure, v)), np.array([1e-10, 1e-6, 1e-9, 1e-6])
    sides = [
        [rates(at + sign * np.eye(4)[j] * width, LINE - PRESSURE + pressure, IMPEDANCE, v) for sign in (1, -1)]
        for j in range(4)
    ]
    columns = [(up - down) / (2 * w) for (up, down), w in zip(sides, width, strict=True)]
    return max(np.linalg.eigvals(np.column_stack(columns)), key=lambda x: x.imag)


@pytest.mark.parametrize("step", [2e-6, 50e-6])
@pytest.mark.parametrize("z", [0.0, 5e9, 1e11])
def test_flow_and_pressure_solve_the_network_at_the_end_of_a_step(step: float, z: float):
    """Off its seat the poppet sweeps oil at u - h (a1 - a0)/12, by its accelerations at both instants."""
    c = PRESSURE + z * FLOW

    def line(t: np.ndarray) -> np.ndarray:
        return c * (1.0 + 0.2 * np.sin(3e3 * t))

    rows = run(VALVE, line, 10e-3, s=rest(PRESSURE, VALVE), flow=FLOW, z=z, step=step)
    c_at = line(step * np.arange(1, len(rows) + 1))
    lift, whole = rows[:, 0], rows[:, -1] == 1.0
    ends = [k for k in range(2, len(rows)) if whole[k - 1 : k + 1].all() and (lift[k - 2 : k + 1] > 0.0).all()]
    seated = [k for k in range(2, len(rows)) if lift[k] == 0.0]
    assert len(ends) > 10
    for k in ends[:: max(1, len(ends) // 20)] + seated[::10]:
        now = ReliefState(*rows[k, :4])
        swept = now.pilot_velocity
        if lift[k] > 0.0:
            before, after = (rates(rows[k - j, :4], c_at[k - j], z, VALVE)[1] for j in (1, 0))
            swept -= step * (after - before) / 12.0
        q, p, _ = network(now, c_at[k], z, VALVE, swept)
        assert rows[k, 4] == pytest.approx(q, rel=1e-5)
        assert rows[k, P] == pytest.approx(p, rel=1e-5)


@given(st.floats(-1e7, 4e7), st.floats(-1e-4, 1e-4), st.floats(-12.0, -6.0).map(lambda x: 10.0**x))
def test_the_pilot_node_is_solved_in_closed_form_whatever_the_directions(p: float, pushed: float, conductance: float):
    y, o = pilot_node(p, pushed, conductance, VALVE.orifices), VALVE.orifices
    through = drop(conductance * y - pushed, o.a_12, o.b_12)
    assert y * abs(y) + through == pytest.approx(p, abs=1e-9 * (abs(p) + y * y + abs(through)) + 1e-6)


@given(st.floats(1e-6, 1e-4), st.floats(0.01, 1.0), st.floats(0.0, 1e4))
def test_an_impact_is_at_its_own_instant(x: float, speed: float, pull: float):
    """x - speed t - pull t^2/2 = 0, then Newton's restitution, then free flight again."""
    stops = Stops(1.0, 0.5, 0.0)
    instant = 2 * x / (speed + math.sqrt(speed**2 + 2 * pull * x))
    rebound = 0.5 * (speed + pull * instant)
    rest_of_it = 0.5 * rebound / max(pull, 1e-3)
    lift, _, left = predict_lift(x, -speed, -pull, stops, instant + rest_of_it)
    assert left == pytest.approx(rest_of_it, rel=1e-6)
    assert lift == pytest.approx(rest_of_it * (rebound - 0.5 * pull * rest_of_it), rel=1e-6)


def test_an_impact_whose_rebound_is_shorter_than_the_substep_is_dead():
    assert predict_lift(1e-7, -0.05, -1e4, Stops(1.0, 0.8, 0.0), 20e-6)[:2] == (0.0, 0.0)


@pytest.mark.parametrize(
    ("litres", "swell", "column", "coarse", "order"),
    [(0.12, 1 * BAR, 0, 50e-6, 3.0), (26.7, 0.1 * IMPEDANCE * FLOW, P, 25e-6, 2.5)],
)
def test_smooth_motion_has_its_order(litres: float, swell: float, column: int, coarse: float, order: float):
    """3 with the poppet alone, as the speed at which it sweeps oil; with the spool between 2 and 3, as its rule."""
    flow = litres * LITRE_PER_MINUTE
    p = steady_pressure(flow, VALVE)

    def line(t: np.ndarray) -> np.ndarray:
        return p + IMPEDANCE * flow + swell * (1.0 - np.cos(2 * math.pi * 250 * t))

    def course(step: float) -> np.ndarray:
        return run(VALVE, line, 8e-3, s=rest(p, VALVE), flow=flow, step=step)[:, column]

    fine = course(0.25e-6)
    errors = [np.std(course(h) - fine[round(h / 0.25e-6) - 1 :: round(h / 0.25e-6)]) for h in (coarse, 6.25e-6)]
    assert math.log(errors[0] / errors[1], coarse / 6.25e-6) == pytest.approx(order, abs=0.12)


@pytest.mark.parametrize("step", [50e-6, 100e-6])
@pytest.mark.parametrize("bar", [67.0, 300.0])
@pytest.mark.parametrize("course", ["sudden", "ramp", "fall"])
def test_the_inlet_is_within_0_07_bar_of_steps_of_1_us_and_its_peak_within_0_02(step: float, bar: float, course: str):
    """c to what drives 26.7 l/min at once or within 2 ms, or from it to 30 % of the setting at 60 bar/ms."""
    v, high = valve(pilot_precompression=precompression_for(bar * BAR, FLOW, VALVE)), bar * BAR + IMPEDANCE * FLOW
    courses = {
        "sudden": steadily(high),
        "ramp": lambda t: high * np.minimum(1.0, t / 2e-3),
        "fall": lambda t: np.maximum(0.3 * bar * BAR, high - 6e9 * t),
    }
    s, flow = (rest(bar * BAR, v), FLOW) if course == "fall" else (SHUT, 0.0)
    coarse, fine = (run(v, courses[course], 20e-3, s=s, flow=flow, step=h)[:, P] for h in (step, 1e-6))
    fine = fine[round(step / 1e-6) - 1 :: round(step / 1e-6)]
    assert np.abs(coarse - fine).max() < 0.07 * BAR
    assert coarse.max() == pytest.approx(fine.max(), abs=0.02 * BAR)


@pytest.mark.parametrize(("bar", "grows"), [(67.0, False), (110.0, False), (140.0, True), (300.0, True)])
def test_the_pilot_swings_up_or_dies_as_its_eigenvalue_says(bar: float, grows: bool):
    """At z = 5e9 and 26.7 l/min the boundary is at 123.6 bar: beyond it the spool's supply A v excites the pilot."""
    v = valve(pilot_precompression=precompression_for(bar * BAR, FLOW, VALVE))
    root, at = eigenvalue(bar * BAR, v), rest(bar * BAR, v)
    pushed = at._replace(pilot_lift=1.001 * at.pilot_lift)
    rows = run(v, steadily(LINE - PRESSURE + bar * BAR), 12e-3, s=pushed, flow=FLOW, step=2e-6)
    swing = rows[:, 0] - at.pilot_lift
    early, late = (np.ptp(swing[k : k + 500]) for k in (1500, 5000))
    assert (root.real > 0.0) == grows
    assert math.log(late / early) / 7e-3 == pytest.approx(root.real, abs=0.1 * abs(root.real) + 5.0)


@settings(max_examples=40)
@given(st.lists(POWER, min_size=5, max_size=5), IMPEDANCES, st.lists(st.floats(0.0, 3e7), min_size=3, max_size=6))
def test_the_valve_never_gives_energy(powers: list[float], z: float, corners: list[float]):
    """What the inlet puts in is at least what motion and springs hold at the end; both by sums over steps of 2 us."""
    v, step = varied(powers), 2e-6
    c = np.interp(np.linspace(0.0, 1.0, 2501), np.linspace(0.0, 1.0, len(corners)), [0.0, *corners[1:]])
    rows = follow(SHUT, 0.0, c, z, step, v)
    x, u, lift, speed = rows[-1, :4]
    held = 0.5 * (v.pilot.mass * u**2 + v.main.mass * speed**2)
    held += x * (v.pilot.preload + 0.5 * v.pilot.stiffness * x) + lift * (
        v.main.preload + 0.5 * v.main.stiffness * lift
    )
    work = step * np.sum(rows[:, 4] * rows[:, P])
    assert work >= held - 1e-3 * step * np.sum(np.abs(rows[:, 4] * rows[:, P])) - 1e-9


@settings(max_examples=60)
@given(
    st.lists(POWER, min_size=5, max_size=5),
    IMPEDANCES,
    st.lists(st.floats(-1e5, 1e8), min_size=20, max_size=20),
    st.tuples(st.floats(0.0, 6e-3), st.floats(-3.0, 3.0), st.floats(0.0, 4e-3), st.floats(-1.0, 1.0)),
    st.floats(-1e-2, 1e-2),
    st.floats(1e-6, 100e-6),
)
def test_any_input_gives_numbers_within_the_stops(powers, z, corners, state, flow, step):
    rows = follow(ReliefState(*state), flow, np.array(corners), z, step, varied(powers))
    assert np.isfinite(rows).all()
    assert (rows[:, [0, 2]] >= 0.0).all()
    assert (rows[:, [0, 2]] <= [6e-3, 4e-3]).all()
    assert (rows[:, -1] <= math.ceil(step / FINEST)).all()
