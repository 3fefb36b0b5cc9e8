"""Energy that nothing feeds: it is never created, not by the scheme and not by the lines.

The circuit's oil is in `tests/twin/test_conservation.py`.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.plant import (
    BAR,
    FRICTIONLESS,
    TIGHT,
    circuit,
    energy,
    load_of,
    pipes,
    run,
    states,
    watched,
)
from twin.circuit.equilibrium import equilibrium, state_at
from twin.circuit.limits import oil_spring
from twin.circuit.state import Flows, Pressures
from twin.circuit.step import Circuit, Piston, Spool

MODELS = ("ends", "nodes", "lumped", "volume", "none")
VALVES = ("proportional", "switching")
PUMP_OFF = {"speed": 0.0, "efficiency": 1.0}
UNFITTED = {"filter": {"drop": 0.0}, "two_position_valve": {"drop": 0.0}, "relief": {"kind": "none"}}


def closed(step: float = 50e-6, **parts: dict) -> Circuit:
    """Valve shut, pump off, no friction, no leak, no cavities, no relief valve: nothing feeds and nothing drains."""
    bare = {"oil": {"cavitation": "none"}, "seal": FRICTIONLESS, "cylinder": TIGHT, "pump": PUMP_OFF}
    return circuit(step, **(pipes(model="lumped", friction="none") | UNFITTED | bare | parts))


def test_a_closed_circuit_rings_without_gain_or_loss():
    """36 s, a thousand periods of the load on its oil: the energy of a push of 50 mm/s stays within 1 %, (omega h)^2/4
    of the fastest mode and p/2B of the moving chambers, from the first period to the last."""
    c = closed()
    rest, push = equilibrium(c, 0.135), 0.5 * load_of(c).mass * 0.05**2
    pushed, base = rest.with_core(piston=Piston(0.135, 0.05)), energy(rest, c)
    first = [energy(s, c) - base for s in states(pushed, 0.0, c, 0.2)]
    last = [energy(s, c) - base for s in states(run(pushed, 0.0, c, 36.0), 0.0, c, 0.2)]
    assert np.mean(first) == pytest.approx(push, rel=0.01)
    assert np.mean(last) == pytest.approx(np.mean(first), rel=0.003)


@given(
    mass=st.floats(60.0, 400.0),
    position=st.floats(0.01, 0.26),
    push=st.floats(-0.3, 0.3),
    limit=st.sampled_from([0.0, 0.1, 0.25]),
    leak=st.floats(9.0, 13.0),
    bars=st.lists(st.floats(0.0, 150.0), min_size=9, max_size=9),
    through=st.lists(st.floats(-1e-4, 1e-4), min_size=4, max_size=4),
    reference=st.sampled_from([0.0, 0.6, -0.6]),
    valve=st.sampled_from(VALVES),
)
@settings(max_examples=30)
def test_energy_is_never_created(mass, position, push, limit, leak, bars, through, reference, valve):
    """Pump off, lumped lines with friction, any start: kinetic energy, compression and height together never rise above
    their lowest value so far by more than 0.1 % of what was in motion, or comes into it as the weight finds its oil
    spring: (omega h)^2/4 of that swing is 0.004 %, p/2B 0.3 %."""
    c = closed(
        seal={"limit": limit}, cylinder={"leakage_resistance": 10.0**leak}, load={"mass": mass}, valve={"kind": valve},
        **pipes(model="lumped", friction="quasi-steady"),
    )  # fmt: skip
    p = Pressures(*(bar * BAR for bar in bars))
    supply, up, down, back = through
    flows = Flows(supply, supply, up, down, back, back)
    made = state_at(p, flows, Piston(position, push), Spool(reference, 0.0), c)
    start = run(made, reference, c, c.parts.step)  # a flow towards a shut land is cut off within the first step
    lowest = energy(start, c)
    sag = (mass * 9.81) ** 2 / oil_spring(c, position)
    allowed = 1e-3 * (lowest - mass * 9.81 * position + sag)
    for s in states(start, reference, c, 0.15, every=10):
        now = energy(s, c)
        assert now <= lowest + allowed
        lowest = min(now, lowest)


@pytest.mark.parametrize("model", MODELS)
def test_no_line_gives_more_work_than_it_has_taken(model: str):
    """From rest at even pressures, work at both ends beyond that of the pressure at rest is never negative, whatever
    the circuit does: the pump runs up, the valve is thrown, cavities open, the relief valve works.

    Each line is passive by itself, so the whole is, for components meet at the ends only. 1e-12: rounding.
    """
    c = circuit(pump={"run_up": 0.1}, **pipes(model=model))
    s = start = equilibrium(c, 0.1)
    assert not start.ends.flow.any()
    pressure, flow = [], []
    for reference in (0.0, 1.0, -1.0, 0.3, -1.0, 0.0):
        seen = list(states(s, reference, c, 0.15))
        pressure += [each.ends.pressure - start.ends.pressure for each in seen]
        flow += [each.ends.flow for each in seen]
        s = seen[-1]
    power = (np.array(pressure) * np.array(flow)).reshape(len(flow), -1, 2)[:, :6]
    work = c.parts.step * power.sum(axis=2).cumsum(axis=0)
    turned = c.parts.step * np.abs(power).sum(axis=(0, 2))
    assert (turned > 0.01).all()  # [J]; over 1 J with waves, which a volume at the tank does not have
    assert (work.min(axis=0) >= -1e-12 * turned).all()


@pytest.mark.parametrize("model", MODELS[:3])  # of one volume: no friction, so nothing comes to rest
@pytest.mark.parametrize("mass", [60.0, 303.0])
def test_a_push_never_grows_and_comes_to_rest(model: str, mass: float):
    """Pump off, valve shut, no seal: what holds the load starts even, so the push is all there is to swing with.

    Its speed is never exceeded, but by p/2B, 0.3 %; friction of the oil alone leaves less than a quarter after 6 s.
    With the seal the piston stands still after two.
    """
    still = {"pump": PUMP_OFF, "cylinder": TIGHT, "load": {"mass": mass}, "oil": {"cavitation": "none"}}
    c = circuit(seal=FRICTIONLESS, **still, **pipes(model=model))
    pushed = equilibrium(c, 0.135).with_core(piston=Piston(0.135, 0.1))
    first, s = watched(pushed, 0.0, c, 2.0)
    assert np.abs(first["velocity"]).max() <= 0.1 * 1.003
    last, _ = watched(run(s, 0.0, c, 4.0), 0.0, c, 1.0)
    assert np.abs(last["velocity"]).max() < 0.25 * 0.1
    sealed = circuit(**still, **pipes(model=model))
    assert run(equilibrium(sealed, 0.135).with_core(piston=Piston(0.135, 0.1)), 0.0, sealed, 2.0).piston.velocity == 0.0
