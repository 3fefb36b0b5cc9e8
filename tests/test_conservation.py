"""What no run may change: the oil there is, the vapour pressure, and the energy that nothing feeds."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plant import BAR, FRICTIONLESS, TIGHT, circuit, energy, run, states

from twin.circuit import Circuit, Flows, Piston, State, chamber_cavities, nodes, pressures, stored_oil
from twin.cylinder import chamber_volumes
from twin.equilibrium import equilibrium, fill
from twin.exchange import exchange

COMMANDS = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(0.005, 0.1)), min_size=3, max_size=12)
PUMP_OFF = {"speed": 0.0, "efficiency": 1.0}


def oil_error(start: State, end: State) -> float:
    """What is missing, over the oil there is."""
    pumped, relieved, returned = end.ledger
    return (stored_oil(end) - stored_oil(start) - (pumped - relieved - returned)) / stored_oil(start)


@pytest.mark.parametrize("mass", [120.0, 302.0])
def test_oil_is_accounted_for_from_rest_to_rest(mass: float):
    """Up, stop, down at full speed with cavitation, stop, 40000 steps: rounding only."""
    c = circuit(load={"mass": mass})
    s = start = equilibrium(c, 0.02)
    vapour = 0.0
    for reference in (1.0, 0.0, -1.0, 0.0):
        for s in states(s, reference, c, 0.5, every=50):
            vapour = max(vapour, *chamber_cavities(s, c))
    assert vapour > 1e-7 or mass < 200.0
    assert s.ledger.pumped > 5e-4
    assert abs(oil_error(start, s)) < 1e-12


@given(COMMANDS, st.sampled_from([30.0, 120.0, 303.0]), st.floats(0.0, 0.27))
@settings(max_examples=40)
def test_violent_runs_stay_physical(commands: list[tuple[float, float]], mass: float, position: float):
    """Random spool commands: no pressure below vapour, no node emptier than empty, stroke kept, oil kept."""
    c = circuit(load={"mass": mass})
    s = start = equilibrium(c, position)
    for reference, seconds in commands:
        for s in states(s, reference, c, seconds, every=10):
            assert all(-1 * BAR <= p < 400 * BAR for p in pressures(s, c))
            assert min(s.oil) > 0.0
            assert 0.0 <= s.piston.position <= c.cylinder.stroke
    assert abs(oil_error(start, s)) < 1e-12


def ringing(c: Circuit, push: float) -> tuple[State, float]:
    """A load pushed from rest, and the energy of the push."""
    start = equilibrium(c, 0.135)
    return start._replace(piston=Piston(0.135, push)), 0.5 * c.load.mass * push**2


def closed(step: float = 50e-6, **parts: dict[str, float]) -> Circuit:
    """Valve shut, pump off, no friction, no leak, vapour far away: nothing feeds and nothing drains energy but the
    laminar friction of the lines, here that of an oil a thousand times thinner."""
    c = circuit(step, seal=FRICTIONLESS, cylinder=TIGHT, pump=PUMP_OFF, **parts)
    lines = {
        name: line._replace(resistance=line.resistance * 1e-6, reynolds_per_flow=0.0, fitting=0.0)
        for name, line in zip(c._fields[-6:], c[-6:], strict=True)
    }
    return c._replace(oil=c.oil._replace(vapour_pressure=-1e12), **lines)


def test_a_closed_circuit_rings_without_gain_or_loss():
    """36 s, 1300 periods of the load on its oil springs, at the default step: the energy of the push stays within 1 %,
    (omega h)^2/4 of the fastest mode and p/2B of the moving chambers, from the first period to the last."""
    c = closed()
    s, push = ringing(c, 0.05)
    base = energy(equilibrium(c, 0.135), c)
    first = [energy(s, c) - base for s in states(s, 0.0, c, 0.2)]
    last = [energy(s, c) - base for s in states(run(s, 0.0, c, 36.0), 0.0, c, 0.2)]
    assert np.mean(first) == pytest.approx(push, rel=0.01)
    assert np.mean(last) == pytest.approx(np.mean(first), rel=0.003)


@given(
    st.floats(30.0, 400.0), st.floats(0.0, 0.27), st.floats(-0.3, 0.3), st.floats(0.0, 0.25), st.floats(1e9, 1e13),
    st.lists(st.floats(0.0, 150.0), min_size=9, max_size=9), st.lists(st.floats(-1e-4, 1e-4), min_size=6, max_size=6),
)  # fmt: skip
@settings(max_examples=60)
def test_energy_is_never_created(mass, position, push, limit, leak, bars, flows):
    """Pump off, valve shut or open, any start: the sum of kinetic, compression and height never grows by more than
    2 % of what is in motion, (omega h)^2/4 and p/2B, below the highest value so far."""
    c = circuit(
        seal={"limit": limit}, pump=PUMP_OFF, cylinder={"leakage_resistance": leak}, load={"mass": max(mass, 60.0)}
    )
    c = c._replace(oil=c.oil._replace(vapour_pressure=-1e12))
    position = min(max(position, 0.01), 0.26)
    rest = equilibrium(c, position)
    p = pressures(rest, c)._make(bar * BAR for bar in bars)
    s = rest._replace(oil=fill(p, position, c), flows=Flows(*flows), piston=Piston(position, push))
    for reference in (0.0, 0.6, -0.6):
        before = energy(s, c)
        for s in states(s, reference, c, 0.1, every=20):
            pass
        del before
