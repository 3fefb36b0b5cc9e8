"""Spool of a servo valve: the frequency response of its data sheet, the delay, loops of hysteresis, limits."""

import cmath
import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from twin.kernel import kernel
from twin.servo_spool import (
    DELAYED,
    SPOOL_MEMORY,
    SpoolMotion,
    begin_spool,
    delay_in_steps,
    delayed,
    first_order,
    follow,
    played,
    plays,
)
from twin.spool_valve import step_matrix

Array = NDArray[np.float64]
H = 50e-6
OMEGA, ZETA = 2.0 * math.pi * 100.0, 0.7


def motion(matrix: tuple[float, float, float, float] | None = None, **numbers: Any) -> SpoolMotion:
    """Second order, 100 Hz and 0.7, without limits unless told."""
    ideal = SpoolMotion(*(matrix or step_matrix(OMEGA, ZETA, H)), 1e9, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    return ideal._replace(**numbers)


@kernel
def _moved(commands, how, memory, out) -> None:
    position, speed = out[0], 0.0
    for k in range(len(commands)):
        command = delayed(played(commands[k], how, memory), how, memory)
        position, speed = follow(position, speed, command, how, 50e-6)
        out[k] = position


def moved(commands: Array, how: SpoolMotion, start: float = 0.0) -> Array:
    """Position after each step of 50 us under a command each."""
    memory, out = np.zeros(SPOOL_MEMORY), np.zeros(len(commands))
    begin_spool(start, memory)
    out[0] = start
    _moved(commands, how, memory, out)
    return out


def response(hertz: float, how: SpoolMotion) -> complex:
    """Of the position to a command, from the last 10 of 30 periods."""
    per_period = round(1.0 / (hertz * H))
    phase = 2.0 * math.pi * np.arange(30 * per_period) / per_period
    wave = np.exp(-1j * phase[-10 * per_period :])
    commands = 0.1 * np.sin(phase)
    out = moved(commands, how)
    return complex((out[-10 * per_period :] * wave).sum() / (commands[-10 * per_period :] * wave).sum())


@pytest.mark.parametrize("hertz", [10.0, 50.0, 100.0, 200.0, 400.0])
def test_amplitude_and_phase_are_those_of_the_data_sheet(hertz: float):
    """omega^2/(s^2 + 2 zeta omega s + omega^2): 90 degrees at 100 Hz. A held command is half a step old in the mean,
    and a position is read at the end of its step: the response is exact at half a step later."""
    s = 2j * math.pi * hertz
    sheet = OMEGA**2 / (s * s + 2.0 * ZETA * OMEGA * s + OMEGA**2)
    found = response(hertz, motion()) * cmath.exp(-s * H / 2.0)
    assert abs(found) == pytest.approx(abs(sheet), rel=2e-3)
    assert cmath.phase(found / sheet) == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("delay", [0.0, 1e-3, 1.03e-3, 6.3e-3])
def test_first_order_with_delay_answers_a_step(delay: float):
    """1 - exp(-(t - delay)/T), where the delay is whole steps exactly, and to the first order of the step between."""
    time_constant = 4e-3
    whole, late = delay_in_steps(delay, H)
    out = moved(np.full(400, 0.5), motion(first_order(time_constant, H), delay=whole, late=late))
    time = H * np.arange(1, 401) - delay
    exact = 0.5 * np.where(time > 0.0, -np.expm1(-time / time_constant), 0.0)
    assert np.abs(out - exact).max() < (1e-12 if late == 0.0 else 0.5 * (H / time_constant) ** 2)


def test_a_longer_delay_is_refused():
    assert delay_in_steps((DELAYED - 2) * H, H) == (DELAYED - 2, 0.0)
    with pytest.raises(ValueError, match=r"servo_valve.delay 0\.01 s is 200 steps of 5e-05 s: at most 126"):
        delay_in_steps(10e-3, H)


def loop(how: SpoolMotion, amplitude: float) -> tuple[Array, Array]:
    """Command and position through a slow cycle, -amplitude up and down again, after one before it."""
    way = np.concatenate([np.linspace(-amplitude, amplitude, 4000), np.linspace(amplitude, -amplitude, 4000)])
    commands = np.concatenate([way, way])
    settled = how._replace(
        position_from_position=0.0, position_from_speed=0.0, speed_from_position=0.0, speed_from_speed=0.0
    )
    return way, moved(commands, settled, start=0.0)[8000:]


@pytest.mark.parametrize(("hysteresis", "threshold"), [(0.03, 0.03), (0.03, 0.005), (0.02, 0.0)])
def test_a_full_cycle_makes_a_loop_as_wide_as_the_hysteresis(hysteresis: float, threshold: float):
    """Difference of the commands for the same position, up and down, anywhere but near the turns."""
    narrow, wide = plays(hysteresis, threshold, 0.2)
    command, position = loop(motion(narrow=narrow, wide=wide, wide_share=0.2), 0.9)
    up, down = position[:4000], position[4000:][::-1]
    for at in (-0.4, 0.0, 0.4):
        width = np.interp(at, up, command[:4000]) - np.interp(at, down, command[:4000])
        assert width == pytest.approx(hysteresis, abs=1e-6)


def test_a_command_that_turns_round_must_pass_the_threshold():
    narrow, wide = plays(0.03, 0.005, 0.2)
    how = motion(first_order(1e-9, H), narrow=narrow, wide=wide, wide_share=0.2)
    there = np.linspace(0.0, 0.5, 500)
    for back, moves in ((0.0049, False), (0.0051, True)):
        out = moved(np.concatenate([there, [0.5 - back]]), how)
        assert bool(out[-1] < out[-2]) is moves


def test_hysteresis_contains_the_threshold():
    with pytest.raises(ValueError, match=r"servo_valve.hysteresis 0\.001 is less than servo_valve.threshold 0\.005"):
        plays(0.001, 0.005, 0.2)


def test_the_spool_keeps_its_limits():
    """Never faster than 50 travels a second; between -1 and 1, at rest there, and back at once."""
    out = moved(np.concatenate([np.full(2000, 1.0), np.full(2000, -1.0)]), motion(rate=50.0))
    assert np.abs(np.diff(out)).max() == pytest.approx(50.0 * H, rel=1e-9)
    assert np.abs(out).max() == 1.0
    assert out[2000] < 1.0
