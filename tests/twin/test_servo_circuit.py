"""The circuit with a servo valve: where it rests, what it passes there, its slopes, oil, and Radau on its rates."""

import math
from typing import Any

import numpy as np
import pytest

from tests.support.plant import BAR, FRICTIONLESS, SMOOTH, TIGHT, circuit, load_of, pipes, run, watched
from twin.actuator import outside
from twin.circuit.block import advance
from twin.circuit.equilibrium import equilibrium, supply_at_rest
from twin.circuit.linear import edge_point, jacobian, linearise, moving_point, to_vector
from twin.circuit.open_centre import laws_at_rest, passed, steady_lands
from twin.circuit.rates import STATES, vector_rates
from twin.circuit.state import oil_in, pressures
from twin.circuit.step import Circuit
from twin.cylinder import Chambers
from twin.integration import integrate
from twin.lands import Lands
from twin.load_at_rest import held_force
from twin.rig import values
from twin.rig_servo import LANDS
from twin.servo_valve import FORCE

SIZES = np.array([1e5] * 9 + [1e-4] * 6 + [0.1, 0.1, 0.1, 10.0])
VAPOUR = -1.0 * BAR


def servo(step: float = 50e-6, lap: float = 0.0, parts: dict[str, Any] | None = None, **numbers: Any) -> Circuit:
    """The rig of the tests with a servo valve; smooth pump, no friction."""
    valve = {f"overlap_{land}": lap for land in LANDS} | numbers
    fitted = {"pump": SMOOTH, "seal": FRICTIONLESS} | (parts or {})
    return circuit(step, valve={"kind": "servo"}, servo_valve=valve, **fitted)


CASES = {
    "leak": {},
    "underlap": {"lap": -0.02, "leakage": 0.0},
    "2:1, table, force": {
        "lap": -0.01,
        "ratio_p_a": 0.5,
        "ratio_a_t": 0.5,
        "opening": "table",
        "table": ((0.0, 0.0), (0.3, 0.1), (1.0, 1.0)),
        "flow_force": 0.1,
        "null_bias": 0.01,
    },
    "first order": {"dynamics": "first-order", "flow_force": 0.1},
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("spool", [0.004, 0.3, -0.1])
def test_jacobian_is_the_derivative_of_the_rates(case: str, spool: float):
    """Central differences of 1e-5 of each state's size, as for the proportional valve, through null too."""
    c = servo(**CASES[case])
    y = to_vector(moving_point(c, 0.135, spool, 2000.0))
    differences = np.empty((19, 19))
    for column, size in enumerate(SIZES * 1e-5):
        d = np.eye(19)[column] * size
        differences[:, column] = vector_rates(y + d, spool, c, 2000.0) - vector_rates(y - d, spool, c, 2000.0)
    differences /= 2e-5
    analytic = jacobian(y, c, None, 2000.0) * SIZES
    scale = np.abs(analytic).max(axis=1, keepdims=True)
    np.testing.assert_allclose(differences / scale, analytic / scale, atol=1e-5)


@pytest.mark.parametrize(("edge", "ratio"), [("+", 0.5), ("-", 2.0)])
def test_edge_point_of_asymmetric_lands(edge: str, ratio: float):
    """Lands of A half as wide: p_u = (r A_u/A_l)^2 (p_P - p_l) upwards, r the ratio; the load carried."""
    c = servo(ratio_p_a=0.5, ratio_a_t=0.5, leakage=0.0)
    p, cylinder = pressures(edge_point(c, 0.1, edge)), c.parts.cylinder
    weight = cylinder.area_lower * p.lower - cylinder.area_upper * p.upper
    assert weight == pytest.approx(load_of(c).mass * load_of(c).gravity, abs=1e-3)
    areas = cylinder.area_upper / cylinder.area_lower
    found = p.upper / (p.p - p.lower) if edge == "+" else p.lower / (p.p - p.upper)
    assert found == pytest.approx((ratio * (areas if edge == "+" else 1.0 / areas)) ** 2, rel=1e-9)


def test_an_overlapped_valve_has_no_slope_inside():
    c = servo(lap=0.05, leakage=0.0)
    with pytest.raises(ValueError, match=r"spool 0\.03 lies inside the overlap, \+-0\.05; take it further out"):
        moving_point(c, 0.1, 0.03)


def test_linear_valve_is_that_of_its_data_sheet():
    """From the command to the spool: second order, and first order by its time constant."""
    second, first = servo(natural_frequency=80.0, damping=0.6), servo(dynamics="first-order", time_constant=3e-3)
    for c, sheet in (
        (second, lambda s: (160.0 * math.pi) ** 2 / (s**2 + 1.2 * 160.0 * math.pi * s + (160.0 * math.pi) ** 2)),
        (first, lambda s: 1.0 / (1.0 + 3e-3 * s)),
    ):
        system = linearise(moving_point(c, 0.1, 0.05), None, circuit=c)
        for hertz in (5.0, 80.0):
            s = 2j * math.pi * hertz
            x = np.linalg.solve(s * np.eye(19) - system.A, np.asarray(system.B)[:, 0])[STATES.index("spool")]
            assert x == pytest.approx(sheet(s), rel=1e-9)


def test_supply_feeds_what_the_valve_lets_through_at_rest():
    """Underlap of 5 %: as much as two lands in series pass between P and T, and the supply sees it as flow."""
    c = servo(lap=-0.05, leakage=0.0)
    supply, laws = supply_at_rest(c), laws_at_rest(c)
    p = pressures(equilibrium(c, 0.1))
    assert laws is not None
    assert supply.idle == pytest.approx(passed(p.p - p.t, laws), rel=1e-6)
    rated, sheet = values()["servo_valve"]["rated_flow"], values()["servo_valve"]["rated_drop"]
    turbulent = 2.0 * rated * (0.05 / 1.05) * math.sqrt((p.p - p.t) / sheet)
    assert supply.idle == pytest.approx(turbulent, rel=0.1)  # lands between laminar and turbulent
    shut = servo(leakage=0.0)
    assert (supply_at_rest(shut).idle, laws_at_rest(shut)) == (0.0, None)


@pytest.mark.parametrize("step", [50e-6, 100e-6])
@pytest.mark.parametrize(("lap", "leakage"), [(-1e-3, 0.0), (0.0, 1e-5), (-0.02, 1e-5)])
def test_a_held_drive_stays_put(step: float, lap: float, leakage: float):
    """1 um of underlap in 1 mm too, at both steps: it sinks by what the balance of the lands makes, as the
    equations without steps say, but for a swing of the load on its oil about that."""
    c = servo(step, lap, leakage=leakage)
    start = equilibrium(c, 0.1)
    end = run(start, 0.0, c, 0.3)
    assert np.array(pressures(end)) == pytest.approx(np.array(pressures(start)), abs=0.6 * BAR)
    drift = moving_point(c, 0.1, 0.0).piston.velocity
    assert end.piston.position - 0.1 == pytest.approx(0.3 * drift, abs=1e-4)
    assert abs(drift) < 5e-3


@pytest.mark.parametrize("step", [50e-6, 100e-6])
def test_oil_is_kept_and_no_pressure_falls_below_vapour(step: float):
    """A spool thrown about, through cavities: stored less pumped, relieved and returned, over the oil there was."""
    c = servo(step, -1e-3, hysteresis=0.02, threshold=0.004, delay=1.5e-3, flow_force=0.1)
    state, lowest = equilibrium(c, 0.13), 0.0
    before = oil_in(state) + c.parts.line_volume
    for reference in (1.0, -1.0, 0.02, -0.6, 0.0):
        seen, state = watched(state, reference, c, 0.06)
        lowest = min(lowest, *(seen[name].min() for name in seen if name.startswith("p_") or name in ("p1", "p2")))
    ledger = state.ledger
    after = oil_in(state) + c.parts.line_volume - (ledger.pumped - ledger.relieved - ledger.returned)
    assert after == pytest.approx(before, rel=1e-13)
    assert lowest >= VAPOUR - 1e-6


@pytest.mark.parametrize(
    ("case", "reference", "close"),
    [({"lap": -0.01, "leakage": 1e-5}, 0.03, 1e-4), ({"lap": 0.0, "flow_force": 0.2}, 0.3, 5e-3)],
)
def test_scheme_agrees_with_radau_on_the_rates(case: dict[str, Any], reference: float, close: float):
    """40 ms at 5 us, lumped lines: in bar, dm, dm/s. The flow force is of the instant before, of first order."""
    parts = {**pipes(model="lumped"), "relief": {"kind": "none"}, "filter": {"drop": 0.0}}
    parts["two_position_valve"] = {"drop": 0.0}
    c = servo(5e-6, parts=parts, **case)
    s = moving_point(c, 0.1, reference - 0.01)
    reference -= s.slots.valve[FORCE]
    radau = integrate(
        lambda _, y: vector_rates(y * SIZES, reference, c) / SIZES,
        (0.0, 0.04), to_vector(s) / SIZES, "Radau", most=100_000, rtol=1e-9, atol=1e-11, max_step=2e-3,
    )  # fmt: skip
    end = radau.y[:, -1]
    found = to_vector(advance(s, reference, c, 8000)) / SIZES
    places = [*range(9), *range(15, 18)]
    assert np.abs(found - end)[places].max() < close


def test_power_off_and_words():
    """A tight cylinder behind a valve without lap and leak holds as it did: p_u as given."""
    c = servo(leakage=0.0, parts={"cylinder": TIGHT})
    assert pressures(equilibrium(c, 0.1, 3 * BAR)).upper == 3 * BAR


@pytest.mark.parametrize("cylinder", [{}, {"rod_at": "both", "outside_lower": 2e12}])
def test_chambers_at_rest_are_filled_and_emptied_by_one_speed(cylinder: dict[str, Any]):
    """Lands, the leak across the piston and those to the outside; the load is carried."""
    c = servo(lap=-0.005, parts={"cylinder": cylinder})
    p, actuator = pressures(equilibrium(c, 0.1)), c.parts.cylinder
    drop = Lands(p.p - p.a, p.b - p.t, p.p - p.b, p.a - p.t, 0.0)
    q, leak = steady_lands(drop, 0.0, c), actuator.leakage * (p.lower - p.upper)
    drains = outside(actuator, Chambers(p.lower, p.upper))
    rises = (q.p_a - q.a_t - leak - drains.lower * p.lower) / actuator.area_lower
    sinks = (q.p_b - q.b_t + leak - drains.upper * p.upper) / actuator.area_upper
    assert rises == pytest.approx(-sinks, rel=1e-6)
    assert actuator.area_lower * p.lower - actuator.area_upper * p.upper == pytest.approx(held_force(c.parts.load, 0.1))
