"""Lands between four ports: each obeys its orifice, flows balance at every port, whichever are open."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR, circuit, valve_of
from twin.lands import Lands, Ports, land_flows
from twin.oil import Oil
from twin.orifice import Orifice, resistance
from twin.port import Port, pressure
from twin.spool_valve import closed_centre_lands
from twin.switching_valve import SwitchingValve, switch_spool, tandem_lands

OIL = Oil(878.0, 40e-6, 1.17e9, -1e5)
EDGE = Orifice(0.61, 9.33)
AREA = st.floats(0.0, 1.0).map(lambda share: 0.0 if share < 0.1 else 5e-5 * share**3)
FREE = st.floats(-50 * BAR, 200 * BAR)
Z = st.floats(1e9, 2e10)
VALVE = SwitchingValve(1.0 / 30e-3, 1.0 / 20e-3, 0.0, 1.0, 5e-5, EDGE)


def drops(q: Lands, ports: Ports) -> dict[str, float]:
    p = pressure(ports.p, -(q.p_a + q.p_b + q.p_t), OIL.vapour_pressure)
    a = pressure(ports.a, q.p_a - q.a_t, OIL.vapour_pressure)
    b = pressure(ports.b, q.p_b - q.b_t, OIL.vapour_pressure)
    t = pressure(ports.t, q.b_t + q.a_t + q.p_t, OIL.vapour_pressure)
    return {"p_a": p - a, "b_t": b - t, "p_b": p - b, "a_t": a - t, "p_t": p - t}


@given(st.tuples(FREE, FREE, FREE, FREE), st.tuples(Z, Z, Z, Z), AREA, AREA, st.booleans())
def test_every_open_land_obeys_its_orifice_and_a_shut_one_is_tight(free, z, area, centre, up):
    """With the land P-T open beside others too: to 1 Pa in 200 bar."""
    ports = Ports(*(Port(f, i) for f, i in zip(free, z, strict=True)))
    areas = Lands(area, area, 0.0, 0.0, centre) if up else Lands(0.0, 0.0, area, area, centre)
    q = land_flows(ports, areas, EDGE, OIL)
    found = drops(q, ports)
    for name, opened, flow in zip(Lands._fields, areas, q, strict=True):
        if opened <= 0.0:
            assert flow == 0.0
        else:
            a, b = resistance(opened, EDGE, OIL)
            assert (a * abs(flow) + b) * flow == pytest.approx(found[name], rel=1e-6, abs=1.0)


@pytest.mark.parametrize("opened", [1e-300, 1e-170, 1e-31])
def test_an_area_that_has_no_square_is_shut(opened: float):
    """A spool that comes to rest at an edge nears it for ever; with no transition the law would be infinity times 0."""
    ports = Ports(Port(9.0 * BAR, 1e9), Port(0.0, 1e9), Port(2.0 * BAR, 1e9), Port(0.0, 1e9))
    assert land_flows(ports, Lands(opened, opened, 0.0, 0.0, 0.0), Orifice(0.61, 0.0), OIL) == Lands(
        0.0, 0.0, 0.0, 0.0, 0.0
    )


def test_tandem_centre_lets_the_pump_idle_and_shuts_the_cylinder_in():
    assert tandem_lands(0.0, VALVE) == Lands(0.0, 0.0, 0.0, 0.0, VALVE.area)
    assert tandem_lands(1.0, VALVE) == Lands(VALVE.area, VALVE.area, 0.0, 0.0, 0.0)
    assert tandem_lands(-1.0, VALVE) == Lands(0.0, 0.0, VALVE.area, VALVE.area, 0.0)


def test_on_its_way_the_switching_valve_opens_as_much_as_it_closes():
    for s in (0.1, 0.5, -0.7):
        lands = tandem_lands(s, VALVE)
        assert lands.p_a + lands.p_b + lands.p_t == pytest.approx(VALVE.area)


@pytest.mark.parametrize(("reference", "end"), [(1.0, 1.0), (0.6, 1.0), (0.5, 0.0), (-0.4, 0.0), (-0.9, -1.0)])
def test_the_magnets_know_three_positions_and_need_the_switching_time(reference: float, end: float):
    h, s, steps = 1e-4, 0.0, 0
    while abs(s - end) > 1e-12:
        s, _ = switch_spool(s, reference, VALVE, h)
        steps += 1
        assert steps < 1000
    assert steps * h == pytest.approx(30e-3 if end else 0.0, abs=h)
    assert switch_spool(s, reference, VALVE, h) == (end, 0.0)


def test_springs_bring_the_spool_back_in_their_own_time():
    """From a magnet's end to the middle in 20 ms, from one end to the other in 20 + 30 ms."""
    for reference, seconds in ((0.0, 20e-3), (-1.0, 50e-3)):
        s, steps = 1.0, 0
        while abs(s - reference) > 1e-12:
            s, _ = switch_spool(s, reference, VALVE, 1e-4)
            steps += 1
        assert steps * 1e-4 == pytest.approx(seconds, abs=2e-4)


@pytest.mark.parametrize(("opens", "shuts", "between"), [(0.3, 0.8, "both"), (0.6, 0.4, "none")])
def test_lands_that_overlap_meet_and_others_leave_the_pump_alone(opens: float, shuts: float, between: str):
    """Of three ways from P, at half of the travel: to the cylinder and to T, or to none."""
    valve = VALVE._replace(opens=opens, shuts=shuts)
    half = tandem_lands(0.5, valve)
    assert (half.p_a > 0.0) == (half.p_t > 0.0) == (between == "both")
    for s in (opens, -opens):
        assert max(tandem_lands(s, valve)[:4]) == pytest.approx(0.0, abs=1e-12)
    assert tandem_lands(1.0, valve) == pytest.approx(Lands(valve.area, valve.area, 0.0, 0.0, 0.0))
    assert tandem_lands(shuts, valve).p_t == 0.0
    assert tandem_lands(0.0, valve) == Lands(0.0, 0.0, 0.0, 0.0, valve.area)


def test_the_closed_centre_has_no_way_from_p_to_t():
    valve = valve_of(circuit())
    for s in (-1.0, -0.05, 0.0, 0.5):
        assert closed_centre_lands(s, valve).p_t == 0.0
    assert closed_centre_lands(0.05, valve) == Lands(0.0, 0.0, 0.0, 0.0, 0.0)
