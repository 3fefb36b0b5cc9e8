"""A load lowered through a counterbalance valve: linear theory and twin agree on what swings."""

from typing import Any

import pytest

from bridge.scenario import load
from bridge.scenario.circuit import circuit_of
from bridge.scenario.lowering_swing import in_words, lowering_swings
from tests.support.lowering import POSITION, SPOOL, STEP, drive, grown, theory
from twin.circuit.build import build
from twin.circuit.lowering import lowering

CASES = {  # pilot ratio, length of the held line, of the pilot's [m]: does it swing?
    (2.0, 6.0, 0.5): False,
    (4.0, 6.0, 0.5): True,
    (4.0, 0.5, 0.5): False,
    (12.0, 0.5, 0.5): True,
    (8.0, 2.05, 2.1): False,
}
MOTOR = ["rig.accessory_a.kind=counterbalance", "rig.actuator.kind=motor"]


@pytest.mark.parametrize(("case", "swinging"), CASES.items())
def test_theory_and_twin_agree_on_growth_and_frequency(case: tuple[float, float, float], swinging: bool):
    """Both sides of the edge in the pilot ratio, with two lines: the sign, the growth to 5 1/s (the piston goes 35 mm
    meanwhile, and the growth with it), the frequency to 4 %."""
    rig = drive(*case)
    predicted, seen = theory(rig), grown(rig)
    assert (predicted.growth > 0.0) == (seen.growth > 0.0) == swinging
    assert seen.growth == pytest.approx(predicted.growth, abs=5.0)
    assert seen.frequency == pytest.approx(predicted.frequency, rel=0.04)


@pytest.mark.parametrize(
    ("own", "shift"),
    [
        ({"wall": 3e-3, "young": 1e10}, (-2.2, -14.2)),  # a barrel that gives way
        ({"leakage_resistance": 3e11}, (-15.3, 0.1)),
        ({"outside_lower": 5e11}, (-2.3, 0.0)),
        ({"holes": "fitted", "hole_upper": 1.2e-3}, (-5.7, -0.6)),
    ],
)
def test_a_soft_barrel_and_leaks_do_in_theory_what_they_do_in_the_twin(own: dict[str, Any], shift: tuple[float, float]):
    """Beside a drive without them: growth to 1 1/s, frequency to 0.5 Hz."""
    plain, changed = drive(8.0, 0.5, 0.5), drive(8.0, 0.5, 0.5)
    changed["cylinder"].update(own)
    for found in (theory, grown):
        before, after = found(plain), found(changed)
        assert after.growth - before.growth == pytest.approx(shift[0], abs=1.0)
        assert after.frequency - before.frequency == pytest.approx(shift[1], abs=0.5)


def test_the_steady_lowering_balances_and_the_valve_meters():
    """Forces balance without friction; the oil of both chambers follows the piston; the valve throttles in between."""
    circuit = build(drive(4.0, 2.05, 2.1), STEP)
    at, cylinder = lowering(circuit, POSITION, SPOOL), circuit.parts.cylinder
    assert cylinder.area_lower * at.p_held - cylinder.area_upper * at.p_driven == pytest.approx(600.0 * 9.81, rel=1e-9)
    assert at.q_held == pytest.approx(cylinder.area_lower * at.speed, rel=0.01)
    assert at.q_driven == pytest.approx(cylinder.area_upper * at.speed, rel=0.01)
    assert at.p_held > at.p_line + 10e5 > at.p_t


def test_what_does_not_hold_or_not_move_is_refused():
    circuit = build(drive(4.0, 2.05, 2.1), STEP)
    with pytest.raises(ValueError, match=r"see accessory_b\.kind"):
        lowering(circuit, POSITION, 0.3)
    stiff = drive(0.0, 2.05, 2.1)
    stiff["accessory_a"]["setting"] = 900e5
    with pytest.raises(ValueError, match="take a lower setting"):
        lowering(build(stiff, STEP), POSITION, SPOOL)
    leaky = load("press", ["rig.cylinder.leakage_resistance=1e10"])
    with pytest.raises(ValueError, match="leaks alone lower the load"):
        lowering(circuit_of(leaky), POSITION, SPOOL)
    forced = load("press", ["rig.relief.kind=none", "rig.supply.kind=fixed", "rig.fixed_pump.leakage=0"])
    with pytest.raises(ValueError, match="fit a relief valve"):
        lowering(circuit_of(forced), POSITION, SPOOL)


def test_leaks_and_dampers_are_in_the_balance():
    """What the piston sweeps leaves through the valve and the leaks; the dampers carry their share of the load."""
    rig = drive(4.0, 2.05, 2.1)
    rig["cylinder"] |= {"leakage_resistance": 1e12, "outside_lower": 2e12, "outside_upper": 3e12}
    rig["load"] |= {"kind": "environment", "viscous": 500.0, "quadratic": 2000.0}
    circuit = build(rig, STEP)
    at, cylinder, b = lowering(circuit, POSITION, SPOOL), circuit.parts.cylinder, circuit.parts.oil.bulk_modulus
    drag = (500.0 + 2000.0 * at.speed) * at.speed
    assert cylinder.area_lower * at.p_held - cylinder.area_upper * at.p_driven == pytest.approx(600.0 * 9.81 - drag)
    leak = (at.p_held - at.p_driven) / 1e12
    held, driven = cylinder.area_lower * (1.0 + at.p_held / b), cylinder.area_upper * (1.0 + at.p_driven / b)
    assert at.q_held == pytest.approx(held * at.speed - leak - at.p_held / 2e12, rel=1e-6)
    assert at.q_driven == pytest.approx(driven * at.speed - leak + at.p_driven / 3e12, rel=1e-4)


@pytest.mark.parametrize(("name", "changes", "hertz"), [("crane", [], 5.9), ("step", MOTOR, 344.0)])
def test_every_drive_gets_a_prediction(name: str, changes: list[str], hertz: float):
    """A lever whose pump gives less than the valve would take, and a shaft without stops."""
    found = lowering_swings(load(name, changes))["accessory_a"]
    assert not isinstance(found, str), found
    assert found.swing is not None
    assert found.swing.growth < 0.0
    assert found.swing.frequency == pytest.approx(hertz, rel=0.05)


def test_a_valve_of_three_positions_is_looked_at_where_it_can_stand():
    (found,) = lowering_swings(load("press", ["rig.valve.kind=switching"])).values()
    assert not isinstance(found, str), found
    assert found.opening == 1.0
    assert "fully open" in in_words(found)
