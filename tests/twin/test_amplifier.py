"""Amplifiers before the card: a first-order lag, against its closed forms."""

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest

from twin.amplifier import Lag, follow, lag
from twin.circuit.block import block_of, buffers, compiled
from twin.circuit.build import build
from twin.circuit.equilibrium import equilibrium
from twin.circuit.state import flatten
from twin.rig import values
from twin.topology import CHANNELS, OBSERVED

BANDWIDTH, STEP = 1600.0, 50e-6
TIME = 1.0 / (2.0 * math.pi * BANDWIDTH)  # of the lag [s]
READS = [list(OBSERVED).index(channel.reads) for channel in CHANNELS.values()]


def outputs(inputs: np.ndarray, a: Lag) -> np.ndarray:
    """What a lag makes of samples a step apart; it has rested at the first of them."""
    out = [inputs[0]]
    for before, after in pairwise(inputs):
        out.append(follow(out[-1], before, after, a))
    return np.array(out)


@pytest.mark.parametrize("step", [1e-6, STEP, 1e-3])
def test_a_ramp_is_followed_by_the_exact_solution(step: float):
    """u = t: y = t - T (1 - exp(-t/T)), at any step, since a ramp is straight."""
    t = step * np.arange(40)
    assert outputs(t, lag(BANDWIDTH, step)) == pytest.approx(t - TIME * -np.expm1(-t / TIME), abs=1e-15)


@pytest.mark.parametrize("frequency", [100.0, BANDWIDTH])
def test_a_sine_is_weakened_and_late_as_by_a_first_order_lag(frequency: float):
    """1/(1 + j f/f_0); at a fine step, where the sine is nearly straight."""
    step = 1e-6
    t = step * np.arange(int(0.02 / step))
    omega = 2.0 * math.pi * frequency
    late = outputs(np.sin(omega * t), lag(BANDWIDTH, step))
    whole = slice(-round(1.0 / frequency / step), None)
    measured = 2.0 * np.mean(late[whole] * np.exp(-1j * omega * t[whole])) * 1j
    assert measured == pytest.approx(1.0 / (1.0 + 1j * frequency / BANDWIDTH), abs=2e-4)
    if frequency == BANDWIDTH:
        assert math.degrees(cmath.phase(measured)) == pytest.approx(-45.0, abs=0.02)


def test_the_card_reads_the_amplifiers_and_the_plant_does_not_feel_them():
    """After a valve opens: states to the bit the same with slow ones; what the card reads is the lag of the states."""
    states = {}
    for bandwidth in (BANDWIDTH, 50.0):
        c = build(values({"amplifier": {"position": bandwidth, "pressure": bandwidth}}), STEP)
        run, state, (tap, seen) = block_of(compiled(c)), flatten(equilibrium(c, 0.1)), buffers()
        rows = [(run(state, 0.5, steps, tap, seen), tap[1].copy(), seen.copy())[1:] for steps in (0, *[1] * 400)]
        taps, states[bandwidth] = (np.array(column) for column in zip(*rows, strict=True))
        for j, name in enumerate(CHANNELS):
            true = states[bandwidth][:, READS[j]]
            expected = true if name == "velocity" else outputs(true, lag(bandwidth, STEP))
            assert taps[:, j] == pytest.approx(expected, rel=1e-12, abs=1e-9)
    assert (states[BANDWIDTH] == states[50.0]).all()
