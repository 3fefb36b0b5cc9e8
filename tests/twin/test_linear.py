"""The linear model: its Jacobian, its points, its gain and its frequencies, and what it says it assumes."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from tests.support.plant import (
    BAR,
    FRICTIONLESS,
    SMOOTH,
    TIGHT,
    circuit,
    cylinder_of,
    pipes,
    run,
    valve_of,
)
from twin.actuator import chamber_volumes
from twin.circuit.equilibrium import equilibrium
from twin.circuit.linear import (
    LANDS,
    edge_point,
    from_vector,
    jacobian,
    lands,
    linearise,
    moving_point,
    to_vector,
)
from twin.circuit.rates import STATES, vector_rates
from twin.circuit.state import pressures
from twin.circuit.step import Circuit, Piston
from twin.orifice import flow

C = circuit(pump=SMOOTH, seal=FRICTIONLESS)
SOFT = circuit(
    pump=SMOOTH, seal=FRICTIONLESS, oil={"air": 0.01}, pipe_1={"model": "none"}, pipe_2={"model": "volume"},
    pipe_3={"model": "volume"}, pipe_6={"model": "volume"},
)  # fmt: skip
SIZES = np.array([1e5] * 9 + [1e-4] * 6 + [0.1, 0.1, 0.1, 10.0])


@pytest.mark.parametrize("spool", [0.2, 0.5, 0.9, -0.15, -0.4])
@pytest.mark.parametrize("viscous", [0.0, 2000.0])
@pytest.mark.parametrize("own", [C, SOFT], ids=["rig", "soft"])
def test_jacobian_is_the_derivative_of_the_rates(own: Circuit, spool: float, viscous: float):
    """Central differences of 1e-4 of each state's size: error 1e-8 and rounding, relative to the largest effect. Also
    of lines of one volume and oil with air, whose capacity turns by 1e-3 over a difference: taken at standstill."""
    point = moving_point(own, 0.135, spool, viscous)
    y = to_vector(point)
    differences = np.empty((19, 19))
    for column, size in enumerate(SIZES * 1e-4):
        d = np.eye(19)[column] * size
        differences[:, column] = vector_rates(y + d, spool, own, viscous) - vector_rates(y - d, spool, own, viscous)
    differences /= 2e-4
    analytic = jacobian(y, own, None, viscous) * SIZES
    scale = np.abs(analytic).max(axis=1, keepdims=True)
    np.testing.assert_allclose(differences / scale, analytic / scale, atol=1e-5)


@pytest.mark.parametrize("spool", [0.15, 0.5, 1.0, -0.15, -0.4])
def test_a_moving_point_stands_still_but_for_the_piston(spool: float):
    point = moving_point(C, 0.135, spool, 2000.0)
    drift = vector_rates(to_vector(point), spool, C, 2000.0) / SIZES
    still = [name not in ("position",) for name in STATES]
    assert np.abs(drift[still]).max() < 1e-6  # sizes per second: 1 bar in 11 days
    assert math.copysign(1.0, point.piston.velocity) == math.copysign(1.0, spool)


def test_a_run_reaches_the_moving_point():
    """After 0.4 s at 0.2 the frictionless piston rises at the point's speed, within its 0.04 %/mm change on the way."""
    c = circuit(pump=SMOOTH, seal=FRICTIONLESS, cylinder=TIGHT)
    end = run(equilibrium(c, 0.05), 0.2, c, 1.5)
    point = moving_point(c, end.piston.position, 0.2)
    assert end.piston.velocity == pytest.approx(point.piston.velocity, rel=2e-3)
    assert pressures(end).lower == pytest.approx(pressures(point).lower, rel=2e-3)


def test_a_moving_point_needs_no_edge_point():
    """303 kg sink faster than the pump fills at any small opening; a viscous drag holds them back."""
    c = circuit(load={"mass": 303.0})
    with pytest.raises(ValueError, match=r"cavitate|does not follow"):
        moving_point(c, 0.1, -0.2)
    assert pressures(moving_point(c, 0.1, -0.2, 1e4)).upper > 0.0


def test_round_trip_of_state_and_vector():
    point = moving_point(C, 0.1, 0.3)
    np.testing.assert_allclose(to_vector(from_vector(to_vector(point), C)), to_vector(point), rtol=1e-9)


@pytest.mark.parametrize(("edge", "sign"), [("+", 1.0), ("-", -1.0)])
def test_edge_point_is_the_limit_of_slow_motion(edge: str, sign: float):
    """0.1 % of opening, tight piston, lands without transition: the closed form, but for the compression of the oil.

    (p_l - p_u)/B = 0.25 % less flow comes out than its area says: 0.05 bar.
    """
    c = circuit(cylinder=TIGHT, valve={"transition": 0.0})
    p = np.array(pressures(edge_point(c, 0.1, edge)))
    near = np.array(pressures(moving_point(c, 0.1, sign * 0.101)))
    assert np.abs(near - p).max() < 0.06 * BAR


def test_edge_point_upwards_by_hand():
    """66.9 bar supply, 120 kg: A_l p_l - A_u p_u = m g, p_u = (A_u/A_l)^2 (p_P - p_l)."""
    p, c = pressures(edge_point(C, 0.1, "+")), C.parts.cylinder
    assert c.area_lower * p.lower - c.area_upper * p.upper == pytest.approx(120.0 * 9.81, abs=1e-3)
    assert p.upper / (p.p - p.lower) == pytest.approx((c.area_upper / c.area_lower) ** 2, rel=1e-9)
    assert (p.lower / BAR, p.upper / BAR) == (pytest.approx(57.23, abs=0.01), pytest.approx(27.79, abs=0.01))


def test_edge_point_downwards_by_hand():
    p, c = pressures(edge_point(C, 0.1, "-")), C.parts.cylinder
    assert c.area_lower * p.lower - c.area_upper * p.upper == pytest.approx(120.0 * 9.81, abs=1e-3)
    assert p.lower / (p.p - p.upper) == pytest.approx((c.area_lower / c.area_upper) ** 2, rel=1e-9)


@pytest.mark.parametrize("edge", ["+", "-"])
def test_edge_gain_is_the_flow_of_one_percent_of_opening(edge: str):
    """The turbulent slope, against the transition law at 1 % of the travel: 1 % apart."""
    point, valve = edge_point(C, 0.1, edge), valve_of(C)
    p = pressures(point)
    for land in lands(to_vector(point), C, edge):
        source, sink = LANDS[land.name]
        drop = p[source] - p[sink]
        one_percent = flow(drop, 0.01 / 0.9 * valve.area, valve.orifice, C.parts.oil)
        assert abs(land.by_spool) * 0.01 == pytest.approx(one_percent, rel=0.03)
        assert math.copysign(1.0, land.by_spool) == (1.0 if edge == "+" else -1.0)
        assert land.by_drop == 0.0


def test_velocity_gain_of_the_edge_model_meets_the_moving_points():
    """Slow response to a small opening: v/(s - overlap) of the tight, frictionless plant beyond 0.5 % of opening."""
    c = circuit(cylinder=TIGHT)
    system = linearise(edge_point(c, 0.1, "+"), circuit=c)
    gain = np.asarray(system(1e-3j))[1, 0].real
    assert gain == pytest.approx(moving_point(c, 0.1, 0.105).piston.velocity / 0.005, rel=0.02)


@pytest.mark.parametrize("friction", ["none", 500.0])
@pytest.mark.parametrize("edge", ["+", "-", None])
def test_open_loop_is_marginal_by_its_integrator_only(edge: str | None, friction: str | float):
    point = edge_point(C, 0.135, edge or "+")
    poles = linearise(point, edge, friction, circuit=C).poles()
    integrators = np.abs(poles) < 1e-6
    assert integrators.sum() == 1
    assert np.real(poles[~integrators]).max() < 0.0


def short_pipes() -> dict[str, dict[str, float]]:
    short = {"length": 1e-3, "model": "lumped"}
    return {"pipe_3": short, "pipe_4": short}


@pytest.mark.parametrize("mass", [120.0, 302.0])
def test_natural_frequency_is_that_of_the_oil_springs(mass: float):
    """m omega^2 = A_l^2/C_l + A_u^2/C_u; S = V (1 + p/B) makes each spring stiffer by 1 + p/B, here below 0.3 %."""
    c = circuit(1e-7, cylinder=TIGHT, load={"mass": mass}, **short_pipes())
    cylinder = cylinder_of(c)
    v_lower, v_upper = chamber_volumes(0.135, cylinder)
    stiffness = sum(
        area**2 / (volume / cylinder.bulk_modulus + c.lines.capacity[2])
        for area, volume in ((cylinder.area_lower, v_lower), (cylinder.area_upper, v_upper))
    )
    poles = linearise(equilibrium(c, 0.135), None, circuit=c).poles()
    omega = math.sqrt(stiffness / mass)
    assert np.abs(np.abs(np.imag(poles)) - omega).min() < 3e-3 * omega


def test_small_motions_of_the_plant_follow_the_linear_model():
    """Shut valve, tight: a push of 1 mm/s, 40 ms. Step error (omega h)^2/24 omega t: 1e-3 of the amplitude."""
    c = circuit(10e-6, pump=SMOOTH, seal=FRICTIONLESS, cylinder=TIGHT, **pipes(model="lumped"))
    start = equilibrium(c, 0.135)
    pushed = start.with_core(piston=Piston(0.135, 1e-3))
    a = jacobian(to_vector(start), c, None)
    for ms in (7, 40):
        linear = expm(a * ms * 1e-3) @ (to_vector(pushed) - to_vector(start))
        moved = to_vector(run(pushed, 0.0, c, ms * 1e-3)) - to_vector(start)
        assert moved[16] == pytest.approx(linear[16], abs=3e-6)
        assert moved[4:6] == pytest.approx(linear[4:6], abs=3e-3 * np.abs(linear[4:6]).max())


def test_the_system_says_what_was_assumed():
    system = linearise(edge_point(C, 0.1, "+"), circuit=C)
    assert getattr(system, "note", "") == system.name == "land edge +, overlap removed, friction off"
    assert system.state_labels == list(STATES)
    assert system.input_labels == ["spool_reference", "force"]
    assert system.output_labels == ["position", "velocity", "p1", "p2", "p3"]
    assert getattr(linearise(moving_point(C, 0.1, 0.5), None, 200.0, circuit=C), "note", "") == (
        "spool 0.5, friction 200 N s/m"
    )


def test_force_moves_the_load_and_the_reference_the_spool():
    inputs = np.asarray(linearise(edge_point(C, 0.1, "+"), circuit=C).B)
    expected = np.zeros((19, 2))
    expected[STATES.index("velocity"), 1] = 1.0 / 120.0
    expected[STATES.index("spool_velocity"), 0] = (2.0 * math.pi * 30.0) ** 2
    np.testing.assert_allclose(inputs, expected, rtol=1e-12)


@pytest.mark.parametrize("edge", ["up", "", 1])
def test_wrong_edges_are_refused(edge):
    with pytest.raises(ValueError, match=r"is none of '\+', '-'"):
        linearise(edge_point(C, 0.1, "+"), edge, circuit=C)
    with pytest.raises(ValueError, match=r"is none of '\+', '-'"):
        edge_point(C, 0.1, edge)


@pytest.mark.parametrize("friction", ["seal", -1.0, math.nan, math.inf])
def test_wrong_frictions_are_refused(friction):
    with pytest.raises(ValueError, match="neither 'none' nor a slope"):
        linearise(edge_point(C, 0.1, "+"), "+", friction, circuit=C)


def test_a_switching_valve_has_no_slope():
    with pytest.raises(ValueError, match="no slope between them"):
        edge_point(circuit(valve={"kind": "switching"}), 0.1, "+")
    with pytest.raises(ValueError, match="no slope between them"):
        moving_point(circuit(valve={"kind": "switching"}), 0.1, 1.0)


def test_points_that_do_not_exist_are_refused():
    with pytest.raises(ValueError, match="inside the overlap"):
        moving_point(C, 0.1, 0.1)
    with pytest.raises(ValueError, match="cavitate at 'upper'"):
        edge_point(circuit(load={"mass": 303.0}), 0.1, "-")
    with pytest.raises(ValueError, match=r"does not follow|cavitate"):
        moving_point(C, 0.1, -1.0)
