"""A circuit whose rig has changed while it runs: that of the new numbers, its screw and its oil where they were."""

import numpy as np
import pytest

from tests.support.plant import cylinder_of, pipes, relief_of, run, states
from twin.circuit.block import compiled
from twin.circuit.build import MADE, SCREW, build, rebuild
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import flatten, oil_in, unflatten
from twin.circuit.step import LOWER, UPPER
from twin.circuit.stiffness import keep_oil
from twin.rig import BUILT_IN, RIG, Number, values

STEP = 50e-6
TUNABLE = [
    f"{part}.{name}"
    for part in MADE
    for name, entry in RIG[part].items()
    if isinstance(entry, Number) and f"{part}.{name}" not in BUILT_IN
]


def changed(name: str) -> dict[str, dict[str, float]]:
    """The rig with a number a little greater."""
    rig = values()
    part, _, key = name.partition(".")
    rig[part][key] = rig[part][key] * 1.01 or 0.01
    return rig


def test_every_number_makes_the_circuit_that_a_new_rig_has():
    """To the bit; of the relief valve only the numbers of its setting, since others leave its screw where it is."""
    before = build(values(), STEP)
    names = [name for name in TUNABLE if name in SCREW or not name.startswith("relief.")]
    assert len(names) > 40
    for name in names:
        own, new = (compiled(c) for c in (rebuild(before, changed(name), name), build(changed(name), STEP)))
        for mine, theirs in zip(own, new, strict=True):
            assert mine.tobytes() == theirs.tobytes(), name


def test_a_worn_nozzle_or_warm_oil_does_not_turn_the_screw():
    """The preload of the pilot's spring stays; a new setting changes it."""
    before = build(values(), STEP)
    preload = relief_of(before).pilot.preload
    for name in ("relief.nozzle_diameter", "relief.loss_factor", "oil.temperature"):
        then = rebuild(before, changed(name), name)
        assert relief_of(then).pilot.preload == pytest.approx(preload, rel=1e-14)
        assert then.parts.relief != before.parts.relief
    reset = rebuild(before, changed("relief.setting"), "relief.setting")
    assert relief_of(reset).pilot.preload > 1.001 * preload


def test_warm_oil_leaves_the_areas_of_the_valve():
    before, name = build(values(), STEP), "oil.temperature"
    then = rebuild(before, changed(name), name)
    assert then.parts.valve == before.parts.valve
    assert then.parts.seal != before.parts.seal
    assert (compiled(then).whole == compiled(before).whole).all()
    assert (then.lines.resistance < before.lines.resistance).all()


def test_softer_oil_keeps_its_volume_and_takes_its_pressure():
    """C p at the ends of lumped lines, before and after; a chamber and the end of its line are one store, S + C p."""
    rig = values(pipes(model="lumped"))
    before = build(rig, STEP)
    state = flatten(equilibrium(before, 0.1))
    start = unflatten(state)
    rig["oil"]["wave_speed"] *= 0.8
    after = rebuild(before, rig, "oil.wave_speed")
    keep_oil(state, before, after)
    then = unflatten(state)
    assert oil_in(then) == pytest.approx(oil_in(start), rel=1e-14)
    for line, place in enumerate(after.lines.lumped_place):
        inside = place + np.array([3, 4])
        held = [0.5 * c.lines.capacity[line] * s.memory[inside] for c, s in ((before, start), (after, then))]
        if line in (2, 3):
            for oil, s in zip(held, (start, then), strict=True):
                oil[1] += s.core.chambers[line - 2]
        assert held[1] == pytest.approx(held[0], rel=1e-14)
    joint = after.lines.lumped_place[2] + 4
    assert then.ends.pressure[LOWER] - start.ends.pressure[LOWER] == pytest.approx(
        then.memory[joint] - start.memory[joint], rel=1e-9
    )
    alone = cylinder_of(after).bulk_modulus / cylinder_of(before).bulk_modulus  # what each would keep by itself
    of_hose = before.lines.capacity[2] / after.lines.capacity[2]
    assert alone < 0.7 < of_hose
    assert alone < then.ends.pressure[LOWER] / start.ends.pressure[LOWER] < of_hose


def test_the_flow_between_a_chamber_and_its_line_does_not_swing_after_a_change():
    """On the move: the flow turns over from step to step by less than a hundredth, before and after. With the
    pressures of each by itself it would swing by its own size for a second and longer."""
    before = build(values(pipes(model="lumped")), STEP)
    rig = values({**pipes(model="lumped"), "cylinder": {"stiffness": 0.4}})
    after, flat = rebuild(before, rig, "cylinder.stiffness"), flatten(run(equilibrium(before, 0.1), 1.0, before, 0.2))
    keep_oil(flat, before, after)
    flow = np.array([s.ends.flow[[LOWER, UPPER]] for s in states(unflatten(flat), 1.0, after, 0.02)])
    assert (np.abs(np.diff(flow, 2, axis=0)) < 0.01 * np.abs(flow).mean(axis=0)).all()
