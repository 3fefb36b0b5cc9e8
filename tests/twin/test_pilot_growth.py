"""The damping of the pilot's swing in the rig does not depend on the step: theory with both lines, both signs."""

import numpy as np
import pytest

from tests.support.pilot_growth import circuit_at, flow_of, grown, modes, theory, with_pilot

CALM, SINGING = 10.0, 6.5  # speeds of the pump [Hz]: 7.7 and 2.5 l/min over the valve


@pytest.mark.parametrize(("step", "within"), [(50e-6, 1.0), (100e-6, 3.0)])
@pytest.mark.parametrize("speed", [CALM, SINGING])
def test_the_pilot_grows_or_dies_as_theory_says_at_any_step(speed: float, step: float, within: float):
    found, exact = grown(circuit_at(speed, step, with_pilot()))[0], theory(speed, with_pilot())[0]
    assert found.growth == pytest.approx(exact.growth, abs=within)
    assert found.frequency == pytest.approx(exact.frequency, rel=2e-3)


def test_a_pilot_between_these_lines_sings_below_some_six_litres_per_minute():
    below, above = 8.8, 9.3
    growth = [theory(speed, with_pilot())[0].growth for speed in (SINGING, below, above, CALM)]
    assert growth == sorted(growth, reverse=True)
    assert growth[1] > 0.0 > growth[2]
    assert (
        flow_of(circuit_at(below, 50e-6, with_pilot())) * 6e4
        < 6.2
        < flow_of(circuit_at(above, 50e-6, with_pilot())) * 6e4
    )


@pytest.mark.parametrize(("step", "within"), [(50e-6, 4.5), (25e-6, 1.2)])
def test_the_pilot_of_the_rig_sings_at_every_flow(step: float, within: float):
    """As fitted: by theory, and in the twin nearly as fast, with an error that falls with the square of the step."""
    assert all(theory(speed, {})[0].growth > 100.0 for speed in (6.0, 12.0, 20.0))
    found = grown(circuit_at(8.0, step, {}), seconds=0.05)[0]
    assert found.growth == pytest.approx(theory(8.0, {})[0].growth, abs=within)


@pytest.mark.parametrize(("volume", "sign"), [(10e-6, -1.0), (20e-6, 1.0)])
def test_oil_before_the_pilot_makes_it_sing_as_theory_says(volume: float, sign: float):
    """On both sides of the edge."""
    found, exact = grown(circuit_at(15.0, 25e-6, with_pilot(volume)))[0], theory(15.0, with_pilot(volume))[0]
    assert exact.growth * sign > 0.0
    assert found.growth == pytest.approx(exact.growth, abs=1.0)
    assert found.frequency == pytest.approx(exact.frequency, rel=2e-3)


def test_growth_is_found_in_a_sum_of_swings():
    time = 1e-4 * np.arange(1500)
    swings = [
        size * np.exp(rate * time) * np.cos(2.0 * np.pi * f * time)
        for size, rate, f in ((1.0, -4.0, 1612.0), (0.3, -50.0, 1448.0), (0.5, -9.0, 300.0))
    ]
    assert modes(sum(swings), 1e-4)[0] == pytest.approx((-4.0, 1612.0), abs=1e-5)
