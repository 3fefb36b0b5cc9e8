"""The oil of a rig by its kind, its air, lines of one volume and walls that creep, in a whole circuit."""

import math

import numpy as np
import pytest

from tests.support.plant import BAR, SMOOTH, TIGHT, circuit, cylinder_of, run, states, watched
from twin.actuator import chamber_volumes
from twin.air import Air, NoAir, compressibility, effective_bulk_modulus
from twin.circuit.build import build, rebuild
from twin.circuit.equilibrium import equilibrium
from twin.circuit.limits import limits
from twin.circuit.state import flatten, oil_in, pressures, unflatten
from twin.circuit.step import LOWER
from twin.circuit.stiffness import keep_oil
from twin.iso_vg import grade_viscosity
from twin.rig import values

STEP = 50e-6


def oil(**entries):
    return build(values({"oil": entries}), STEP).parts.oil


def test_each_kind_takes_its_own_numbers():
    plain = {"density": 850.0, "viscosity": 30e-6, "bulk_modulus": 1.3e9}
    assert oil(kind="numbers", **plain)[:3] == (850.0, 30e-6, 1.3e9)
    graded = oil(kind="iso-vg", grade="32", temperature=55.0, bulk_modulus=1.5e9)
    assert graded[:3] == (857.0, grade_viscosity("32", 55.0), 1.5e9)
    assert oil(**plain)[1:3] == oil(density=850.0)[1:3]  # of the thesis, by temperature and wave speed
    assert oil().bulk_modulus == pytest.approx(1.17e9, rel=2e-4)


def test_lines_take_the_modulus_of_oil_with_air_at_their_pressure():
    """1/C over 1/C without air: that of the summed moduli of wall and oil."""
    soft = {"air": 0.01, "air_exponent": 1.2, "air_pressure": 20 * BAR}
    without, aerated = build(values(), STEP), build(values({"oil": soft}), STEP)
    b = effective_bulk_modulus(Air(0.01, 1.2), without.parts.oil.bulk_modulus, 20 * BAR)
    wall = 11e-3 / (2e-3 * 2.1e11)
    by_hand = (1.0 / b + wall) / (1.0 / without.parts.oil.bulk_modulus + wall)
    assert aerated.lines.capacity[0] / without.lines.capacity[0] == pytest.approx(by_hand, rel=1e-12)
    assert (without.parts.cylinder.air, aerated.parts.cylinder.air) == (NoAir(), Air(0.01, 1.2))


def test_air_without_vapour_is_refused():
    with pytest.raises(ValueError, match=r"oil\.air 0\.01 would expand without limit.*oil\.cavitation = 'vapour'"):
        build(values({"oil": {"air": 0.01, "cavitation": "none"}}), STEP)


def test_a_load_swings_softer_on_oil_with_air():
    """Both ends shut off by short volumes: m omega^2 = sum A^2/(V kappa), kappa of the law at the pressures held."""
    air, mass = Air(0.01, 1.4), 200.0
    block = {"model": "none", "manifold": 1e-6}
    c = circuit(
        10e-6, pump=SMOOTH, seal={"limit": 0.0}, cylinder=TIGHT, load={"mass": mass}, oil={"air": air.share},
        pipe_3=block, pipe_4=block,
    )  # fmt: skip
    start = equilibrium(c, 0.135, 5 * BAR)
    x = np.array(
        [s.piston.position for s in states(start.with_core(piston=start.piston._replace(velocity=1e-3)), 0.0, c, 0.2)]
    )
    crossed = np.flatnonzero(np.diff(np.sign(x - x.mean())) > 0)
    omega = 2.0 * math.pi * (len(crossed) - 1) / ((crossed[-1] - crossed[0]) * 10e-6)
    own, p = cylinder_of(c), pressures(start)
    volume = chamber_volumes(0.135, own)
    b, line = own.bulk_modulus, float(c.lines.capacity[2])
    kappa = [compressibility(air, b, p.lower), compressibility(air, b, p.upper)]
    stiff = own.area_lower**2 / (volume.lower * kappa[0] + line) + own.area_upper**2 / (volume.upper * kappa[1] + line)
    assert omega == pytest.approx(math.sqrt(stiff / mass), rel=0.01)


def test_oil_is_kept_with_air_walls_that_creep_and_volumes():
    """Thrown up and down with cavities; 1e-12 of the oil there is. Pressures stay above vapour."""
    hose = {"model": "volume", "creep": 0.3, "creep_2": 0.2}
    own = {"oil": {"air": 0.02}, "pipe_1": {"model": "none"}, "pipe_3": hose, "pipe_4": {"creep": 0.2}, "pipe_6": hose}
    c = circuit(load={"added": 183.0}, **own)
    s = start = equilibrium(c, 0.05)
    for reference, seconds in ((1.0, 0.4), (-1.0, 0.5), (0.0, 0.2)):
        seen, s = watched(s, reference, c, seconds)
        assert min(seen[name].min() for name in seen if name.startswith("p_")) >= -BAR
    crossed = [s.ledger[i] - start.ledger[i] for i in range(3)]
    change = oil_in(s) - oil_in(start)
    assert change == pytest.approx(crossed[0] - crossed[1] - crossed[2], abs=1e-12 * (c.parts.line_volume + oil_in(s)))


def test_a_start_under_creep_stays_at_rest():
    """A wall that has given all it gives: nothing moves."""
    hose = {"creep": 0.3, "creep_2": 0.2}
    c = circuit(
        pump=SMOOTH, cylinder=TIGHT, pipe_3=hose, pipe_4=hose | {"model": "lumped"}, pipe_2=hose | {"model": "volume"}
    )
    start = equilibrium(c, 0.1)
    assert pressures(run(start, 0.0, c, 0.05)) == pytest.approx(pressures(start), rel=1e-6, abs=1.0)


def test_the_relief_valve_has_a_line_of_its_own_of_any_model():
    for model in ("ends", "lumped", "volume", "none"):
        c = circuit(pump=SMOOTH, relief={"place": "pipe_7"}, pipe_7={"model": model, "creep": 0.1})
        start = equilibrium(c, 0.1)
        s = run(start, 0.5, c, 0.2)
        crossed = s.ledger.pumped - s.ledger.relieved - s.ledger.returned
        assert oil_in(s) - oil_in(start) == pytest.approx(crossed, abs=1e-14)


def test_limits_know_no_waves_in_a_volume():
    c = circuit(pipe_2={"model": "volume", "length": 1e-3}, pipe_5={"model": "none"})
    waves = {limit.part for limit in limits(c) if limit.what == "wave travel time"}
    assert waves == {"pipe_1", "pipe_3", "pipe_4", "pipe_6"}


def test_softer_oil_keeps_its_volume_in_volumes_and_with_air():
    """P C of a line of one volume, S of a chamber whose pressure follows the law with air."""
    models = {f"pipe_{i}": {"model": "volume" if i % 2 else "lumped"} for i in range(1, 7)}
    rig = values({"oil": {"kind": "numbers", "air": 0.01}, **models})
    before = build(rig, STEP)
    state = flatten(equilibrium(before, 0.1))
    start = unflatten(state)
    rig["oil"]["bulk_modulus"] *= 0.7
    after = rebuild(before, rig, "oil.bulk_modulus")
    keep_oil(state, before, after)
    then = unflatten(state)
    assert oil_in(then) == oil_in(start)
    for line, place in zip(after.lines.volume_lines, after.lines.volume_place, strict=True):
        held = [c.lines.capacity[line] * s.memory[place] for c, s in ((before, start), (after, then))]
        assert held[1] == pytest.approx(held[0], rel=1e-14)
    assert then.ends.pressure[LOWER] < start.ends.pressure[LOWER]
