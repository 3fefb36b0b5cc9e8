"""Does a run oscillate? Measured on the true position alone, without the metric that is tried.

The last constant stretch that follows a motion, or the one that moves most in its last third, is cut into thirds, and
its last third into thirds again. It oscillates if the position moves by more than 0.3 mm peak to peak in the last
third; unless it goes one way only (creep), or its swing falls from part to part (decay). What lies near one of these
limits is doubtful: it is listed by name, and belongs to neither side.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.studies.stability.trial import Trace
from controller.stretches import Stretch, held_stretches

Array = NDArray[np.float64]

LEAST = 0.3e-3  # [m], peak to peak in the last third
NEAR = (0.2e-3, 0.45e-3)  # [m], doubtful
SHORTEST = 1.0  # [s], of a stretch
ONE_WAY = 0.1  # of the way in one direction is the most that creep goes back
FALLS = 0.8  # of the middle third


class Label(NamedTuple):
    """What a run does in its liveliest stretch."""

    word: str  # oscillates | still | creeps | decays | no stretch
    doubtful: bool
    middle: float  # [m], peak to peak in the middle third
    last: float  # [m], in the last third
    parts: tuple[float, ...]  # [m], of the last third

    @property
    def oscillates(self) -> bool:
        """Should the metric find a limit cycle?"""
        return self.word == "oscillates"


def label(trace: Trace, reference: Array) -> Label:
    """The label of the stretch that moves most in its last third."""
    found = [_of_stretch(trace.position[stretch.samples]) for stretch in judged(trace.time, reference)]
    order = ("still", "creeps", "decays", "oscillates")
    none = Label("no stretch", False, 0.0, 0.0, (0.0, 0.0, 0.0))
    return max(found, key=lambda each: (order.index(each.word), each.last), default=none)


def judged(time: Array, reference: Array) -> list[Stretch]:
    """The constant stretches that follow a motion and are long enough."""
    return [s for s in held_stretches(reference) if time[s.stop - 1] - time[s.start] >= SHORTEST - 1e-9]


def _of_stretch(position: Array) -> Label:
    _, middle, last = np.array_split(position, 3)
    parts = tuple(float(np.ptp(part)) for part in np.array_split(last, 3))
    before, swing = float(np.ptp(middle)), float(np.ptp(last))
    return Label(_word(last, before, swing, parts), _is_doubtful(before, swing, parts), before, swing, parts)


def _word(last: Array, before: float, swing: float, parts: tuple[float, ...]) -> str:
    if swing <= LEAST:
        return "still"
    ways = np.diff(last)
    if min(ways[ways > 0.0].sum(), -ways[ways < 0.0].sum()) < ONE_WAY * swing:
        return "creeps"
    falling = parts[0] > parts[1] > parts[2]
    return "decays" if falling and swing < FALLS * before and parts[2] < FALLS * parts[0] else "oscillates"


def _is_doubtful(before: float, swing: float, parts: tuple[float, ...]) -> bool:
    """Near the least swing, or falling slowly."""
    falling = parts[0] > parts[1] > parts[2] and parts[2] < 0.95 * parts[0]
    return NEAR[0] < swing < NEAR[1] or (swing > LEAST and falling and 0.65 < swing / before < 0.9)
