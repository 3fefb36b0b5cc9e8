"""Oil: the tables and figures of section 2.2.3 of the thesis, recomputed."""

import math

import pytest

from twin.oil import (
    SECONDS_TO_VISCOSITY,
    effective_modulus,
    exponential_viscosity,
    fluid_modulus,
    kinematic_viscosity,
)


@pytest.mark.parametrize(
    ("celsius", "quadratic", "exponential"),
    [
        (25.0, 87.785, 75.932),
        (30.0, 66.471, 62.137),
        (40.0, 40.135, 41.610),
        (50.0, 25.965, 27.864),
        (60.0, 17.998, 18.659),
        (70.0, 13.367, 12.495),
        (75.0, 11.821, 10.225),
    ],
)
def test_viscosity_laws_reproduce_their_table(celsius: float, quadratic: float, exponential: float):
    assert kinematic_viscosity(celsius) * 1e6 == pytest.approx(quadratic, abs=5.1e-4)
    assert exponential_viscosity(celsius) * 1e6 == pytest.approx(exponential, abs=5.1e-4)


def test_viscosity_of_the_valve_table_belongs_to_40_07_celsius():
    assert kinematic_viscosity(40.07) == pytest.approx(40e-6, rel=2e-4)


def test_quadratic_law_is_refused_where_it_leaves_its_data():
    assert kinematic_viscosity(80.0) > 0.0
    with pytest.raises(ValueError, match=r"80\.1 deg C: .* holds from -20 to 80 deg C"):
        kinematic_viscosity(80.1)
    with pytest.raises(ValueError, match="nan"):
        kinematic_viscosity(math.nan)


def test_falling_ball_gives_0_932_mpas_per_second():
    factor = SECONDS_TO_VISCOSITY
    assert factor == pytest.approx(0.93241e-3, rel=1e-5)
    assert factor / 876.56 == pytest.approx(1.06371e-6, rel=1e-5)


def test_measured_modulus_and_wave_speed_agree():
    assert math.sqrt(1.135e9 / 878.0) == pytest.approx(1136.97, abs=0.005)


@pytest.mark.parametrize(("young", "fluid"), [(2.1e11, 1.16977e9), (2.1e10, 1.61511e9)])
def test_fluid_modulus_from_the_steel_pipe(young: float, fluid: float):
    """d = 11 mm, wall 2 mm; the second is the thesis's slip, E ten times too small."""
    assert fluid_modulus(1.135e9, 11e-3, 2e-3, young) == pytest.approx(fluid, rel=1e-5)
    assert effective_modulus(fluid, 11e-3, 2e-3, young) == pytest.approx(1.135e9, rel=1e-5)


def test_rigid_wall_leaves_the_modulus_alone():
    assert effective_modulus(1.17e9, 11e-3, 2e-3, math.inf) == pytest.approx(1.17e9, rel=1e-15)
