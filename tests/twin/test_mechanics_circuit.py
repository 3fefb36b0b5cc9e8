"""Actuators, frictions and loads in the circuit: geometry, rest in every orientation, oil, slopes, refusals."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.support.plant import BAR, TIGHT, circuit, run, watched
from twin.actuator import DrainedCylinder, moduli
from twin.circuit.build import rebuild
from twin.circuit.equilibrium import equilibrium
from twin.circuit.limits import limits, natural_frequency
from twin.circuit.linear import jacobian, linearise, moving_point, to_vector
from twin.circuit.rates import STATES, vector_rates
from twin.circuit.state import pressures
from twin.circuit.step import Circuit
from twin.kernel import interpreted
from twin.load_at_rest import held_force
from twin.rig import values

BORE, ROD = math.pi / 4.0 * 0.05**2, math.pi / 4.0 * 0.032**2
DRIVES: dict[str, dict[str, Any]] = {
    "two rods, compliant": {
        "cylinder": {"rod_at": "both", "angle": 0.0, "outside_lower": 1e16, "wall": 5e-3, **TIGHT},
        "friction": {"kind": "lugre"},
        "load": {"kind": "compliant", "stiffness": 2e4, "neutral": 0.1, "viscous": 500.0, "quadratic": 100.0},
    },
    "motor, lever": {
        "actuator": {"kind": "motor"},
        "motor": {"ripple": 0.05, "leakage_resistance": math.inf, "case_resistance": 1e15},
        "friction": {"kind": "stribeck", "coulomb": 2.0, "static": 3.0, "viscous": 0.1},
        "load": {
            "kind": "lever",
            "mass": 0.1,
            "inertia": ((0.0, 0.2), (0.3, 0.4), (1.0, 0.2)),
            "lift": ((0.0, -10.0), (0.3, -8.0), (1.0, -5.0)),
        },
        "valve": {"rated_flow": 5e-5},
    },
}


@cache
def drive(name: str) -> Circuit:
    return circuit(**DRIVES[name])


@pytest.mark.parametrize(
    ("rod_at", "lower", "upper"), [("a", BORE - ROD, BORE), ("b", BORE, BORE - ROD), ("both", BORE - ROD, BORE - ROD)]
)
def test_the_rod_takes_its_area_where_it_is(rod_at: str, lower: float, upper: float):
    c = circuit(cylinder={"rod_at": rod_at}).parts.cylinder
    assert (c.area_lower, c.area_upper) == pytest.approx((lower, upper), rel=1e-12)


@pytest.mark.parametrize("degrees", [90.0, 30.0, 0.0, -45.0])
def test_gravity_acts_along_the_axis(degrees: float):
    c = circuit(cylinder={"angle": math.radians(degrees)})
    assert held_force(c.parts.load, 0.1) == pytest.approx(120.0 * 9.81 * math.sin(math.radians(degrees)), abs=1e-9)
    p = pressures(equilibrium(c, 0.1, p_upper=20 * BAR if degrees >= 0.0 else 0.0))
    force = (BORE - ROD) * p.lower - BORE * p.upper
    assert force == pytest.approx(120.0 * 9.81 * math.sin(math.radians(degrees)), abs=1e-6)


def test_an_elastic_barrel_widens_by_its_bore():
    """1/B' = 1/B + (A_bore/A) d/(w E): the annulus is the softer one."""
    c = circuit(cylinder={"wall": 5e-3})
    assert isinstance(c.parts.cylinder, DrainedCylinder)
    b, oil = interpreted(moduli)(c.parts.cylinder), c.parts.oil.bulk_modulus
    assert 1.0 / b.upper - 1.0 / oil == pytest.approx(0.05 / (5e-3 * 2.1e11), rel=1e-9)
    assert 1.0 / b.lower - 1.0 / oil == pytest.approx(BORE / (BORE - ROD) * 0.05 / (5e-3 * 2.1e11), rel=1e-9)


def test_a_spring_adds_to_the_oils():
    free, held = circuit(load={"kind": "environment"}), circuit(load={"kind": "environment", "stiffness": 1e6})
    gained = natural_frequency(held, 0.1) ** 2 - natural_frequency(free, 0.1) ** 2
    assert gained == pytest.approx(1e6 / 120.0, rel=1e-9)
    assert natural_frequency(free, 0.1) == natural_frequency(circuit(), 0.1)


@pytest.mark.parametrize("name", DRIVES)
def test_a_held_drive_stays_put_and_a_moving_one_keeps_its_oil(name: str):
    """Within a micrometre in 20 ms where nothing leaks across the piston; balance below 1e-12 of the oil a second."""
    c = drive(name)
    start = equilibrium(c, 0.1, 20 * BAR if "two rods" in name else 0.0)
    held = run(start, 0.0, c, 0.02)
    assert held.piston.position == pytest.approx(0.1, abs=1e-6)
    seen, _ = watched(held, 0.5, c, 0.1, every=40)
    assert np.ptp(seen["position"]) > 1e-3
    assert all(np.isfinite(column).all() for column in seen.values())
    assert min(seen["p_lower"].min(), seen["p_upper"].min()) >= c.parts.oil.vapour_pressure
    stored, pumped, relieved, returned = (
        seen[f"oil_{word}"] - seen[f"oil_{word}"][0] for word in ("stored", "pumped", "relieved", "returned")
    )
    assert np.abs(stored - (pumped - relieved - returned)).max() < 1e-13 * seen["oil_stored"][0]


def test_slopes_are_those_of_the_rates():
    """Every column of the Jacobian against central differences about a moving point: a motor that turns a lever."""
    c = drive("motor, lever")
    y, spool = to_vector(moving_point(c, 0.1, 0.6)), 0.6
    scale = np.array([1e3] * 9 + [1e-8] * 6 + [1e-6, 1e-5, 1e-6, 1e-4])
    exact = jacobian(y, c, None)
    for column, size in enumerate(scale):
        step = np.zeros(len(y))
        step[column] = size
        slope = (vector_rates(y + step, spool, c) - vector_rates(y - step, spool, c)) / (2.0 * size)
        assert np.abs(exact[:, column] - slope).max() <= 2e-3 * np.abs(slope).max(), STATES[column]


def test_what_has_no_linear_model_is_refused_in_one_line():
    c = drive("two rods, compliant")
    with pytest.raises(ValueError, match="compliant load") as error:
        linearise(equilibrium(c, 0.1), None, circuit=c)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"load": {"kind": "lever", "added": 10.0}}, "load.added 10.0 kg joins"),
        ({"load": {"kind": "lever", "inertia": ((0.1, 5.0), (0.1, 6.0))}}, "must rise"),
        ({"load": {"kind": "lever", "inertia": ((0.1, 0.0),)}}, "above 0 kg"),
        ({"load": {"added": 10.0}, "cylinder": {"angle": -0.5}}, "support below it"),
        ({"friction": {"kind": "stribeck", "coulomb": 500.0}}, "friction.static 400.0 N is less"),
        ({"load": {"kind": "compliant", "far_mass": 1e-4}}, "load.far_mass 0.0001 kg swings too fast"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(parts: dict[str, Any], said: str):
    with pytest.raises(ValueError, match=said) as error:
        circuit(**parts)
    assert "\n" not in str(error.value)


def test_a_leak_to_the_outside_may_grow_while_it_runs_but_not_begin():
    rig = values({"cylinder": {"outside_lower": 1e12}})
    with pytest.raises(ValueError, match="cannot get one while it runs"):
        rebuild(circuit(), rig, "cylinder.outside_lower")
    leaking = circuit(cylinder={"outside_lower": 1e13})
    then = rebuild(leaking, rig, "cylinder.outside_lower").parts.cylinder
    assert isinstance(then, DrainedCylinder)
    assert then.outside_lower == 1e-12


def test_a_link_and_bristles_have_limits_of_their_own():
    told = {(limit.part, limit.what): limit.time for limit in limits(drive("two rods, compliant"))}
    assert told["load", "two masses on their link"] == pytest.approx(math.sqrt(120.0 * 100.0 / 220.0 / 2e6))
    assert told["friction", "on its bristles"] == pytest.approx(math.sqrt(120.0 / 1e7))
