"""Pilot poppet: the thesis's printed numbers, its areas by elementary geometry, its forces by (2.33), (2.34)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.relief_valve import BAR, valve
from twin.relief.chamfered_seat import ChamferedSeat
from twin.relief.poppet import cracking_pressure, pilot_opening
from twin.seats.frustum import frustum_area

PILOT = valve().pilot
SEAT = PILOT.seat
RHO = 878.0


@pytest.mark.parametrize(("lift_mm", "zeta"), [(0.2, 786.12), (0.3, 309.37), (0.4, 159.63), (0.5, 95.55)])
def test_the_loss_coefficients_are_those_of_table_2_2(lift_mm: float, zeta: float):
    """Q = A_in sqrt(2 p/(rho zeta)), (2.25)."""
    conductance, _ = pilot_opening(lift_mm * 1e-3, PILOT)
    assert 2.0 * (PILOT.area / conductance) ** 2 / RHO == pytest.approx(zeta, abs=0.005)


def test_seat_area_and_cracking_pressure():
    assert PILOT.area == pytest.approx(24.6301e-6, rel=1e-6)
    cracking = [cracking_pressure(valve(pilot_precompression=x).pilot) / BAR for x in (0.2e-3, 1.0e-3)]
    assert cracking == pytest.approx([65.854, 329.272], abs=5e-4)


def test_frequency_critical_damping_and_drag_are_as_printed():
    omega = math.sqrt(PILOT.stiffness / PILOT.mass)
    assert omega == pytest.approx(8746.97, abs=0.005)
    assert omega / (2 * math.pi) == pytest.approx(1392.12, abs=0.005)
    assert 2 * PILOT.mass * omega == pytest.approx(185.436, abs=5e-4)
    assert PILOT.drag == pytest.approx(0.021515, abs=5e-7)
    assert PILOT.drag / (PILOT.mass * omega) == pytest.approx(2.3191e-4, rel=1.1e-3)  # printed from 0.0215 and 1392 Hz


@given(st.floats(0.0, 4e-3), st.floats(0.1, 1.4))
def test_the_area_is_that_of_the_shortest_frustum(lift: float, angle: float):
    """Slant H = x sin a between seat radius r and r - H cos a: 2 pi H times the mean radius."""
    r, slant = 2.8e-3, lift * math.sin(angle)
    mean_radius = r - 0.5 * slant * math.cos(angle)
    area = frustum_area(lift, 2 * r, math.sin(angle), math.cos(angle))
    assert area == pytest.approx(2 * math.pi * slant * mean_radius, rel=1e-12, abs=1e-25)


@given(st.floats(1e-9, 3e-3), st.floats(0.0, 4e7))
def test_the_fluid_force_is_pressure_and_momentum(lift: float, p2: float):
    """(2.33), (2.34): A_in p2 + rho Q^2 (1/A_in - cos a/A_pl)."""
    conductance, area = pilot_opening(lift, PILOT)
    flow = conductance * math.sqrt(p2)
    assert isinstance(SEAT, ChamferedSeat)
    seat = frustum_area(lift, SEAT.diameter, SEAT.sine, SEAT.cosine)
    momentum = RHO * flow**2 * (1.0 / PILOT.area - SEAT.cosine / seat)
    assert area * p2 == pytest.approx(PILOT.area * p2 + momentum, rel=1e-12, abs=1e-12)


def test_a_shut_seat_passes_nothing_and_feels_p2_on_its_bore():
    assert pilot_opening(0.0, PILOT) == (0.0, PILOT.area)
    assert pilot_opening(1e-12, PILOT)[1] == pytest.approx(PILOT.area, rel=1e-9)
