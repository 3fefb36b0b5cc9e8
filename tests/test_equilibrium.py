"""Start of a run: everything stands still, at the pressures that hand calculation gives."""

import math

import numpy as np
import pytest

from tests.plant import BAR, TIGHT, circuit
from twin.circuit import pressures
from twin.equilibrium import equilibrium, supply_at_rest
from twin.pump import pumped_oil
from twin.rates import rates
from twin.relief import relief_flow


@pytest.mark.parametrize(("mass", "bar"), [(302.0, 25.56), (120.0, 10.16)])
def test_lower_chamber_carries_the_load(mass: float, bar: float):
    """m g over the annulus, pi/4 (50^2 - 32^2) mm^2, with p_u = 0."""
    c = circuit(load={"mass": mass})
    p = pressures(equilibrium(c, 0.1), c)
    assert p.lower / BAR == pytest.approx(bar, abs=0.006)
    assert (p.a, p.upper, p.b, p.t, p.back) == (pytest.approx(p.lower, abs=1.0), 0.0, 0.0, 0.0, 0.0)


def test_counter_pressure_of_the_upper_chamber_is_carried_too():
    c = circuit()
    p = pressures(equilibrium(c, 0.1, p_upper=10 * BAR), c)
    force = c.cylinder.area_lower * p.lower - c.cylinder.area_upper * p.upper
    assert force == pytest.approx(120.0 * 9.81, abs=1e-3)


@pytest.mark.parametrize("force", [500.0, -500.0])
def test_an_external_force_upwards_relieves_the_oil(force: float):
    c = circuit(load={"force": force})
    start = equilibrium(c, 0.1)
    assert pressures(start, c).lower * c.cylinder.area_lower == pytest.approx(120.0 * 9.81 - force, abs=1e-3)
    assert rates(start, 0.0, c).piston.velocity == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("speed", [0.0, 1.0, 3.0, 6.0, 1230.0 / 60.0, 30.0])
@pytest.mark.parametrize("efficiency", [0.875, 1.0])
def test_relief_valve_carries_what_the_pump_gives(speed: float, efficiency: float):
    """From a pump at rest, or one whose leak takes all before the relief valve opens, to full speed."""
    c = circuit(pump={"speed": speed, "efficiency": efficiency})
    pump, tee, flow = supply_at_rest(c)
    assert flow == pytest.approx(relief_flow(tee, c.relief), rel=1e-12)
    assert flow == pytest.approx(pumped_oil(pump, c.pump, c.oil.bulk_modulus)[0], abs=1e-12)


@pytest.mark.parametrize("position", [0.0, 0.1, 0.27])
@pytest.mark.parametrize("speed", [0.0, 3.0, 20.5])
def test_nothing_moves(position: float, speed: float):
    """Rates of a tight circuit: pressures by rounding of S (1e-19 m^3 per 1e-14 m^3/Pa) only."""
    c = circuit(cylinder=TIGHT, pump={"speed": speed})
    d = rates(equilibrium(c, position), 0.0, c)
    assert np.abs(d.oil).max() < 1e-12  # m^3/s: 1e-7 l/min
    assert np.abs(d.flows).max() < 1e-11
    assert d.piston == (0.0, pytest.approx(0.0, abs=1e-9))


@pytest.mark.parametrize("position", [-1e-9, 0.2701, math.nan])
def test_start_outside_the_stroke_is_refused(position: float):
    with pytest.raises(ValueError, match="outside the stroke"):
        equilibrium(circuit(), position)


def test_load_that_needs_a_vacuum_is_refused():
    with pytest.raises(ValueError, match="lifts the load off the oil"):
        equilibrium(circuit(load={"force": 3e3}), 0.1)
