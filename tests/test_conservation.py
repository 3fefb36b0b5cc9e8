"""What no run may change: the oil there is, the vapour pressure, and the energy that nothing feeds."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.plant import BAR, FRICTIONLESS, SMOOTH, TIGHT, Array, circuit, energy, joined, pipes, run, states, watched
from twin.block import OBSERVED
from twin.circuit import LOWER, UPPER, Circuit, Piston, Spool
from twin.cylinder import Chambers, chamber_cavities, stored_oil
from twin.equilibrium import equilibrium, state_at
from twin.lines.bank import LUMPED, NODES, inner_cavity, profile
from twin.state import Flows, Pressures, State, oil_in, pressures

MODELS = ("ends", "nodes", "lumped")
VALVES = ("proportional", "switching")
COMMANDS = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(0.005, 0.1)), min_size=3, max_size=8)
PUMP_OFF = {"speed": 0.0, "efficiency": 1.0}
UNFITTED = {"filter": {"drop": 0.0}, "two_position_valve": {"drop": 0.0}, "relief": {"kind": "none"}}
VAPOUR = -1 * BAR
ROUNDING = 1e-6  # [Pa]
PLACES = np.linspace(0.2, 1.0, 17)  # in a line; the first segment of line 2 begins behind the filter, see below


def missing_oil(seen: dict[str, Array], start: State) -> Array:
    """What the books lack, over the oil there was, at every row."""
    stored, ledger = seen["oil_stored"], start.ledger
    crossed = seen["oil_pumped"] - seen["oil_relieved"] - seen["oil_returned"]
    crossed = crossed - (ledger.pumped - ledger.relieved - ledger.returned)
    return (stored - stored[0] - (crossed - crossed[0])) / stored[0]


def thrown(s: State, c: Circuit, commands: tuple[tuple[float, float], ...]) -> tuple[dict[str, Array], State]:
    """Every step of a run under commands (reference, seconds)."""
    parts = []
    for reference, seconds in commands:
        seen, s = watched(s, reference, c, seconds)
        parts.append(seen)
    return joined(*parts), s


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("valve", VALVES)
def test_oil_is_accounted_for_at_every_step(model: str, valve: str):
    """Up past the weight into the top, shut, down with cavities onto the bottom, shut: rounding only, 30000 steps."""
    c = circuit(valve={"kind": valve}, load={"added": 183.0}, **pipes(model=model))
    start = equilibrium(c, 0.05)
    seen, _ = thrown(start, c, ((1.0, 0.75), (0.0, 0.05), (-1.0, 0.6), (0.0, 0.1)))
    assert np.abs(missing_oil(seen, start)).max() < 1e-12
    assert seen["position"].max() == 0.27
    assert seen["position"].min() == 0.0
    assert set(seen["mass"]) == {120.0, 303.0}
    assert seen["cavity_upper"].max() > 1e-6
    assert max(seen[name].max() for name in ("cavity_t", "cavity_a", "cavity_b")) > 1e-6
    assert seen["oil_relieved"][-1] > 1e-5
    assert seen["oil_pumped"][-1] > 5e-4


def oil_by_pressure(s: State, c: Circuit) -> float:
    """Oil of a circuit with steady flows [m^3], by the pressures at the ends and the cavities alone.

    A lumped line takes the mean of the flows at both instants of a step, the books that of the later: half a step.
    """
    p, x, cylinder = pressures(s), s.piston.position, c.parts.cylinder
    chambers = sum(stored_oil(Chambers(p.lower, p.upper), x, cylinder)) - sum(chamber_cavities(s.core.chambers, x, cylinder))
    lines = float((c.lines.capacity * s.ends.pressure.reshape(6, 2).mean(axis=1)).sum())
    cavities = s.ends.cavity.sum() + sum(inner_cavity(c.lines, s.memory, line) for line in range(6))
    lumped = np.repeat(c.lines.model == LUMPED, 2)
    lumped[[LOWER, UPPER]] = False
    return chambers + lines - float(cavities) + 0.5 * c.parts.step * float(s.ends.flow[lumped].sum())


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("valve", VALVES)
def test_pressures_at_rest_know_how_much_oil_has_come(model: str, valve: str):
    """Counted oil and C p agree from rest to rest, with cavities that stay and without: the lines lose none inside.

    1e-12 of the oil there is: three seconds let the slowest wave die to 1e-3 of that, rounding is the rest.
    """
    c = circuit(valve={"kind": valve}, pump=SMOOTH, cylinder=TIGHT, **pipes(model=model))
    s = start = equilibrium(c, 0.05)
    up_and_down, up = ((1.0, 0.4), (0.0, 0.3), (-1.0, 0.5), (0.0, 3.0)), ((1.0, 0.4), (0.0, 3.0))
    for commands in (up_and_down, up):
        for reference, seconds in commands:
            s = run(s, reference, c, seconds)
        assert s.piston.velocity == 0.0
        counted = oil_in(s) - oil_in(start)
        assert abs(counted) > 1e-5
        found = oil_by_pressure(s, c) - oil_by_pressure(start, c)
        assert abs(found - counted) < 1e-12 * (oil_in(s) + c.parts.line_volume)
        if commands is up_and_down:
            assert sum(chamber_cavities(s.core.chambers, s.piston.position, c.parts.cylinder)) > 1e-5


@given(
    commands=COMMANDS,
    mass=st.sampled_from([30.0, 120.0, 303.0]),
    added=st.sampled_from([0.0, 183.0]),
    position=st.floats(0.0, 0.27),
    rpm=st.floats(0.0, 1800.0),
    kinds=st.tuples(*[st.sampled_from(MODELS)] * 6),
    valve=st.sampled_from(VALVES),
)
@settings(max_examples=50)
def test_violent_runs_stay_physical(commands, mass, added, position, rpm, kinds, valve):
    """Random commands: no pressure below vapour, at the ends and inside lines; stroke kept; oil kept; all finite.

    A chamber may owe oil: its cavity then reaches into the line, but never beyond chamber and line.
    """
    own = {f"pipe_{i + 1}": {"model": kind} for i, kind in enumerate(kinds)}
    c = circuit(load={"mass": mass, "added": added}, pump={"speed": rpm / 60.0}, valve={"kind": valve}, **own)
    s = start = equilibrium(c, position)
    parts = []
    for reference, seconds in commands:
        for _ in range(4):
            seen, s = watched(s, reference, c, round(seconds / 4e-3 + 1.0) * 1e-3, every=10)
            parts.append(seen)
            assert least_inside(s, c) >= VAPOUR - ROUNDING
    seen = joined(*parts)
    assert all(np.isfinite(column).all() for column in seen.values())
    for name in (name for name in OBSERVED if name.startswith("p") and name != "position"):
        assert seen[name].min() >= VAPOUR
        assert seen[name].max() < 400 * BAR
    assert seen["position"].min() >= 0.0
    assert seen["position"].max() <= 0.27
    assert np.abs(missing_oil(seen, start)).max() < 1e-12
    for name in (name for name in OBSERVED if name.startswith("cavity")):
        assert seen[name].min() >= 0.0
    x = seen["position"]
    line, cylinder = math.pi / 4.0 * 0.011**2 * 2.0, c.parts.cylinder
    assert (seen["cavity_lower"] <= cylinder.dead_lower + cylinder.area_lower * x + line).all()
    assert (seen["cavity_upper"] <= cylinder.dead_upper + cylinder.area_upper * (0.27 - x) + line).all()


def least_inside(s: State, c: Circuit, places: Array = PLACES) -> float:
    """Lowest pressure [Pa] at places inside the lines that have nodes."""
    out, least = np.zeros(len(places)), math.inf
    for line in range(6):
        if c.lines.model[line] == NODES:
            profile(c.lines, s.memory, int(s.core.tick), line, places, out)
            least = min(least, float(out.min()))
    return least


@pytest.mark.xfail(strict=True, reason="the cavity of the tee stands before the filter: none behind it, -2 bar there")
def test_behind_the_filter_nothing_falls_below_the_vapour_pressure():
    """Line 2 between filter and P, as the valve of a slow pump with a light load is thrown up and down."""
    c = circuit(pump={"speed": 10.0}, valve={"kind": "switching"}, pipe_2={"model": "nodes"})
    s, least = equilibrium(c, 0.25), math.inf
    for reference in (-1.0, 1.0, -1.0, 1.0):
        for s in states(s, reference, c, 0.1, every=5):
            least = min(least, least_inside(s, c, np.linspace(0.0, 1.0, 21)))
    assert least >= VAPOUR - ROUNDING


def closed(step: float = 50e-6, **parts: dict) -> Circuit:
    """Valve shut, pump off, no friction, no leak, no cavities, no relief valve: nothing feeds and nothing drains."""
    bare = {"oil": {"cavitation": "none"}, "seal": FRICTIONLESS, "cylinder": TIGHT, "pump": PUMP_OFF}
    return circuit(step, **(pipes(model="lumped", friction="none") | UNFITTED | bare | parts))


def test_a_closed_circuit_rings_without_gain_or_loss():
    """36 s, a thousand periods of the load on its oil: the energy of a push of 50 mm/s stays within 1 %, (omega h)^2/4
    of the fastest mode and p/2B of the moving chambers, from the first period to the last."""
    c = closed()
    rest, push = equilibrium(c, 0.135), 0.5 * c.parts.load.mass * 0.05**2
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
@settings(max_examples=40)
def test_energy_is_never_created(mass, position, push, limit, leak, bars, through, reference, valve):
    """Pump off, lumped lines with friction, any start: kinetic energy, compression and height together never rise above
    their lowest value so far by more than 0.1 % of what was in motion: (omega h)^2/4 of the load on its oil springs is
    0.004 %, p/2B 0.3 %."""
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
    allowed = 1e-3 * (lowest - mass * 9.81 * position) + 1e-6
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
        for s in states(s, reference, c, 0.15):
            pressure.append(s.ends.pressure - start.ends.pressure)
            flow.append(s.ends.flow)
    power = (np.array(pressure) * np.array(flow)).reshape(len(flow), 6, 2)
    work = c.parts.step * power.sum(axis=2).cumsum(axis=0)
    turned = c.parts.step * np.abs(power).sum(axis=(0, 2))
    assert (turned > 1.0).all()  # [J]
    assert (work.min(axis=0) >= -1e-12 * turned).all()


@pytest.mark.parametrize("model", MODELS)
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
