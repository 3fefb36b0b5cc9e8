"""Start of a run: everything stands still, at the pressures that hand calculation gives."""

import math

import numpy as np
import pytest

from tests.support.plant import (
    BAR,
    FRICTIONLESS,
    SMOOTH,
    TIGHT,
    circuit,
    pipes,
    pump_of,
    relief_of,
    run,
)
from twin.circuit.equilibrium import equilibrium, supply_at_rest
from twin.circuit.linear import to_vector
from twin.circuit.rates import STATES, vector_rates
from twin.circuit.state import flatten, flows, pressures
from twin.pump import pumped_oil
from twin.relief.steady import steady_flow


@pytest.mark.parametrize(("mass", "bar"), [(302.0, 25.56), (120.0, 10.16)])
def test_lower_chamber_carries_the_load(mass: float, bar: float):
    """m g over the annulus, pi/4 (50^2 - 32^2) mm^2, with p_u = 0."""
    c = circuit(load={"mass": mass})
    p = pressures(equilibrium(c, 0.1))
    assert p.lower / BAR == pytest.approx(bar, abs=0.006)
    assert (p.a, p.upper, p.b, p.t, p.back) == (pytest.approx(p.lower, abs=1.0), 0.0, 0.0, 0.0, 0.0)


def test_counter_pressure_of_the_upper_chamber_is_carried_too():
    c = circuit()
    p, cylinder = pressures(equilibrium(c, 0.1, p_upper=10 * BAR)), c.parts.cylinder
    force = cylinder.area_lower * p.lower - cylinder.area_upper * p.upper
    assert force == pytest.approx(120.0 * 9.81, abs=1e-3)


@pytest.mark.parametrize("force", [500.0, -500.0])
def test_an_external_force_upwards_relieves_the_oil(force: float):
    c = circuit(load={"force": force})
    start = equilibrium(c, 0.1)
    assert pressures(start).lower * c.parts.cylinder.area_lower == pytest.approx(120.0 * 9.81 - force, abs=1e-3)
    assert vector_rates(to_vector(start), 0.0, c)[STATES.index("velocity")] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("speed", [0.0, 1.0, 3.0, 6.0, 1230.0 / 60.0, 30.0])
@pytest.mark.parametrize("efficiency", [0.875, 1.0])
def test_relief_valve_carries_what_the_pump_gives(speed: float, efficiency: float):
    """From a pump at rest, or one whose leak takes all before the relief valve opens, to full speed."""
    c = circuit(pump={"speed": speed, "efficiency": efficiency})
    pump, tee, relieved, idle = supply_at_rest(c)
    assert relieved == pytest.approx(steady_flow(tee, relief_of(c)), rel=1e-12)
    assert relieved + idle == pytest.approx(pumped_oil(pump, 1.0, pump_of(c), c.parts.oil.bulk_modulus)[0], abs=1e-12)


def test_through_a_tandem_centre_the_pump_idles_to_the_tank():
    """All drops from pump to tank add up to the pump's pressure, some 5 bar; the relief valve stays shut."""
    c = circuit(pump=SMOOTH, cylinder=TIGHT, valve={"kind": "switching"})
    start = equilibrium(c, 0.1)
    p, q = pressures(start), flows(start)
    assert q.line_1 == q.line_2 == q.line_5 == q.line_6 > 26e-3 / 60.0
    assert 3 * BAR < p.pump < 8 * BAR
    assert p.pump > p.tee > p.p > p.t > p.back > 0.0
    later = run(start, 0.0, c, 0.2)
    assert pressures(later) == pytest.approx(p, abs=50.0)
    assert later.core.relief.flow == 0.0


def test_without_a_relief_valve_the_leakage_takes_it_all():
    """p = Q/k = 35 bar/(1 - 0.875); a tight pump has no outlet."""
    c = circuit(relief={"kind": "none"})
    assert supply_at_rest(c).tee / BAR == pytest.approx(35.0 / 0.125, rel=1e-9)
    with pytest.raises(ValueError, match="no outlet"):
        supply_at_rest(circuit(relief={"kind": "none"}, pump={"efficiency": 1.0}))


def test_a_pump_that_runs_up_starts_from_nothing():
    start = equilibrium(circuit(pump={"run_up": 0.3}), 0.1)
    assert pressures(start).pump == pressures(start).tee == flows(start).line_1 == 0.0


@pytest.mark.parametrize("model", ["ends", "nodes", "lumped", "volume", "none"])
def test_a_tight_circuit_at_rest_stays_where_it_is(model: str):
    """A second of steps with a smooth pump and every model of a line: pressures to 1 Pa, the piston to the bit."""
    c = circuit(pump=SMOOTH, cylinder=TIGHT, **pipes(model=model))
    start = equilibrium(c, 0.1)
    end = run(start, 0.0, c, 1.0)
    assert pressures(end) == pytest.approx(pressures(start), abs=1.0)
    assert end.piston == start.piston
    assert np.isfinite(flatten(end)).all()


@pytest.mark.parametrize("position", [0.0, 0.1, 0.27])
@pytest.mark.parametrize("speed", [0.0, 3.0, 20.5])
def test_nothing_moves(position: float, speed: float):
    """Rates of a tight circuit: pressures by rounding of flows (1e-12 of 1e-4 m^3/s per 1e-13 m^3/Pa) only."""
    c = circuit(cylinder=TIGHT, pump={"speed": speed})
    d = vector_rates(to_vector(equilibrium(c, position)), 0.0, c)
    assert np.abs(d[:9]).max() < 1e3  # Pa/s
    assert np.abs(d[9:15]).max() < 1e-11
    assert np.abs(d[15:]).max() < 1e-9


@pytest.mark.parametrize("position", [-1e-9, 0.2701, math.nan])
def test_start_outside_the_stroke_is_refused(position: float):
    with pytest.raises(ValueError, match="outside the stroke"):
        equilibrium(circuit(), position)


def test_what_the_lower_chamber_cannot_carry_the_upper_one_does():
    """Down to the vapour pressure below; from there on m g - F = -A_u p_u, and the load stays where it is."""
    most = 120.0 * 9.81 + 1e5 * math.pi / 4.0 * (0.05**2 - 0.032**2)
    assert pressures(equilibrium(circuit(load={"force": most - 1e-3}), 0.1)).lower == pytest.approx(-1 * BAR, rel=1e-5)
    c = circuit(load={"force": 3e3}, cylinder=TIGHT, seal=FRICTIONLESS)
    start = equilibrium(c, 0.1)
    assert pressures(start).lower == 0.0
    assert pressures(start).upper == pytest.approx((3e3 - 120.0 * 9.81) / c.parts.cylinder.area_upper, rel=1e-12)
    assert run(start, 0.0, c, 0.02).piston.position == pytest.approx(0.1, abs=1e-9)
