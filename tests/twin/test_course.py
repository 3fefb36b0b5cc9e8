"""A whole course in one call: the same numbers as block by block, and a state led to data."""

import numpy as np
import pytest

from bridge.scenario import load
from bridge.scenario.circuit import circuit_of, rest_of
from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.course import NOTHING, Stretches, Watched, course_of, width
from twin.circuit.state import place_of
from twin.topology import CHANNELS, OBSERVED

SAMPLES, STEPS = 40, 20
P_P = list(OBSERVED).index("p_p")


@pytest.fixture(scope="module")
def plant():
    scenario = load("ehla")
    return compiled(circuit_of(scenario)), rest_of(scenario)


def stretches() -> Stretches:
    """Every sample in two stretches, of which only the second ends in it."""
    reference = np.random.default_rng(1).uniform(-0.5, 0.5, 2 * SAMPLES)
    steps, row = np.tile([8, STEPS - 8], SAMPLES), np.full(2 * SAMPLES, -1)
    row[1::2] = np.arange(SAMPLES)
    return Stretches(reference, steps, row)


def test_a_course_is_its_blocks_to_the_last_bit(plant):
    circuit, rest = plant
    watched, given = Watched(np.array([P_P]), NOTHING, NOTHING, np.zeros(0)), stretches()
    state, out = rest.copy(), np.zeros((SAMPLES, width(watched)))
    course_of(circuit, given, watched)(state, np.zeros((1, 1)), out)
    block, (taps, seen), other = block_of(circuit), buffers(), rest.copy()
    for reference, steps, row in zip(*given, strict=True):
        block(other, reference, int(steps), taps, seen)
        if row >= 0:
            assert (out[row] == [*taps[0], *taps[1], seen[P_P]]).all()
    assert (state == other).all()


def test_a_led_number_takes_back_its_share_of_a_deviation(plant):
    """Of a valve that stays shut: each sample brings the position nearer by the gain, alone."""
    circuit, rest = plant
    x = place_of("piston.position")
    by = len(CHANNELS) + list(CHANNELS).index("position")
    watched = Watched(NOTHING, np.array([x]), np.array([by]), np.array([0.25]))
    given = Stretches(np.zeros(1), np.array([STEPS]), np.zeros(1, np.int64))
    state, out, measured = rest.copy(), np.zeros((1, width(watched))), np.full((1, width(watched)), np.nan)
    course_of(circuit, given, watched)(state, measured, out)
    assert state[x] == out[0, by]  # nothing was measured
    measured[0, by] = out[0, by] + 1e-3
    again = rest.copy()
    course_of(circuit, given, watched)(again, measured, out)
    assert again[x] - state[x] == pytest.approx(0.25e-3, rel=1e-9)
