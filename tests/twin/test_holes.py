"""Holes in a cylinder's chambers: what leaves through them, and that a tight one is as if there were none."""

import math
from typing import Any

import pytest

from tests.support.plant import circuit
from twin.actuator import fill_chambers, stored_oil
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import oil_in, pressures
from twin.cylinder import Chambers, HoledCylinder
from twin.kernel import interpreted
from twin.port import Port

BAR = 1e5
CLOSED = Port(0.0, 1e30)  # a line that passes nothing
TURBULENT = {"holes": "fitted", "hole_transition": 0.0, "leakage_resistance": math.inf}


def holed(**cylinder: Any) -> tuple[HoledCylinder, float]:
    """The rig's cylinder with holes, and the density of its oil."""
    c = circuit(cylinder=TURBULENT | cylinder)
    assert isinstance(c.parts.cylinder, HoledCylinder)
    return c.parts.cylinder, c.parts.oil.density


@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_a_chamber_empties_as_torricelli_says(step: float):
    """C p' = -c A sqrt(2 p/rho), C = V/B: the root of the pressure falls linearly."""
    cylinder, density = holed(hole_lower=0.2e-3)
    x, p = 0.135, Chambers(60 * BAR, 10 * BAR)
    capacity = (cylinder.dead_lower + cylinder.area_lower * x) / cylinder.modulus_lower
    rate = 0.5 * 0.61 * 0.25 * math.pi * 0.2e-3**2 * math.sqrt(2.0 / density) / capacity
    stored, lost, still = interpreted(stored_oil)(p, x, cylinder), 0.0, Chambers(0.0, 0.0)
    began = stored.lower + stored.upper
    for _ in range(round(5e-3 / step)):
        stored, p, gone = interpreted(fill_chambers)(stored, p, still, CLOSED, CLOSED, x, cylinder, step)
        lost += gone
    assert math.sqrt(p.lower) == pytest.approx(math.sqrt(60 * BAR) - rate * 5e-3, rel=100.0 * step)
    assert p.upper == pytest.approx(10 * BAR)
    assert stored.lower + stored.upper + lost == pytest.approx(began, rel=1e-14)


def test_nothing_is_drawn_in():
    cylinder, _ = holed(hole_upper=1e-3)
    p, x = Chambers(10 * BAR, -0.5 * BAR), 0.1
    stored, still = interpreted(stored_oil)(p, x, cylinder), Chambers(0.0, 0.0)
    then, after, lost = interpreted(fill_chambers)(stored, p, still, CLOSED, CLOSED, x, cylinder, 50e-6)
    assert lost == 0.0
    assert after.upper == pytest.approx(-0.5 * BAR)
    assert then == stored


def test_a_cylinder_whose_holes_are_shut_rests_as_a_tight_one():
    tight, shut = circuit(), circuit(cylinder={"holes": "fitted"})
    rests = [equilibrium(c, 0.1, 5 * BAR) for c in (tight, shut)]
    assert pressures(rests[0]) == pytest.approx(pressures(rests[1]), rel=1e-12)
    assert oil_in(rests[0]) == pytest.approx(oil_in(rests[1]), rel=1e-12)
