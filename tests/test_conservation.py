"""What no run may change: the oil there is, the vapour pressure, and the energy that nothing feeds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.plant import BAR, FRICTIONLESS, TIGHT, circuit, energy, run, states
from twin.circuit import (
    Circuit,
    Flows,
    Ledger,
    Piston,
    Pressures,
    Spool,
    State,
    chamber_cavities,
    pressures,
    stored_oil,
)
from twin.equilibrium import equilibrium, fill

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
        *seen, s = states(s, reference, c, 0.5, every=50)
        vapour = max(vapour, *(cavity for each in seen for cavity in chamber_cavities(each, c)))
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
        for each in states(s, reference, c, seconds, every=10):
            assert all(-1 * BAR <= p < 400 * BAR for p in pressures(each, c))
            assert min(each.oil) > 0.0
            assert 0.0 <= each.piston.position <= c.cylinder.stroke
        s = run(s, reference, c, seconds)
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
    mass=st.floats(60.0, 400.0),
    position=st.floats(0.01, 0.26),
    push=st.floats(-0.3, 0.3),
    limit=st.sampled_from([0.0, 0.1, 0.25]),
    leak=st.floats(9.0, 13.0),
    bars=st.lists(st.floats(0.0, 150.0), min_size=9, max_size=9),
    flows=st.lists(st.floats(-1e-4, 1e-4), min_size=6, max_size=6),
    reference=st.sampled_from([0.0, 0.6, -0.6]),
)
@settings(max_examples=40)
def test_energy_is_never_created(mass, position, push, limit, leak, bars, flows, reference):
    """Pump off, any start: kinetic energy, compression and height together never rise above their lowest value so far
    by more than 0.1 % of what was in motion: (omega h)^2/4 of the load on its oil springs is 0.004 %, p/2B 0.3 %."""
    c = circuit(seal={"limit": limit}, pump=PUMP_OFF, cylinder={"leakage_resistance": 10.0**leak}, load={"mass": mass})
    c = c._replace(oil=c.oil._replace(vapour_pressure=-1e12))
    p = Pressures(*(bar * BAR for bar in bars))
    piston, spool = Piston(position, push), Spool(reference, 0.0)
    start = State(fill(p, position, c), Flows(*flows), piston, spool, Ledger(0.0, 0.0, 0.0))
    lowest = energy(start, c)
    allowed = 1e-3 * (lowest - mass * 9.81 * position) + 1e-6
    for s in states(start, reference, c, 0.15, every=10):
        now = energy(s, c)
        assert now <= lowest + allowed
        lowest = min(now, lowest)


def test_rest_is_left_where_it_is():
    """A second at rest moves no oil but rounding."""
    c = closed()
    start = equilibrium(c, 0.135)
    assert max(abs(a - b) for a, b in zip(run(start, 0.0, c, 1.0).oil, start.oil, strict=True)) < 1e-15
