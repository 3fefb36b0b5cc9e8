"""A load lowered through a counterbalance valve: linear theory and twin agree on what swings."""

import pytest

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


@pytest.mark.parametrize(("case", "swinging"), CASES.items())
def test_theory_and_twin_agree_on_growth_and_frequency(case: tuple[float, float, float], swinging: bool):
    """Both sides of the edge in the pilot ratio, with two lines: the sign, the growth to 5 1/s (the piston goes 35 mm
    meanwhile, and the growth with it), the frequency to 4 %."""
    rig = drive(*case)
    predicted, seen = theory(rig), grown(rig)
    assert (predicted.growth > 0.0) == (seen.growth > 0.0) == swinging
    assert seen.growth == pytest.approx(predicted.growth, abs=5.0)
    assert seen.frequency == pytest.approx(predicted.frequency, rel=0.04)


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
