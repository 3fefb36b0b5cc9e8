"""A load and its friction alone, driven by a force, in the steps of the plant: half a kick, the travel, half a kick."""

from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from twin.contact import NoStops, allowed_speed
from twin.friction import NoFriction, slide
from twin.load import Weight
from twin.load_slot import kick_second, move_load, push_of
from twin.topology import SLOT

FREE, SMOOTH, REST = NoStops(1.0), NoFriction(), Weight(0.0, 0.0, 0.0)
Motion = tuple[float, float, NDArray[np.float64]]  # place [m], speed [m/s], memory of the load


def moves(
    load: Any, force: Callable[[float], float], start: tuple[float, float], step: float, count: int,
    friction: Any = SMOOTH, stops: Any = FREE, memory: tuple[float, ...] = (), bristles: float = 0.0,
) -> Iterator[Motion]:  # fmt: skip
    """Place, speed and memory after each of `count` steps under a force [N] of the time [s]."""
    x, v = start
    kept, bent = np.zeros(SLOT), np.zeros(SLOT)
    kept[: len(memory)], bent[0] = memory, bristles

    def kick(v: float, at: float) -> float:
        push = push_of(load, force(at), x, v, REST, kept, 0.5 * step)
        then = allowed_speed(stops, x, slide(friction, v, push.force, push.mass, 0.0, bent, 0.5 * step))
        kick_second(load, push, x, 0.5 * (v + then), REST, kept, 0.5 * step)
        return then

    for number in range(count):
        v = kick(v, number * step)
        x, v, _ = move_load(load, x, v, REST, stops, kept, step)
        v = kick(v, (number + 1) * step)
        yield x, v, kept


def end_of(*arguments: Any, **named: Any) -> Motion:
    """The last of `moves`."""
    return deque(moves(*arguments, **named), maxlen=1)[0]
