"""Cushioned ends: the law of the gap, and the speed at the stop against an independent integration."""

import math

import numpy as np
import pytest

from tests.support.plant import BAR
from twin.cushion import NoCushion, OrificeCushion, SpearCushion, cushion_losses, spear_gap
from twin.integration import integrate
from twin.kernel import kernel
from twin.neck import Neck, in_series, neck_flow, plain_side
from twin.oil import Oil
from twin.orifice import Orifice, quadratic_flow, resistance
from twin.port import Port

OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
STROKE, AREA, DEAD, MASS, LENGTH, SPEED = 0.3, 20e-4, 20e-6, 600.0, 0.02, 0.6
EDGE = resistance(30e-6, Orifice(0.61, 9.33), OIL)
SPEAR = spear_gap(30e-3, 0.4e-3, 0.61, OIL)
CUSHIONS = {
    "orifice": OrificeCushion(0.0, LENGTH, 0.0, 0.0, *EDGE, STROKE),
    "spear": SpearCushion(0.0, LENGTH, 0.0, 0.0, *SPEAR, STROKE),
}


@kernel
def speed_at_stop(cushion, speed, start, step):
    """A mass runs into its upper end, the chamber open to a line at no pressure: the scheme of the circuit."""
    x, v, p, q, v_half = start, speed, 0.0, 0.0, speed
    volume = DEAD + AREA * (STROKE - x)
    stored, open_port = volume, Port(0.0, 1e6)
    while x < STROKE:
        v -= 0.5 * step * AREA * p / MASS
        x += step * v
        v_half = v
        volume = DEAD + AREA * (STROKE - min(x, STROKE))
        z = 0.5 * step * OIL.bulk_modulus / volume
        free = OIL.bulk_modulus * ((stored + 0.5 * step * q) / volume - 1.0)
        side = plain_side(0.0, 0.0)
        _, _, a, b = cushion_losses(cushion, x)
        then = neck_flow(open_port, Port(free, z), Neck(side, in_series(side, a, b)), OIL)
        stored += 0.5 * step * (q + then)
        q, p = then, free + z * then
        v = v_half - 0.5 * step * AREA * p / MASS
        if v <= 0.0:
            return -1.0
    return v_half


def reference(kind: str, speed: float, start: float) -> float:
    """The same stated once more: m v' = -A p, V p'/B = A v (1 + p/B) - q, q by the law of the gap; Radau."""

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, p = y
        depth = LENGTH - (STROKE - x)
        if kind == "orifice":
            a, b = EDGE
        else:
            a = 878.0 / (2.0 * (0.61 * math.pi * 30e-3 * 0.4e-3) ** 2)
            b = 12.0 * 878.0 * 40e-6 * depth / (math.pi * 30e-3 * 0.4e-3**3)
        q = quadratic_flow(p, a, b + 1e6) if depth > 0.0 else p / 1e6
        volume = DEAD + AREA * (STROKE - x)
        return [v, -AREA * p / MASS, 1.17e9 * (AREA * v * (1.0 + p / 1.17e9) - q) / volume]

    def there(t: float, y: np.ndarray) -> float:
        return y[0] - STROKE

    there.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
    open_p = AREA * speed * 1e6
    options = {"rtol": 1e-9, "atol": 1e-9, "events": there}
    found = integrate(rates, (0.0, 5.0), [start, speed, open_p], "Radau", most=60_000, **options)
    return float(found.y[1, -1])


@pytest.mark.parametrize("kind", CUSHIONS)
def test_the_speed_at_the_stop_is_that_of_an_independent_integration(kind: str):
    """600 kg at 0.6 m/s into 20 mm of cushion, to 0.1 % of the entry speed: half a step's braking is 0.04 %."""
    start = STROKE - LENGTH + 1e-9
    exact = reference(kind, SPEED, start)
    assert exact < 0.75 * SPEED
    for step in (100e-6, 50e-6):
        assert speed_at_stop(CUSHIONS[kind], SPEED, start, step) == pytest.approx(exact, abs=1e-3 * SPEED)


def test_without_a_cushion_the_stop_meets_the_whole_speed():
    assert speed_at_stop(NoCushion(), SPEED, STROKE - LENGTH, 50e-6) == pytest.approx(SPEED, rel=1e-3)


def test_the_gap_is_laminar_and_longer_the_deeper_the_spear():
    """12 mu l q/(pi d c^3): twice the depth, twice the drop; a tenth of the clearance, a thousand times."""
    assert cushion_losses(CUSHIONS["spear"], STROKE - 0.5 * LENGTH)[3] == pytest.approx(
        12.0 * 878.0 * 40e-6 * 0.5 * LENGTH / (math.pi * 30e-3 * 0.4e-3**3)
    )
    assert spear_gap(30e-3, 40e-6, 0.61, OIL)[1] == pytest.approx(1000.0 * SPEAR[1])
    assert cushion_losses(CUSHIONS["spear"], STROKE - 1.01 * LENGTH) == (0.0, 0.0, 0.0, 0.0)
    assert cushion_losses(CUSHIONS["orifice"], 0.0) == (0.0, 0.0, 0.0, 0.0)


def test_a_cushion_at_a_pressure_of_100_bar_passes_what_its_edge_does():
    side = in_series(plain_side(0.0, 0.0), *EDGE)
    q = neck_flow(Port(0.0, 1.0), Port(100 * BAR, 1.0), Neck(plain_side(0.0, 0.0), side), OIL)
    assert -q == pytest.approx(quadratic_flow(100 * BAR, *EDGE), rel=1e-6)
