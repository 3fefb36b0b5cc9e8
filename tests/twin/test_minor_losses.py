"""Losses of elbows and tees: the drop they make, what they conserve, and that they only take energy."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.plant import BAR, FRICTIONLESS, SMOOTH, TIGHT, circuit, pipes, run, states
from twin.circuit.block import observed
from twin.circuit.equilibrium import equilibrium
from twin.circuit.linear import jacobian, moving_point, to_vector
from twin.circuit.rates import vector_rates
from twin.circuit.state import flows, oil_in, pressures
from twin.circuit.step import Circuit
from twin.minor_losses import MinorLosses, loss_per_flow_squared, minor_drop, resist

NONE = {"kind": "none"}
FLOW = st.floats(-1e-3, 1e-3)


def lossy(zeta: float, **parts: Any) -> Circuit:
    """With the amplifiers of the default rig, whose step is compiled already; they change nothing but what is read."""
    return circuit(minor_losses=zetas(zeta), amplifier={"kind": "lag"}, **parts)


def zetas(zeta: float) -> dict[str, str | float]:
    return {"kind": "fitted"} | {f"pipe_{line}": zeta for line in range(1, 7)}


@pytest.mark.parametrize("zeta", [1.0, 20.0])
def test_a_steady_flow_loses_zeta_rho_half_v_squared_in_each_line(zeta: float):
    """A piston that rises steadily: more is lost between pump and chamber, of two lines and the port between."""

    smooth: dict[str, Any] = {"pump": SMOOTH, "seal": FRICTIONLESS, "cylinder": TIGHT}

    def lost(c: Circuit) -> tuple[float, float]:
        s = run(moving_point(c, 0.05, 1.0), 1.0, c, 0.2)
        p = pressures(s)
        return p.pump - p.tee, flows(s).line_1

    (plain, q_0), (more, q) = lost(circuit(minor_losses=NONE, **smooth)), lost(lossy(zeta, **smooth))
    speed = q / (math.pi / 4.0 * 0.011**2)
    assert 0.8 * q_0 < q < q_0
    assert more - plain * q / q_0 == pytest.approx(zeta * 0.5 * 878.0 * speed**2, rel=2e-3)


@given(st.lists(FLOW, min_size=12, max_size=12))
def test_losses_are_resistances_that_only_take_energy(flow: list[float]):
    losses = MinorLosses(*(1e10 * (line + 1) for line in range(6)))
    impedance = np.full(12, 3e9)
    resist(losses, np.array(flow), impedance)
    added = impedance - 3e9
    assert (added >= 0.0).all()
    assert added == pytest.approx([1e10 * (end // 2 + 1) * abs(q) for end, q in enumerate(flow)], rel=1e-6, abs=1e-5)
    assert all(minor_drop(losses, line, flow[line]) * flow[line] >= 0.0 for line in range(6))


@pytest.mark.parametrize("model", ["ends", "nodes", "lumped", "volume", "none"])
def test_oil_is_kept_whatever_is_lost(model: str):
    """With losses a hundred times the rig's, thrown open and shut: oil stored less pumped, relieved and returned."""
    c = lossy(300.0, **pipes(model=model))
    s = equilibrium(c, 0.1)
    start = oil_in(s)
    for reference in (1.0, -1.0, 0.0):
        s = run(s, reference, c, 0.2)
        kept = oil_in(s) - s.ledger.pumped + s.ledger.relieved + s.ledger.returned
        assert kept == pytest.approx(start, abs=1e-12 * observed(s, c)["oil_stored"] + 1e-15)
        assert max(map(abs, pressures(s))) < 400 * BAR


def test_a_start_over_a_tandem_centre_stays_at_rest():
    """The pump idles through lines with losses: the balance of the start is that of the step."""
    c = lossy(10.0, pump=SMOOTH, cylinder=TIGHT, valve={"kind": "switching"})
    start = equilibrium(c, 0.1)
    for s in states(start, 0.0, c, 0.05, every=100):
        assert pressures(s) == pytest.approx(pressures(start), rel=1e-6, abs=1.0)


def test_slopes_know_the_losses():
    """The Jacobian by hand against differences of the rates."""
    c = lossy(30.0, pump=SMOOTH, seal=FRICTIONLESS)
    point = to_vector(moving_point(c, 0.1, 0.6))
    slopes = jacobian(point, c, None)
    for j in range(9, 15):  # the flows
        above, below = point.copy(), point.copy()
        width = 1e-5 * abs(point[j]) + 1e-12
        above[j] += width
        below[j] -= width
        found = (vector_rates(above, 0.6, c) - vector_rates(below, 0.6, c)) / (2.0 * width)
        assert slopes[:, j] == pytest.approx(found, rel=1e-5, abs=1e-6 * np.abs(found).max())


def test_coefficient_of_a_pipe():
    """zeta 1 at 1 m/s in a pipe of 11 mm: rho/2 = 439 Pa."""
    flow = math.pi / 4.0 * 0.011**2
    assert loss_per_flow_squared(1.0, 0.011, 878.0) * flow**2 == pytest.approx(439.0)
