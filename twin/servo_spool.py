"""Spool of a servo valve: from the command to its position, in shares of the travel.

The command passes two plays, for what a data sheet calls threshold and hysteresis, then a delay; the spool follows

    second order: s'' = omega^2 (u - s) - 2 zeta omega s'      first order: T s' = u - s

exactly for a command held over a step, within a limit of speed and between stops at -1 and 1. A play of half-width r
keeps its output while the command moves within it: y = min(max(y, u - r), u + r). The two are in parallel (a
Prandtl-Ishlinskii model, e.g. Kuhnen, Eur. J. Control 9 (2003) 407): the narrow one is half the threshold wide, since a
command that turns round first has to cross it; of a full cycle the loop is 2 (1 - w) r_narrow + 2 w r_wide wide, which
is the hysteresis. The delay counts whole steps, and what is left of it as a share of two neighbouring commands.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.kernel import inlined

DELAYED = 128  # steps that a command may be delayed by
NARROW, WIDE, NEXT, QUEUE = range(4)  # of what the spool keeps: outputs of the plays, place in the queue, commands
SPOOL_MEMORY = QUEUE + DELAYED


class SpoolMotion(NamedTuple):
    """How a spool follows its command. The step matrix is that of (s - command, s')."""

    position_from_position: float
    position_from_speed: float  # [s]
    speed_from_position: float  # [1/s]
    speed_from_speed: float
    rate: float  # largest speed [travel/s]
    delay: float  # whole steps
    late: float  # share of the command one step older
    narrow: float  # half-width of a play
    wide: float
    wide_share: float  # of the wide play in the command
    spring: float  # omega^2 [1/s^2]
    damper: float  # 2 zeta omega [1/s]
    quickness: float  # 1/T [1/s] of first order; 0: second order


@inlined
def play(before: float, command: float, half_width: float) -> float:
    """Output of a play: it stays while the command is within half a width of it."""
    return min(max(before, command - half_width), command + half_width)


@inlined
def played(command: float, motion: SpoolMotion, memory: NDArray) -> float:
    """The command behind both plays."""
    if motion.wide == 0.0:
        return command
    memory[NARROW] = play(memory[NARROW], command, motion.narrow)
    memory[WIDE] = play(memory[WIDE], command, motion.wide)
    return (1.0 - motion.wide_share) * memory[NARROW] + motion.wide_share * memory[WIDE]


@inlined
def delayed(command: float, motion: SpoolMotion, memory: NDArray) -> float:
    """The command of the delay ago."""
    if motion.delay == 0.0 and motion.late == 0.0:
        return command
    place, steps = int(memory[NEXT]), int(motion.delay)
    memory[QUEUE + place] = command
    memory[NEXT] = float((place + 1) % DELAYED)
    newer = memory[QUEUE + (place - steps) % DELAYED]
    older = memory[QUEUE + (place - steps - 1) % DELAYED]
    return newer + motion.late * (older - newer)


@inlined
def follow(position: float, speed: float, command: float, motion: SpoolMotion, step: float) -> tuple[float, float]:
    """Position and speed a step later. The rate limit caps the travel of the step, the stops end it at rest."""
    away = position - command
    target = command + motion.position_from_position * away + motion.position_from_speed * speed
    then = motion.speed_from_position * away + motion.speed_from_speed * speed
    reach = motion.rate * step
    moved = position + min(max(target - position, -reach), reach)
    then = min(max(then, -motion.rate), motion.rate)
    if abs(moved) >= 1.0:
        moved = math.copysign(1.0, moved)
        then = min(then, 0.0) if moved > 0.0 else max(then, 0.0)
    return moved, then


@inlined
def motion_rates(position: float, speed: float, command: float, motion: SpoolMotion) -> tuple[float, float]:
    """Rates of position and speed without limits, plays and delay. Of first order the speed is a state without use."""
    if motion.quickness > 0.0:
        return motion.quickness * (command - position), -motion.quickness * speed
    return speed, motion.spring * (command - position) - motion.damper * speed


def begin_spool(position: float, memory: NDArray[np.float64]) -> None:
    """What a spool keeps that has been at rest at a position."""
    memory[[NARROW, WIDE]] = position
    memory[NEXT] = 0.0
    memory[QUEUE:SPOOL_MEMORY] = position


def first_order(time_constant: float, step: float) -> tuple[float, float, float, float]:
    """The step matrix of T s' = u - s."""
    kept = math.exp(-step / time_constant)
    return kept, 0.0, -kept / time_constant, 0.0


def plays(hysteresis: float, threshold: float, wide_share: float) -> tuple[float, float]:
    """Half-widths of the narrow and the wide play; ValueError where a loop would be narrower than the threshold."""
    if hysteresis < threshold:
        raise ValueError(
            f"servo_valve.hysteresis {hysteresis:g} is less than servo_valve.threshold {threshold:g}, which is a part "
            "of it; take at least as much"
        )
    narrow = 0.5 * threshold
    return narrow, narrow + (hysteresis - threshold) / (2.0 * wide_share)


def delay_in_steps(delay: float, step: float) -> tuple[float, float]:
    """A delay [s] as whole steps and the share of one more; ValueError for one that is too long."""
    steps = delay / step
    if steps > DELAYED - 2:
        raise ValueError(
            f"servo_valve.delay {delay:g} s is {steps:.0f} steps of {step:g} s: at most {DELAYED - 2}; "
            f"take at most {(DELAYED - 2) * step:.3g} s or a larger loop.step"
        )
    whole = math.floor(steps + 1e-9)
    return float(whole), max(0.0, steps - whole) if steps - whole > 1e-9 else 0.0
