"""Numbers drawn from distributions, by seed: the same whatever else is drawn, and however many more are.

Each number has a stream of its own, of numpy's PCG64, seeded with the campaign's seed and the CRC-32 of its place. A
normal one may be cut off: it is then drawn from what is left between its ends.
"""

import math
import zlib
from collections.abc import Sequence
from enum import StrEnum
from statistics import NormalDist
from typing import NamedTuple

from bridge.errors import UsageError
from bridge.runs.campaign.places import on_grid
from bridge.scenario.units import split

DIGITS = 9  # of a drawn number


class Distribution(StrEnum):
    """How a number is drawn."""

    UNIFORM = "uniform"
    LOG_UNIFORM = "log-uniform"
    NORMAL = "normal"


TAKES = {
    Distribution.UNIFORM: (2, 'write [LOW, HIGH], such as ["100 kg", "300 kg"]'),
    Distribution.LOG_UNIFORM: (2, 'write [LOW, HIGH], both above 0, such as ["1 ms", "100 ms"]'),
    Distribution.NORMAL: (4, 'write [MEAN, DEVIATION], or [MEAN, DEVIATION, LOW, HIGH], such as ["200 kg", "20 kg"]'),
}


class Draw(NamedTuple):
    """A number to draw."""

    place: str
    kind: Distribution
    numbers: tuple[float, ...]  # of the distribution, in the unit
    unit: str

    @property
    def label(self) -> str:
        """Place and unit."""
        return f"{self.place} [{self.unit}]" if self.unit else self.place

    def text(self, number: float) -> str:
        """A drawn number as a scenario takes it."""
        return f"{number:.{DIGITS}g} {self.unit}".rstrip()


def draw_of(place: str, kind: Distribution, given: object) -> Draw:
    """A number to draw, as a campaign file states it. Raises UsageError with the way out."""
    most, words = TAKES[kind]
    texts = [str(value) for value in given] if isinstance(given, list) else []
    if len(texts) not in {2, most}:
        raise UsageError(f"draw.{kind}: {place}: {words}")
    try:
        pairs = [split(text) for text in texts]
    except ValueError as error:
        raise UsageError(f"draw.{kind}: {place}: {error}") from None
    units = {unit for number, unit in pairs if unit}
    if len(units) > 1:
        raise UsageError(f"draw.{kind}: {place}: write all its numbers in one unit, not in {', '.join(sorted(units))}")
    found = Draw(place, kind, tuple(number for number, _ in pairs), units.pop() if units else "")
    if not _possible(found):
        raise UsageError(f"draw.{kind}: {place} = {texts}: {words}; what is LOW must lie below what is HIGH")
    return found


def _possible(draw: Draw) -> bool:
    numbers = draw.numbers
    if not all(map(math.isfinite, numbers)):
        return False
    if draw.kind == Distribution.NORMAL:
        return numbers[1] > 0.0 and (len(numbers) == 2 or numbers[2] < numbers[3])
    return numbers[0] < numbers[1] and (draw.kind == Distribution.UNIFORM or numbers[0] > 0.0)


def drawn(draw: Draw, seed: int, count: int, step: float) -> Sequence[str]:
    """So many draws, as a scenario takes them, times as whole steps [s]; of more draws the first are the same."""
    import numpy as np

    shares = np.random.default_rng([seed, zlib.crc32(draw.place.encode())]).random(count)
    return [draw.text(on_grid(value_at(draw, float(share)), draw.unit, step)) for share in shares]


def value_at(draw: Draw, share: float) -> float:
    """The number below which a share of all draws lies: the inverse of the distribution function."""
    if draw.kind == Distribution.NORMAL:
        return _normal_at(draw.numbers, share)
    low, high = draw.numbers
    if draw.kind == Distribution.UNIFORM:
        return low + share * (high - low)
    return math.exp(math.log(low) + share * (math.log(high) - math.log(low)))


def _normal_at(numbers: Sequence[float], share: float) -> float:
    normal = NormalDist(*numbers[:2])
    low, high = (normal.cdf(end) for end in numbers[2:]) if len(numbers) == 4 else (0.0, 1.0)
    inside = min(max(low + share * (high - low), 1e-12), 1.0 - 1e-12)
    return normal.inv_cdf(inside)
