"""Drives with other supplies, accumulators, relief valves, check valves and return ends: at rest, oil, energy, slopes.

Two drives hold every kind between them; each costs a compilation.
"""

from functools import cache
from typing import Any

import numpy as np
import pytest

from bridge.scenario.units import quantity
from tests.support.plant import BAR, FRICTIONLESS, TIGHT, circuit, pipes, run, states
from twin.accumulator import OIL, Accumulator, gas_energy
from twin.circuit.block import observed
from twin.circuit.build import rebuild
from twin.circuit.ends import TEE_1, TEE_2
from twin.circuit.equilibrium import equilibrium, supply_at_rest
from twin.circuit.linear import jacobian, moving_point, to_vector
from twin.circuit.rates import vector_rates
from twin.circuit.state import oil_in, pressures
from twin.circuit.step import A, B, Circuit, P, T
from twin.rig import values

DRIVES: dict[str, dict[str, Any]] = {
    "variable": {
        "supply": {"kind": "variable"},
        "accumulator": {"kind": "bladder"},
        "relief": {"kind": "direct"},
        "direct_relief": {"cracking_pressure": 230 * BAR},
        "check_valve": {"kind": "fitted"},
        "return_end": {"kind": "check"},
    },
    "fixed": {
        "supply": {"kind": "fixed"},
        "accumulator": {"kind": "bladder", "at": "p", "precharge": 60 * BAR},
        "relief": {"kind": "direct", "place": "pipe_7"},
        "return_end": {"kind": "orifice"},
    },
}
SAME = {"cylinder": TIGHT, "amplifier": {"kind": "lag"}, "minor_losses": {"kind": "fitted"}}


@cache
def drive(name: str, model: str = "ends") -> Circuit:
    return circuit(**(pipes(model=model) | SAME | DRIVES[name]))


def accumulator(c: Circuit) -> Accumulator:
    return next(a for a in (c.parts.tee_accumulator, c.parts.p_accumulator) if isinstance(a, Accumulator))


@pytest.mark.parametrize("model", ["ends", "lumped"])
@pytest.mark.parametrize("name", DRIVES)
def test_a_held_drive_stays_put(name: str, model: str):
    """Half a second at rest: pressures to 1 Pa, the piston to the bit, no oil into the accumulator."""
    c = drive(name, model)
    start = equilibrium(c, 0.1)
    end = run(start, 0.0, c, 0.5)
    assert pressures(end) == pytest.approx(pressures(start), abs=1.0)
    assert end.piston == start.piston
    assert end.slots.accumulator[OIL] == pytest.approx(start.slots.accumulator[OIL], rel=1e-9)
    assert start.slots.accumulator[OIL] > 1e-4


def test_supplies_rest_where_their_characteristics_say():
    """A variable pump at its cut-off and droop, less what its leak takes; a fixed one where the relief valve takes all;
    a source at its pressure."""
    at = supply_at_rest(drive("variable"))
    assert at.relieved == 0.0
    share = 3e-12 * at.pump / (28e-6 * 25.0)  # of the displacement, for the leak
    assert at.pump == pytest.approx(204 * BAR - share * 4 * BAR, rel=1e-9)
    more: dict[str, Any] = SAME | DRIVES["variable"] | {"variable_pump": {"leakage": 0.0}}
    tight = circuit(**more)
    assert supply_at_rest(tight).pump == pytest.approx(204 * BAR, rel=1e-6)
    at = supply_at_rest(drive("fixed"))
    whole = (20e-6 * 25.0 - 1e-12 * at.pump) * (1.0 + at.pump / drive("fixed").parts.oil.bulk_modulus)
    assert at.relieved == pytest.approx(whole, rel=1e-9)
    source = circuit(supply={"kind": "pressure"}, relief={"kind": "none"}, **SAME)
    assert supply_at_rest(source).tee == pytest.approx(210 * BAR, rel=1e-9)


@pytest.mark.parametrize("name", DRIVES)
def test_oil_is_kept_through_cavities_and_an_empty_accumulator(name: str):
    """Thrown open and shut: oil stored less what crossed the border, to 1e-12 of the oil there is."""
    c = drive(name)
    s = equilibrium(c, 0.1)
    start, cavities = oil_in(s), []
    for reference in (1.0, -1.0, 0.3, 0.0):
        for then in states(s, reference, c, 0.2, every=40):
            s = then
            kept = oil_in(s) - s.ledger.pumped + s.ledger.relieved + s.ledger.returned
            assert kept == pytest.approx(start, abs=1e-12 * observed(s, c)["oil_stored"])
            assert min(pressures(s)) >= c.parts.oil.vapour_pressure
            assert s.slots.accumulator[OIL] >= 0.0
            cavities.append(float(s.ends.cavity.sum()))
    assert max(cavities) > 0.0


@pytest.mark.parametrize("name", DRIVES)
def test_neither_tee_nor_port_p_gives_energy(name: str):
    """In each step: what tee (or valve) and accumulator take from their line ends is never less than what the gas holds
    more, but for rounding and the curvature of its polytrope. A check valve never lets oil back."""
    c, h = drive(name), 50e-6
    gas = accumulator(c)
    at = (TEE_1, TEE_2) if name == "variable" else (P, A, B, T)
    s = equilibrium(c, 0.1)
    through, given = 0.0, []
    for reference in (1.0, -1.0, 0.0):
        for then in states(s, reference, c, 0.15):
            power = sum(float(then.ends.pressure[end] * then.ends.flow[end]) for end in at)
            stored = gas_energy(float(then.slots.accumulator[OIL]), gas) - gas_energy(
                float(s.slots.accumulator[OIL]), gas
            )
            through += h * sum(abs(float(then.ends.pressure[end] * then.ends.flow[end])) for end in at)
            hollow = any(then.ends.cavity[end] > 0.0 or s.ends.cavity[end] > 0.0 for end in at)
            given.append(0.0 if hollow else h * power + stored)
            if name == "variable":
                assert then.ends.flow[TEE_2] >= -1e-12
            s = then
    assert max(given) < 1e-9 * through
    assert sum(max(0.0, one) for one in given) < 1e-6 * through
    assert through > 100.0  # [J]


def test_slopes_by_hand_are_the_differences_of_the_rates():
    """About a steady motion, over the swash plate's and the relief valve's steady curves, an open check valve, the
    gas and the back-pressure valve."""
    parts: dict[str, Any] = pipes(model="lumped") | SAME | DRIVES["variable"] | {"seal": FRICTIONLESS}
    c = circuit(**parts)
    y = to_vector(moving_point(c, 0.1, 0.3))
    assert np.abs(vector_rates(y, 0.3, c)[:9]).max() < 1e-3 * BAR
    slopes, found = jacobian(y, c, None), np.empty((len(y), len(y)))
    for j in range(len(y)):
        width = 1e-5 * abs(y[j]) + 1e-9
        above, below = y.copy(), y.copy()
        above[j] += width
        below[j] -= width
        found[:, j] = (vector_rates(above, 0.3, c) - vector_rates(below, 0.3, c)) / (2.0 * width)
    scale = np.abs(found).max(axis=1, keepdims=True)
    assert np.abs(slopes - found)[:15].max(axis=1) == pytest.approx(np.zeros(15), abs=2e-5 * scale[:15].max())


def test_a_leakage_is_written_as_people_read_it():
    """1 l/min per 100 bar is 1/6 e-11 m^3/(s Pa)."""
    assert quantity("0.01 l/(min bar)", "m^3/(s Pa)") == pytest.approx(1.0 / 6.0 * 1e-11, rel=1e-12)


def test_what_cannot_be_is_said_in_one_line():
    with pytest.raises(ValueError, match="least_displacement"):
        circuit(supply={"kind": "variable"}, variable_pump={"least_displacement": 30e-6})
    shut = circuit(supply={"kind": "fixed"}, relief={"kind": "none"}, fixed_pump={"leakage": 0.0})
    with pytest.raises(ValueError, match="no outlet"):
        supply_at_rest(shut)


@pytest.mark.parametrize(
    ("name", "number", "field"),
    [
        ("pressure_source.pressure", 150 * BAR, "supply"), ("variable_pump.cut_off", 150 * BAR, "supply"),
        ("fixed_pump.leakage", 1e-11, "supply"), ("accumulator.precharge", 20 * BAR, "tee_accumulator"),
        ("direct_relief.cracking_pressure", 90 * BAR, "relief"), ("check_valve.cracking_pressure", 2 * BAR, "check"),
        ("return_end.cracking_pressure", 5 * BAR, "return_end"),
    ],
)  # fmt: skip
def test_a_number_of_each_kind_changes_while_it_runs(name: str, number: float, field: str):
    """Only the part that it belongs to is another one."""
    section, key = name.split(".")
    kinds: dict[str, Any] = {
        "supply": {"kind": section.split("_")[0]} if field == "supply" else {"kind": "variable"},
        "accumulator": {"kind": "bladder"}, "relief": {"kind": "direct"}, "check_valve": {"kind": "fitted"},
        "return_end": {"kind": "check"},
    }  # fmt: skip
    before = circuit(**kinds)
    rig = values(kinds | {section: {**kinds.get(section, {}), key: number}})
    then = rebuild(before, rig, name)
    changed = {one for one in before.parts._fields if getattr(before.parts, one) != getattr(then.parts, one)}
    assert field in changed
    assert changed <= {field, "fitting"}
