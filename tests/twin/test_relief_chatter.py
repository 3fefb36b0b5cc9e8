"""The relief valve with compressible oil before its pilot, and with a long pilot seat: theory, motion, the rig."""

import math

import numpy as np
import pytest

from bridge.figures.valve.spectrum import (
    heard,
    theory,
)
from tests.support.plant import relief_of
from tests.support.relief_valve import (
    BAR,
    FLOW,
    IMPEDANCE,
    SHEET_OIL,
    valve,
)
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.housing import (
    reaction,
    shake,
    spectrum,
    thrust,
)
from twin.kernel import allocating_kernel
from twin.relief.channel import CompressibleOil
from twin.relief.long_seat import LongSeat, long_area, long_conductance, long_damping
from twin.relief.main_stage import main_opening
from twin.relief.motion import Motion, begin
from twin.relief.pilot_theory import chatter_volumes, swing, valve_matrix
from twin.relief.poppet import (
    cracking_pressure,
    pilot_opening,
    poppet_drag,
)
from twin.relief.seat import is_laminar, laminar_conductance
from twin.relief.steady import (
    precompression_for,
    rest,
    steady_flow,
    steady_pressure,
)
from twin.relief.valve import Relief, step_valve
from twin.rig import values
from twin.seats import conical, film
from twin.seats.conical import ConicalSeat

SEAT = ConicalSeat(2.8e-3, 3.21e-3, math.radians(21.0), 878.0 * 40e-6)
STEP = 6.25e-6
CM3 = 1e-6


def set_to(bar: float, **numbers: float | str) -> Relief:
    return valve(**numbers, pilot_precompression=precompression_for(bar * BAR, FLOW, valve(**numbers)))


@allocating_kernel
def lifts(m: Motion, c: float, z: float, step: float, v: Relief, count: int) -> np.ndarray:
    """Rows of lift and speed of the poppet, flow, what fills the oil, p2."""
    rows = np.empty((count, 5))
    for k in range(count):
        m, _ = step_valve(m, c, c, z, v, step)
        p2 = m.y * abs(m.y) if not is_laminar(v.pilot.seat) and m.state.pilot_lift > 0.0 else m.y
        rows[k, 0], rows[k, 1], rows[k, 2] = m.state.pilot_lift, m.state.pilot_velocity, m.flow
        rows[k, 3], rows[k, 4] = m.filling, p2
    return rows


def swung(v: Relief, pressure: float, z: float, seconds: float, push: float, step: float = STEP) -> np.ndarray:
    at, q = rest(pressure, v), steady_flow(pressure, v)
    m = begin(at._replace(pilot_lift=at.pilot_lift * (1.0 + push)), pressure, q, v)
    return lifts(m, pressure + z * q, z, step, v, round(seconds / step))


@pytest.mark.parametrize("x", [2e-5, 1e-4, 4e-4])
def test_the_long_seat_is_the_conical_one_per_pressure(x: float):
    v = valve(pilot_seat="conical")
    p, long = 7 * BAR, v.pilot.seat
    assert isinstance(long, LongSeat)
    assert laminar_conductance(v.pilot.seat, x) * p == pytest.approx(conical.flow(x, p, 0.0, SEAT), rel=1e-12)
    force = conical.pressure_force(x, p, 0.0, 0.0, SEAT) + SEAT.cosine * conical.shear_force(x, p, 0.0, SEAT)
    assert pilot_opening(x, v.pilot) == (0.0, pytest.approx(force / p, rel=1e-11))
    damping = film.film_damping(x, SEAT) + conical.shear_damping(x, SEAT)
    assert poppet_drag(x, v.pilot) - v.pilot.drag == pytest.approx(damping, rel=0.025)
    assert long_damping(1e-9, long) == long_damping(5e-6, long)
    assert long_area(0.0, long) == pytest.approx(long_area(1e-8, long), rel=1e-4) == v.pilot.shut_area
    assert long_conductance(2.0 * x, long) / long_conductance(x, long) == pytest.approx(8.0, rel=0.2)


def test_with_a_long_seat_the_valve_holds_its_setting():
    v = set_to(67.0, pilot_seat="conical")
    assert steady_pressure(FLOW, v) / BAR == pytest.approx(67.0, abs=1e-6)
    assert cracking_pressure(v.pilot) < 67 * BAR
    assert 5e-5 < rest(67 * BAR, v).pilot_lift < 2e-4  # the chamfered one: 12 um


def test_the_matrix_is_the_slope_of_the_equations():
    """The five rates by hand from the parts' laws, differenced at rest with an inlet of given impedance."""
    v, p, z = set_to(150.0, channel_volume=2 * CM3), 150 * BAR, IMPEDANCE
    at, q = rest(p, v), steady_flow(p, v)
    c, o, main = p + z * q, v.orifices, v.main
    assert isinstance(v.channel, CompressibleOil)
    capacity = v.channel.capacity

    def rates(y: np.ndarray) -> np.ndarray:
        x, u, p2, lift, speed = y
        seat = main_opening(lift, main)
        low, high, inlet, q1 = 0.5 * p, 1.5 * p, p, 0.0
        for _ in range(80):
            inlet = 0.5 * (low + high)
            drop = inlet - p2
            q1 = 2.0 * drop / (o.b_12 + math.sqrt(o.b_12**2 + 4.0 * o.a_12 * abs(drop)))
            drawn = seat.conductance * math.sqrt(inlet) + q1 + main.area * speed
            low, high = (inlet, high) if inlet < c - z * drawn else (low, inlet)
        conductance, area = pilot_opening(x, v.pilot)
        pilot = area * p2 - v.pilot.preload - v.pilot.stiffness * x - v.pilot.drag * u
        filling = q1 + main.area * speed - conductance * math.sqrt(p2) - v.pilot.area * u
        p3 = p2 + (o.a_3 * abs(main.area * speed) + o.b_3) * main.area * speed
        drag = main.film + main.surge * math.sqrt(inlet)
        spool = seat.area * inlet - main.area * p3 - main.preload - main.stiffness * lift - drag * speed
        return np.array([u, pilot / v.pilot.mass, filling / capacity, speed, spool / main.mass])

    start = swing(p, z, v)
    y = np.array([at.pilot_lift, 0.0, start.pressure, at.spool_lift, 0.0])
    scale = np.array([1e-5, 1e-2, 1e6, 1e-4, 1e-2])
    columns = [(rates(y + 1e-4 * d) - rates(y - 1e-4 * d)) / 2e-4 for d in np.diag(scale)]
    size = np.abs(valve_matrix(p, z, v) * scale) + 1e-12
    found = np.abs(np.array(columns).T - valve_matrix(p, z, v) * scale)
    assert (found <= 1e-4 * size.max(axis=1, keepdims=True)).all()


SPOOL_SHUT = [(148.0, 150.0, 0.0, 0.3), (148.0, 150.0, 0.0, 0.5), (148.0, 150.0, 0.0, 3.0)]
SPOOL_OPEN = [(67.0, 67.0, IMPEDANCE, 1.0), (67.0, 67.0, IMPEDANCE, 10.0), (150.0, 150.0, IMPEDANCE, 3.0)]


@pytest.mark.parametrize(("bar", "setting", "z", "volume"), [*SPOOL_SHUT, *SPOOL_OPEN])
def test_what_chatters_in_theory_chatters_and_what_does_not_dies(bar: float, setting: float, z: float, volume: float):
    """Growth of a swing of parts in 1e5 against the eigenvalue, both signs; in steps of 6.25 us omega h = 0.07."""
    v = set_to(setting, channel_volume=volume * CM3)
    found = swing(bar * BAR, z, v)
    seconds = min(20e-3, 3.0 / abs(found.growth))
    x = swung(v, bar * BAR, z, seconds, 1e-5 if found.growth > 0.0 else 1e-2)[:, 0]
    third = len(x) // 3
    first, last = (1, 2) if found.growth > 0.0 else (0, 1)
    sizes = [np.ptp(x[k * third : (k + 1) * third]) for k in (first, last)]
    growth = math.log(sizes[1] / sizes[0]) / (third * STEP)
    assert growth * found.growth > 0.0
    assert growth == pytest.approx(found.growth, rel=0.2, abs=15.0)


def test_the_frequency_is_that_of_theory():
    v = set_to(67.0, channel_volume=10 * CM3)
    x = swung(v, 67 * BAR, IMPEDANCE, 20e-3, 1e-4)[:, 0]
    x = x - x.mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    at = up + x[up] / (x[up] - x[up + 1])
    found = (len(at) - 1) / ((at[-1] - at[0]) * STEP)
    assert found == pytest.approx(swing(67 * BAR, IMPEDANCE, v).frequency, rel=2e-3)


def test_theory_says_which_volumes_chatter():
    """The spool shut: from half a cm^3. Its edges are roots of the growth."""
    v = set_to(150.0, channel_volume=CM3)
    low, high = chatter_volumes(148 * BAR, 0.0, SHEET_OIL.bulk_modulus, v) or (0.0, 0.0)
    assert low == pytest.approx(0.4734 * CM3, rel=1e-3)
    assert high > 1e-3
    for volume in (low, high):
        at = v._replace(channel=CompressibleOil(volume / SHEET_OIL.bulk_modulus))
        assert abs(swing(148 * BAR, 0.0, at).growth) < 1e-3
    assert chatter_volumes(67 * BAR, IMPEDANCE, 1.17e9, set_to(67.0, pilot_seat="conical", channel_volume=CM3)) is None


def test_the_oil_before_the_pilot_is_kept():
    """C (p2 - p2_0) is the integral of what fills it, by the rule that the step uses: to rounding."""
    v = set_to(150.0, channel_volume=3 * CM3)
    rows = swung(v, 150 * BAR, IMPEDANCE, 10e-3, 0.05)
    filled = 0.5 * STEP * (rows[1:, 3] + rows[:-1, 3]).cumsum()
    assert isinstance(v.channel, CompressibleOil)
    assert v.channel.capacity * (rows[1:, 4] - rows[0, 4]) == pytest.approx(filled, abs=1e-9 * np.abs(filled).max())


def test_a_long_seat_quietens_the_pilot():
    """Where the chamfered one chatters up to its seat the other dies within a few turns."""
    for seat, sign in (("chamfered", 1.0), ("conical", -1.0)):
        v = set_to(150.0, channel_volume=3 * CM3, pilot_seat=seat)
        assert sign * swing(150 * BAR, IMPEDANCE, v).growth > 0.0
        x = swung(v, 150 * BAR, IMPEDANCE, 60e-3, 0.02)[:, 0]
        late = np.ptp(x[-1000:]) / rest(150 * BAR, v).pilot_lift
        assert late > 1.0 if seat == "chamfered" else late < 1e-4


def test_theory_refuses_what_it_has_not():
    with pytest.raises(ValueError, match=r"relief\.channel_volume above 0"):
        swing(67 * BAR, 0.0, set_to(67.0))
    with pytest.raises(ValueError, match="the pilot is shut"):
        swing(40 * BAR, 0.0, set_to(67.0, channel_volume=CM3))
    with pytest.raises(ValueError, match="needs 10000 of them"):
        spectrum(np.zeros(100), 25e-6)


@pytest.mark.endurance
@pytest.mark.timeout(300)
def test_in_the_rig_the_housing_hears_the_chattering_pilot_alone():
    """Without ripple, 67 bar, 20 cm^3: on its seat a little above the frequency of theory. The conical
    pilot is 1000 times as quiet; with the valve shut nothing moves."""
    chamfered, long, shut = (heard(case, False) for case in ("chamfered pilot", "conical pilot", "valve shut"))
    peak = chamfered.frequency[100:][chamfered.bodies[100:].argmax()]
    assert 1.0 < peak / theory("chamfered pilot")[1] < 1.18
    assert chamfered.run.pilot_lift.min() < 1e-8  # [m], on its seat between two steps
    assert theory("conical pilot")[0] < 0.0
    assert chamfered.bodies[100:].max() > 1000.0 * long.bodies[100:].max()
    assert not shut.bodies.any()


def test_a_housing_takes_what_the_bodies_give():
    """Momentum: the mean acceleration over a run is the change of the bodies' momentum, and a sine has its rms."""
    circuit = build(values({"relief": {"channel_volume": 10 * CM3}}), 25e-6)
    found = shake(equilibrium(circuit, 0.1), circuit, 10e-3)
    v = relief_of(circuit)
    a = reaction(found, v, 8.0)
    momentum = v.pilot.mass * found.pilot_speed + v.main.mass * found.spool_speed
    assert a.sum() * found.step * 8.0 == pytest.approx(-(momentum[-1] - momentum[0]), rel=1e-9)
    assert thrust(found, 1e-4, 8.0).mean() == pytest.approx(0.0, abs=1e-9)
    time = 25e-6 * np.arange(20000)
    frequency, rms = spectrum(3.0 * np.sin(2.0 * math.pi * 1000.0 * time), 25e-6)
    assert frequency[1] == 4.0
    assert frequency[-1] == 1e4
    assert rms[250] == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-6)
