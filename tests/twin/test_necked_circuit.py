"""The circuit with a counterbalance valve at A and cushioned ends: oil, energy, what holds, what brakes."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.support.plant import (
    BAR,
    FRICTIONLESS,
    SMOOTH,
    TIGHT,
    Circuit,
    State,
    circuit,
    energy,
    pipes,
    pressures,
    run,
    states,
    watched,
)
from twin.accessory import LINE
from twin.actuator import chamber_volumes
from twin.circuit.block import observed
from twin.circuit.equilibrium import equilibrium, state_at
from twin.circuit.state import Flows, Pressures
from twin.circuit.step import LOWER, UPPER, Piston, Spool

HOLDING = {"kind": "counterbalance", "setting": 40 * BAR}
CUSHION = {"kind": "spear", "lower_clearance": 0.2e-3, "upper_clearance": 0.2e-3}
FREE = {"seal": FRICTIONLESS, "cylinder": TIGHT, "pump": SMOOTH}


@cache
def fitted(step: float = 50e-6) -> Circuit:
    return circuit(step, accessory_a=HOLDING, cushion=CUSHION, **FREE)


def test_a_load_held_by_the_valve_stays_put_with_an_empty_line():
    """10.15 bar in the chamber, 0 before the valve: a second later neither has moved, without a leak and friction."""
    c = fitted()
    start = equilibrium(c, 0.1)
    end = run(start, 0.0, c, 1.0)
    assert pressures(start).lower == pytest.approx(10.15 * BAR, rel=1e-3)
    assert pressures(start).a == start.slots.accessory_a[LINE] == 0.0
    assert end.piston.position == pytest.approx(0.1, abs=1e-12)
    assert end.slots.accessory_a[LINE] == pytest.approx(0.0, abs=1.0)


def test_oil_is_neither_made_nor_lost():
    """Half a second of full strokes of the valve, cavities and stops among them: 1e-13 of the oil per second."""
    c, s, rng = fitted(), equilibrium(fitted(), 0.02), np.random.default_rng(5)
    first = observed(s, c)
    for reference in (1.0, -1.0, 0.4, -1.0, -0.6, 1.0, -1.0, 0.0):
        s = run(s, reference, c, float(rng.uniform(0.03, 0.15)))
        seen = observed(s, c)
        came = seen["oil_pumped"] - seen["oil_relieved"] - seen["oil_returned"]
        assert seen["oil_stored"] - came == pytest.approx(first["oil_stored"], rel=1e-13)
        assert min(seen[f"p_{place}"] for place in ("a", "lower", "upper", "b")) >= -BAR


def stored_energy(s: State, c: Circuit) -> float:
    """As `energy`, the lines at their own pressure before the accessories."""
    own, p, volume = s.ends.pressure.copy(), pressures(s), chamber_volumes(s.piston.position, c.parts.cylinder)
    own[[LOWER, UPPER]] = line = np.array([s.slots.accessory_a[LINE], s.slots.accessory_b[LINE]])
    chambers = volume.lower * (p.lower**2 - line[0] ** 2) + volume.upper * (p.upper**2 - line[1] ** 2)
    return energy(s._replace(ends=s.ends._replace(pressure=own)), c) + 0.5 * chambers / c.parts.oil.bulk_modulus


@pytest.mark.parametrize("bars", [(0.0, 90.0, 0.0, 30.0), (60.0, 10.0, 0.0, 0.0), (5.0, 45.0, 80.0, 80.0)])
def test_energy_is_never_created(bars: tuple[float, ...]):
    """Pump off, lumped lines, both valves shut; chambers and lines at odds, so that counterbalance and check valve
    open: the energy never rises above its lowest value by more than 0.3 % of what was in motion, p/2B of the moving
    chambers."""
    bare = {"oil": {"cavitation": "none"}, "pump": {"speed": 0.0, "efficiency": 1.0}}
    unfitted = {"filter": {"drop": 0.0}, "two_position_valve": {"drop": 0.0}}
    parts: dict[str, Any] = {"seal": FRICTIONLESS, "cylinder": TIGHT} | bare | unfitted
    parts |= pipes(model="lumped", friction="none")
    c = circuit(accessory_a=HOLDING, cushion=CUSHION, **parts)
    a, lower, upper, b = (bar * BAR for bar in bars)
    at = Pressures(0.0, 0.0, 0.0, a, lower, upper, b, 0.0, 0.0)
    s = state_at(at, Flows(*[0.0] * 6), Piston(0.1, 0.05), Spool(0.0, 0.0), c)
    lowest = first = stored_energy(s, c)
    for then in states(s, 0.0, c, 0.1, every=5):
        now = stored_energy(then, c)
        assert now <= lowest + 3e-3 * first
        lowest = min(lowest, now)
    assert lowest < first


def test_cushions_brake_what_the_open_ends_do_not():
    """Up at full opening: the impact on the stop has less than a third of the speed before the cushion."""
    c = fitted()
    seen, _ = watched(equilibrium(c, 0.22), 1.0, c, 0.5)
    braked = seen["velocity"][seen["position"] < 0.2699]
    assert abs(braked[-1]) < seen["velocity"].max() / 3.0
    assert seen["position"].max() > 0.2698
