"""The dimensionless actuator and arcs of its analogue loop, against finite differences, scipy and table 5.1."""

import math

import numpy as np
import pytest

from controller.stability.actuator.model import (
    TABLE_5_1,
    Actuator,
    Feedback,
    dimensionless,
    field,
    linearise,
    mirror,
    omega,
)
from controller.stability.orbits.arc import (
    PROPORTIONAL,
    RELAY,
    SMOOTHED,
    Loop,
    derivatives,
    end_rates,
    follow,
)
from twin.integration import integrate

PLANT = Actuator(0.01, 0.5, 0.5)
STATE = np.array([0.002, -0.004, 0.45, 0.57])
LOOPS = {
    RELAY: Loop(RELAY, PLANT, Feedback(10.0, 0.1), 0.0, 0.0),
    PROPORTIONAL: Loop(PROPORTIONAL, PLANT, Feedback(1.4, 0.1), 0.0, 0.0),
    SMOOTHED: Loop(SMOOTHED, PLANT, Feedback(10.0, 0.1), 0.05, 0.0),
}


def test_table_5_1_gives_another_gamma_than_printed():
    plant = dimensionless(TABLE_5_1)
    assert omega(TABLE_5_1) == pytest.approx(136.2, abs=0.1)
    assert plant.alpha == pytest.approx(6.133e-3, rel=1e-4)
    assert plant.gamma == pytest.approx(6.95e-3, rel=1e-3)


def test_a_drive_that_cannot_be_is_refused():
    with pytest.raises(ValueError, match=r"supply 100000\.0 Pa must be above relief"):
        dimensionless(TABLE_5_1._replace(supply=1e5))
    with pytest.raises(ValueError, match=r"mass 0\.0 must be finite and above 0"):
        dimensionless(TABLE_5_1._replace(mass=0.0))
    with pytest.raises(ValueError, match=r"p_e 1\.0 must lie between"):
        linearise(PLANT, 1.0)


@pytest.mark.parametrize("p_e", [0.2, 0.5, 0.9])
def test_the_linear_model_is_the_slope_of_the_field_on_both_sides_of_the_kink(p_e: float):
    a, *columns = linearise(PLANT, p_e)
    rest, size = np.array([0.0, 0.0, p_e, p_e]), 1e-6
    slopes = np.transpose(
        [(field(rest + size * e, 0.0, PLANT) - field(rest - size * e, 0.0, PLANT)) / (2 * size) for e in np.eye(4)]
    )
    assert slopes == pytest.approx(a, abs=1e-6)
    for column, side in zip(columns, (1.0, -1.0), strict=True):
        assert field(rest, side * size, PLANT) / (side * size) == pytest.approx(column, rel=1e-9)
    sigma = math.sqrt(p_e) + math.sqrt(1.0 - p_e)
    assert [b[2] - b[3] for b in columns] == pytest.approx([PLANT.gamma / PLANT.alpha * sigma] * 2, rel=1e-12)


def test_the_mirrored_motion_obeys_the_mirrored_signal():
    y = np.random.default_rng(5).uniform([-0.5, -1, -0.1, -0.1], [0.5, 1, 1.1, 1.1], (50, 4))
    u = np.linspace(-1.0, 1.0, 50)
    turned = np.array([-1, -1, 1, 1]) * field(y, u, PLANT)[:, [0, 1, 3, 2]]
    assert field(mirror(y), -u, PLANT) == pytest.approx(turned, rel=1e-12)


def signal(loop: Loop, y: np.ndarray) -> float:
    return 1.0 if loop.kind == RELAY else -(loop.gains.s * y[0] + loop.gains.d * y[1])


@pytest.mark.parametrize("kind", [RELAY, PROPORTIONAL])
def test_an_arc_is_what_scipy_integrates(kind: int):
    """Bar of 1e-8 on pressures of size 1; both integrators are asked for 1e-11 a step."""
    loop, start = LOOPS[kind], STATE * [-1, 1, 1, 1]
    limits = {"rtol": 1e-12, "atol": 1e-13}
    with_scipy = integrate(
        lambda _, y: field(y, signal(loop, y), PLANT), (0.0, 0.02), start, "DOP853", most=200_000, **limits
    )
    row, time = follow(start, 0.02, loop, 1e-11, False)
    assert time == 0.02
    assert row[:4] == pytest.approx(with_scipy.y[:, -1], abs=1e-8)


@pytest.mark.parametrize("kind", [RELAY, PROPORTIONAL, SMOOTHED])
def test_the_derivatives_of_an_arc_are_those_of_its_end(kind: int):
    """Central differences of 1e-6 err by their square and by the arc's 1e-11 over 1e-6: 1e-4 of what they see."""
    loop, start, size = LOOPS[kind], STATE * [-1, 1, 1, 1], 1e-6

    def end(shift: np.ndarray) -> np.ndarray:
        gains = Feedback(loop.gains.s + shift[4], loop.gains.d + shift[5])
        return follow(start + shift[:4], 0.02, loop._replace(gains=gains), 1e-12, False)[0][:4]

    seen = np.array([(end(size * e) - end(-size * e)) / (2 * size) for e in np.eye(6)]).T
    found = derivatives(follow(start, 0.02, loop, 1e-12, False)[0])
    assert found == pytest.approx(seen, rel=1e-4, abs=1e-4)


def test_an_arc_ends_where_h_rises_through_zero():
    loop = LOOPS[RELAY]
    row, time = follow(np.array([2e-5, -2e-3, 0.1, 0.9]), 5.0, loop, 1e-10, True)
    assert 0.0 < time < 5.0
    assert loop.gains.s * row[0] + loop.gains.d * row[1] == pytest.approx(0.0, abs=1e-12)
    assert loop.gains.s * row[1] + loop.gains.d * end_rates(row[:4], loop)[1] > 0.0
