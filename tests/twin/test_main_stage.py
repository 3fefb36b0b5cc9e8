"""Main stage: the damping and the thrust that the thesis prints, with its numbers and with ours."""

import math

import pytest

from tests.support.relief_valve import BAR, valve
from twin.relief.main_stage import main_opening


@pytest.mark.parametrize(
    ("numbers", "film", "surge", "damper"),
    [
        ({}, 1.1475, 29.53, 2.2087e6),
        ({"spool_diameter": 22e-3, "spool_discharge": 0.8, "orifice_discharge": 0.8}, 0.97093, 32.77, 471309.0),
    ],
)
def test_the_damping_of_the_spool_is_as_printed(numbers: dict[str, float], film: float, surge: float, damper: float):
    """(2.37), (2.38) at 40 bar, (2.40). The thesis's numbers use 22 mm, 0.8 and L = 10 mm, not the 20 mm stated."""
    v = valve(**numbers)
    assert v.main.film == pytest.approx(film, rel=5e-5)
    assert v.main.surge * math.sqrt(40 * BAR) == pytest.approx(surge, rel=2e-3)
    assert v.orifices.a_3 * v.main.area**3 == pytest.approx(damper, rel=5e-5)


def test_the_thrust_on_the_open_spool_is_as_corrected():
    """At 4 mm, 26 mm: A_out/A = 0.40167; with Cd 0.8 and the linearised 0.43514 the thesis prints 0.8485."""
    main = valve(spool_discharge=0.8).main
    seat = main_opening(4e-3, main)
    opening = seat.conductance / main.jet / main.area
    assert opening == pytest.approx(0.40167, abs=5e-6)
    assert seat.area / main.area == pytest.approx(1 + 2 * 0.64 * opening * (opening - math.sqrt(0.5)), rel=1e-12)
    assert 1 + 2 * 0.64 * 0.43514 * (0.43514 - math.sqrt(0.5)) == pytest.approx(0.84852, abs=5e-6)


def test_frequency_and_critical_damping_are_as_printed():
    main = valve().main
    omega = math.sqrt(main.stiffness / main.mass)
    assert omega == pytest.approx(646.584, abs=5e-4)
    assert omega / (2 * math.pi) == pytest.approx(102.907, abs=5e-4)
    assert 2 * main.mass * omega == pytest.approx(84.444, abs=5e-4)


def test_the_slopes_of_the_mouth_are_those_of_its_values():
    main = valve().main
    below, at, above = (main_opening(x, main) for x in (1e-3 - 1e-8, 1e-3, 1e-3 + 1e-8))
    assert at.conductance_slope == pytest.approx((above.conductance - below.conductance) / 2e-8, rel=1e-7)
    assert at.area_slope == pytest.approx((above.area - below.area) / 2e-8, rel=1e-6)
