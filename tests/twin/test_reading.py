"""What is read off a recorded run: balances that vanish where their law holds, and moments."""

import math

import numpy as np
import pytest

from tests.support.plant import (
    BAR,
    SMOOTH,
    TIGHT,
    Array,
    circuit,
    joined,
    watched,
)
from twin.circuit.equilibrium import equilibrium
from twin.circuit.reading import (
    BALANCES,
    force_balance,
    moments,
    sink_balance,
    speed_balance,
)
from twin.circuit.state import pressures
from twin.circuit.step import Circuit
from twin.topology import BALANCE_UNITS

TIME = np.linspace(0.0, 0.1, 101)
C = circuit(load={"added": 183.0})
AREA = C.parts.cylinder.area_lower


def columns(**own: Array | float) -> dict[str, Array]:
    """A piston at rest under no pressure, but for some columns."""
    names = ("position", "velocity", "p_lower", "p_upper", "flow_pump", "flow_relief", "friction", "mass")
    return {name: np.zeros(TIME.size) + own.get(name, 0.0) for name in names}


def test_force_balance_in_pressure_on_the_annulus():
    """(A_l p_l - A_u p_u - m (g + x'') + F_f)/A_l: each term alone."""
    assert force_balance(TIME, columns(p_lower=5 * BAR), C) == pytest.approx(5 * BAR)
    assert force_balance(TIME, columns(p_upper=5 * BAR), C) == pytest.approx(-5 * BAR * 2500.0 / 1476.0)
    assert force_balance(TIME, columns(mass=302.0), C) == pytest.approx(-25.56 * BAR, rel=2e-4)  # PHYSICS sheet
    assert force_balance(TIME, columns(friction=-100.0), C) == pytest.approx(-100.0 / AREA)
    rising = columns(mass=120.0, velocity=2.0 * TIME)
    assert force_balance(TIME, rising, C) == pytest.approx(-120.0 * 11.81 / AREA)


def test_force_balance_knows_the_external_force():
    pushed = circuit(load={"force": 500.0})
    assert force_balance(TIME, columns(), pushed) == pytest.approx(500.0 / AREA)


def test_speed_balance_is_zero_at_the_speed_that_the_oil_gives():
    """26.7 l/min over the annulus are 0.384 m/s; what the relief valve and the leak take is missing."""
    flow, leak = 26.7e-3 / 60.0, 20 * BAR / 1.04e12
    rising = columns(velocity=0.384, flow_pump=flow)
    assert speed_balance(TIME, rising, C) == pytest.approx(0.0, abs=2e-4)
    lost = columns(velocity=(flow - 1e-4 - leak) / AREA, flow_pump=flow, flow_relief=1e-4, p_lower=20 * BAR)
    assert speed_balance(TIME, lost, C) == pytest.approx(0.0, abs=1e-12)


def test_sink_balance_is_zero_at_the_speed_of_the_leak():
    """0.785 mm/s with 120 kg over a cavity; in oil at reference density 1 + p_l/B more slowly."""
    p_lower, p_upper = 120.0 * 9.81 / AREA - BAR * 2500.0 / 1476.0, -BAR
    sinking = columns(velocity=-0.785e-3, p_lower=p_lower, p_upper=p_upper)
    assert sink_balance(TIME, sinking, C) == pytest.approx(0.0, abs=3e-6)


def test_balances_know_leaks_to_the_outside_and_oil_that_passes_a_motor():
    """20 bar over 2e12 Pa s/m^3 are 60 ml/min; 50 cm^3 a turn at 1 m are 8 mm^2, and no volume widens there."""
    drained, lost = circuit(cylinder=TIGHT | {"outside_lower": 2e12}), 60e-6 / 60.0
    p = columns(p_lower=20 * BAR)
    b = drained.parts.oil.bulk_modulus
    assert speed_balance(TIME, p, drained) == pytest.approx(lost / AREA, rel=1e-12)
    assert sink_balance(TIME, p, drained) == pytest.approx(lost / AREA / (1.0 + 20 * BAR / b), rel=1e-12)
    holed = circuit(cylinder=TIGHT | {"holes": "fitted", "hole_lower": 0.5e-3, "hole_transition": 0.0})
    torricelli = 0.61 * math.pi / 4.0 * 0.5e-3**2 * math.sqrt(2.0 * 20 * BAR / holed.parts.oil.density)
    assert speed_balance(TIME, p, holed) == pytest.approx(torricelli / AREA, rel=1e-9)
    motor = circuit(actuator={"kind": "motor"}, motor={"leakage_resistance": math.inf, "case_resistance": 2e12})
    assert sink_balance(TIME, p, motor) == pytest.approx(lost / (50e-6 / (2.0 * math.pi)), rel=1e-12)


def test_a_shaft_without_stops_meets_none():
    path = columns(position=np.minimum(0.27, 0.10 + 2.0 * TIME))
    assert math.isnan(moments(TIME, path, circuit(actuator={"kind": "motor"}))["impact"])


def test_every_balance_has_a_unit():
    assert set(BALANCES) == set(BALANCE_UNITS)


def test_moments_of_a_path():
    """Contact at 138 mm, impact within 0.1 mm of the top: at the first sample that is there."""
    path = columns(position=np.minimum(0.27, 0.10 + 2.0 * TIME))
    assert moments(TIME, path, C) == {"contact": pytest.approx(0.019), "impact": pytest.approx(0.085)}


@pytest.mark.parametrize(
    ("position", "added"),
    [(np.full(TIME.size, 0.1), 183.0), (np.full(TIME.size, 0.27), 183.0), (0.1 + TIME / 2.0, 0.0)],
)
def test_what_never_happened_or_was_so_from_the_start_has_no_moment(position: Array, added: float):
    """Neither reached; above both all along; no weight to meet."""
    found = moments(TIME, columns(position=position), circuit(load={"added": added}))
    assert math.isnan(found["contact"])
    assert math.isnan(found["impact"])


def rise() -> tuple[Array, dict[str, Array], Circuit]:
    """Half a second at rest, up past the weight into the top, a sample per millisecond."""
    c = circuit(pump=SMOOTH, load={"added": 183.0})
    still, s = watched(equilibrium(c, 0.05), 0.0, c, 0.1, every=20)
    moving, _ = watched(s, 1.0, c, 0.9, every=20)
    seen = joined(still, moving)
    return np.linspace(1e-3, 1.0, 1000), seen, c


def test_balances_and_moments_of_a_run():
    """Settled, 100 to 20 ms before the top: the mean force to 0.1 bar of 25, the mean speed to 1 % of 0.38 m/s.

    The moments against the path: the weight is met before it is carried, and at the impact the piston is at the top.
    """
    time, seen, c = rise()
    at = moments(time, seen, c)
    assert seen["position"][np.searchsorted(time, at["contact"]) - 2] < 0.138
    carried = time[np.argmax(seen["mass"] > 120.0)]
    assert at["contact"] <= carried <= at["contact"] + 10e-3
    assert seen["position"][np.searchsorted(time, at["impact"] - 1e-9)] >= 0.27 - 1e-4
    window = (time > at["impact"] - 0.1) & (time < at["impact"] - 0.02)
    assert abs(force_balance(time, seen, c)[window].mean()) < 0.1 * BAR
    assert abs(speed_balance(time, seen, c)[window].mean()) < 0.01 * seen["velocity"][window].mean()


def test_sink_balance_of_a_held_load():
    """Ten seconds after the valve has shut the upper chamber is empty; the mean over two more to 0.5 % of 0.8 mm/s."""
    c = circuit(pump=SMOOTH, seal={"limit": 0.0})
    _, s = watched(equilibrium(c, 0.2), 0.0, c, 10.0, every=2000)
    seen, end = watched(s, 0.0, c, 2.0, every=20)
    assert pressures(end).upper == -BAR
    balance = sink_balance(np.linspace(0.0, 2.0, 2000), seen, c)
    assert abs(balance.mean()) < 0.005 * abs(seen["velocity"].mean())
    tight = circuit(pump=SMOOTH, cylinder=TIGHT)
    held, _ = watched(equilibrium(tight, 0.2), 0.0, tight, 0.5, every=20)
    assert sink_balance(np.linspace(0.0, 0.5, 500), held, tight) == pytest.approx(0.0, abs=1e-9)
