"""Valves between a line and its chamber: static curves by the data sheet's words, what opens them, what holds."""

import math

import numpy as np
import pytest

from tests.support.plant import BAR
from twin.accessory import accessory_neck, begin_accessory, resting_neck
from twin.contact import Stops
from twin.counterbalance import Counterbalance
from twin.neck import steady_flow
from twin.oil import Oil
from twin.orifice import Orifice, area_for, resistance
from twin.pilot_check import PilotCheck
from twin.throttle import Throttle, ThrottleCheck
from twin.valve_body import first_order_body, mass_body

OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
EDGE = Orifice(0.61, 9.33)
LITRE = 1e-3 / 60.0
STEP = 50e-6
STOPS = Stops(1e-3, 0.2, 1e-4)
OPENED = area_for(60.0 * LITRE, 10 * BAR, EDGE, OIL)
CHECK = resistance(area_for(60.0 * LITRE, 4 * BAR, EDGE, OIL), EDGE, OIL)
BODY = mass_body(0.05, 50.0, 40e3, STOPS, STEP)
HOLDING = Counterbalance(200 * BAR, 4.0, 5.0, 50e-6, OPENED, 1e-3, EDGE, 0.0, 1 * BAR, *CHECK, BODY)
VENTED = HOLDING._replace(back_ratio=0.0)
LOCKING = PilotCheck(0.5 * BAR, 3.0, 80e-6, OPENED, 1e-3, EDGE, 0.0, BODY)


def flow_at_rest(valve, p_line: float, p_chamber: float, p_pilot: float) -> float:
    """Out of the chamber [m^3/s]."""
    return -steady_flow(p_line - p_chamber, resting_neck(valve, p_line, p_chamber, p_pilot, OIL))


@pytest.mark.parametrize("pilot", [0.0, 10 * BAR, 40 * BAR])
@pytest.mark.parametrize("back", [0.0, 8 * BAR])
def test_pilot_and_back_pressure_move_the_setting_by_their_ratios(pilot: float, back: float):
    """It cracks at setting - r pilot + (1 + r) back: 200 bar, 160 bar at 10 bar of pilot, 240 bar at 8 bar behind it;
    vented, the back pressure counts for nothing."""
    for valve, counted in ((HOLDING, 5.0), (VENTED, 0.0)):
        cracks = max(200 * BAR - 4.0 * pilot + counted * back, back + 1.0)
        assert flow_at_rest(valve, back, cracks - 1.0, pilot) <= 0.0
        assert flow_at_rest(valve, back, cracks + 0.1 * BAR, pilot) > 0.0


def test_fully_open_it_passes_its_rated_flow_at_its_rated_drop():
    assert flow_at_rest(HOLDING, 0.0, 10 * BAR, 200 * BAR) == pytest.approx(60.0 * LITRE, rel=1e-9)


def test_the_spring_rate_makes_the_rise_of_pressure():
    """Half open at half of the spring's k travel/A = 8 bar: 204 bar, and what an edge of half the area passes."""
    a, b = resistance(0.5 * OPENED, EDGE, OIL)
    q = flow_at_rest(HOLDING, 0.0, 204 * BAR, 0.0)
    assert a * q * q + b * q == pytest.approx(204 * BAR, rel=1e-9)


def test_into_the_chamber_its_check_valve_is_free_from_the_cracking_pressure_on():
    """60 l/min at 4 bar beyond 1 bar."""
    assert -flow_at_rest(HOLDING, 10.9 * BAR, 10 * BAR, 0.0) == 0.0
    assert -flow_at_rest(HOLDING, 15 * BAR, 10 * BAR, 0.0) == pytest.approx(60.0 * LITRE, rel=1e-9)


def test_a_pilot_check_opens_at_the_load_over_its_ratio():
    """150 bar behind it, 0 before: r p_pilot = 150.5 bar cracks it; any less holds to the last drop."""
    needed = (150 * BAR + 0.5 * BAR) / 3.0
    assert flow_at_rest(LOCKING, 0.0, 150 * BAR, needed - 10.0) == 0.0
    assert flow_at_rest(LOCKING, 0.0, 150 * BAR, needed + 10.0) > 0.0
    assert flow_at_rest(LOCKING, 0.0, 150 * BAR, 0.0) == 0.0


@pytest.mark.parametrize("pilot", [0.0, 3 * BAR, 200 * BAR])
def test_a_pilot_check_never_passes_more_than_its_seat(pilot: float):
    """Into the chamber the pilot's share and the check's share of the seat add up to all of it."""
    most = 60.0 * LITRE
    inflow = -flow_at_rest(LOCKING, 10 * BAR, 0.0, 10 * BAR + pilot)
    assert 0.97 * most < inflow <= most * (1.0 + 1e-9)


def test_a_body_follows_a_pilot_behind_its_damping_orifice_with_a_lag():
    """Pilot lag of 1 ms, massless body: the lift after 1 ms is that of 1 - 1/e of the pilot's step; within a step."""
    lagging = HOLDING._replace(pilot_kept=math.exp(-STEP / 1e-3), body=first_order_body(0.0, 40e3, 1e-3, STEP))
    memory = np.zeros(12)
    begin_accessory(lagging, 0.0, 190 * BAR, 0.0, memory)
    for _ in range(20):
        accessory_neck(lagging, 0.0, 190 * BAR, 5 * BAR, memory, OIL, STEP)
    beyond = 20 * BAR * (1.0 - math.exp(-1.0)) - 10 * BAR
    assert memory[0] == pytest.approx(beyond * 50e-6 / 40e3, abs=20 * BAR * 50e-6 / 40e3 * STEP / 1e-3)


def test_a_valve_that_settles_stays_where_it_began():
    for valve in (HOLDING, VENTED, LOCKING):
        memory = np.zeros(12)
        begin_accessory(valve, 2 * BAR, 150 * BAR, 26 * BAR, memory)
        start, neck = memory.copy(), None
        for _ in range(100):
            neck = accessory_neck(valve, 2 * BAR, 150 * BAR, 26 * BAR, memory, OIL, STEP)
        assert memory == pytest.approx(start, rel=1e-12, abs=1e-15)
        assert neck == resting_neck(valve, 2 * BAR, 150 * BAR, 26 * BAR, OIL)


def test_a_throttle_is_its_edge_and_a_throttle_check_is_free_one_way():
    a, b = resistance(2e-6, EDGE, OIL)
    edge = steady_flow(9 * BAR, resting_neck(Throttle(a, b), 0.0, 0.0, 0.0, OIL))
    assert a * edge**2 + b * edge == pytest.approx(9 * BAR)
    for meters_out, sign in ((1.0, 1.0), (0.0, -1.0)):
        neck = resting_neck(ThrottleCheck(a, b, meters_out, 1 * BAR, *CHECK), 0.0, 0.0, 0.0, OIL)
        assert steady_flow(-sign * 9 * BAR, neck) == pytest.approx(-sign * edge)
        q = sign * steady_flow(sign * 9 * BAR, neck)
        assert q == pytest.approx(edge + math.sqrt((8 * BAR) / CHECK[0]), rel=0.05)
        small = sign * steady_flow(sign * 0.9 * BAR, neck)
        assert a * small**2 + b * small == pytest.approx(0.9 * BAR)
