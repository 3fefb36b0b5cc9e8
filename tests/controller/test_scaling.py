"""A sampled drive between SI and the numbers of the thesis's model."""

import math

import numpy as np
import pytest

from controller.stability import Plant, Timing, critical_gain, loop_onset, sampled_loop
from controller.stability.actuator.model import TABLE_5_1, Drive
from controller.stability.actuator.scaling import Numbers, SampledGains, to_numbers, to_si

DRIVE = TABLE_5_1._replace(friction=900.0)
LOOP = SampledGains(0.03, 0.012, 25.0, 0.4)


@pytest.mark.parametrize("seed", range(20))
def test_both_ways_are_inverse(seed: int):
    factors = np.exp(np.random.default_rng(seed).uniform(-3.0, 3.0, 12)).tolist()
    drive = Drive(*(value * factor for value, factor in zip(DRIVE, factors[:8], strict=True)))
    drive = drive._replace(supply=drive.relief + drive.supply)
    loop = SampledGains(*(value * factor for value, factor in zip(LOOP, factors[8:], strict=True)))
    numbers = to_numbers(drive, loop)
    again = to_si(numbers, drive)
    assert again[0] == pytest.approx(drive, rel=1e-12)
    assert again[1] == pytest.approx(loop, rel=1e-12)
    assert to_numbers(*to_si(numbers, DRIVE)) == pytest.approx(numbers, rel=1e-12)


def test_table_5_1_has_the_numbers_of_its_equations():
    found = to_numbers(DRIVE, LOOP)
    unit = math.sqrt(1.32e-3 * 1.125e9 / (0.4 * 200.0))
    assert found.alpha == pytest.approx(69e5 / 1.125e9)
    assert found.gamma == pytest.approx(6.95e-3, rel=1e-3)
    assert found[2:] == pytest.approx((900.0 / (200.0 * unit), 0.03 * unit, 0.4, 25.0 * 0.4, 0.4 * 0.4 * unit))


@pytest.mark.parametrize("delay", [0.0, 0.012])
def test_the_loop_in_si_loses_stability_at_the_gain_of_the_numbers(delay: float):
    """m v' = A p - K v, p' = 2 B/(A L) (q - A v), q the mean of both lands' flows, Q_max u/sqrt(2) each; x' = v."""
    d, loop = DRIVE, LOOP._replace(delay=delay, derivative=0.0)
    spring = 2.0 * d.modulus / (d.area * d.length)
    a = np.array([[0.0, 1.0, 0.0], [0.0, -d.friction / d.mass, d.area / d.mass], [0.0, -spring * d.area, 0.0]])
    plant = Plant(a, np.array([0.0, 0.0, spring * d.flow / math.sqrt(2.0)]), np.eye(3)[0], np.eye(3)[1])
    onset = loop_onset(sampled_loop(plant, Timing(loop.period, delay / loop.period)), 0.0)
    numbers = to_numbers(d, loop)
    expected = critical_gain(0.0, numbers.k, numbers.gamma, Timing(numbers.tau, numbers.delay))
    assert onset is not None
    assert onset.gain * d.length == pytest.approx(float(expected), rel=1e-9)


@pytest.mark.parametrize(
    ("change", "words"), [({"tau": 0.0}, "tau 0 must be finite and above 0"), ({"s": -1.0}, "s -1 must be")]
)
def test_numbers_that_no_drive_has_are_refused(change: dict[str, float], words: str):
    numbers: Numbers = to_numbers(DRIVE, LOOP)._replace(**change)
    with pytest.raises(ValueError, match=words):
        to_si(numbers, DRIVE)
