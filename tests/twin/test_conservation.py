"""What no run may change: the oil there is, and that no pressure falls below that of vapour.

Energy is in `tests/twin/test_energy.py`.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.plant import (
    BAR,
    SMOOTH,
    TIGHT,
    Array,
    circuit,
    joined,
    pipes,
    run,
    states,
    watched,
)
from twin.actuator import chamber_cavities, stored_oil
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import State, oil_in, pressures
from twin.circuit.step import LOWER, UPPER, Circuit
from twin.cylinder import Chambers
from twin.lines.bank import LUMPED, NODES, inner_cavity, profile
from twin.topology import OBSERVED

MODELS = ("ends", "nodes", "lumped", "volume", "none")
VALVES = ("proportional", "switching")
COMMANDS = st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(0.005, 0.1)), min_size=3, max_size=8)
VAPOUR = -1 * BAR
ROUNDING = 1e-6  # [Pa]
PLACES = np.linspace(0.0, 1.0, 21)  # in a line


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
    if model in MODELS[:3]:  # oil with inertia leaves the valve behind
        assert max(seen[name].max() for name in ("cavity_t", "cavity_a", "cavity_b")) > 1e-6
    assert seen["oil_relieved"][-1] > 1e-5
    assert seen["oil_pumped"][-1] > 5e-4


def oil_by_pressure(s: State, c: Circuit) -> float:
    """Oil of a circuit with steady flows [m^3], by the pressures at the ends and the cavities alone.

    A lumped line takes the mean of the flows at both instants of a step, the books that of the later: half a step.
    """
    p, x, cylinder = pressures(s), s.piston.position, c.parts.cylinder
    chambers = sum(stored_oil(Chambers(p.lower, p.upper), x, cylinder)) - sum(
        chamber_cavities(s.core.chambers, x, cylinder)
    )
    lines = float((c.lines.capacity * s.ends.pressure[:12].reshape(6, 2).mean(axis=1)).sum())
    cavities = s.ends.cavity.sum() + sum(inner_cavity(c.lines, s.memory, line) for line in range(6))
    lumped = np.repeat(c.lines.model == LUMPED, 2)
    lumped[[LOWER, UPPER]] = False
    return chambers + lines - float(cavities) + 0.5 * c.parts.step * float(s.ends.flow[:12][lumped].sum())


@pytest.mark.parametrize("model", MODELS[:4])  # in manifolds alone the relief valve's pilot swings on
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
@settings(max_examples=30)
def test_violent_runs_stay_physical(commands, mass, added, position, rpm, kinds, valve):
    """Random commands: no pressure below vapour, at the ends and inside lines; stroke kept; oil kept; all finite.

    A chamber may owe oil: its cavity then reaches into the line, but never beyond chamber and line.
    """
    own = {f"pipe_{i + 1}": {"model": kind} for i, kind in enumerate(kinds)}
    c = circuit(50e-6, load={"mass": mass, "added": added}, pump={"speed": rpm / 60.0}, valve={"kind": valve}, **own)
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


def least_inside(s: State, c: Circuit) -> float:
    """Lowest pressure [Pa] at places inside the lines that have nodes."""
    out, least = np.zeros(len(PLACES)), math.inf
    for line in range(6):
        if c.lines.model[line] == NODES:
            profile(c.lines, s.memory, int(s.core.tick), line, PLACES, out)
            least = min(least, float(out.min()))
    return least


def test_behind_the_filter_nothing_falls_below_the_vapour_pressure():
    """Line 2 from the filter on, as the valve of a slow pump is thrown up and down: there is a cavity of its own."""
    c = circuit(pump={"speed": 10.0}, valve={"kind": "switching"}, pipe_2={"model": "nodes"})
    s, least = equilibrium(c, 0.25), math.inf
    for reference in (-1.0, 1.0, -1.0, 1.0):
        seen = list(states(s, reference, c, 0.1, every=5))
        least, s = min(least, *(least_inside(each, c) for each in seen)), seen[-1]
    assert VAPOUR - ROUNDING <= least < 0.9 * VAPOUR
