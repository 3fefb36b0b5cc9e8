"""The theory of a chart while somebody waits for it: how long it takes, and an end in order."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from bridge.machine.narrator import on_terminal
from bridge.machine.process import Stop
from bridge.studies.sweep.engine import progress

LOOK = 1.0  # [s] of columns that tell how long all take
LONG = 20.0  # [s], of what is told beforehand
PATIENCE = 10.0  # [s], of the chart that is proposed instead


class Watch:
    """Called with the columns that are there; says whether to go on."""

    def __init__(
        self,
        columns: int,
        stop: Callable[[], bool],
        advance: Callable[[], object],
        say: Callable[[str], object] = on_terminal,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._columns, self._stop, self._advance, self._say, self._clock = columns, stop, advance, say, clock
        self._begun, self._looked = math.nan, False  # the first column loads the libraries and tells nothing

    def __call__(self, done: int) -> bool:
        if done:
            self._advance()
        if done == 1:
            self._begun = self._clock()
        took = self._clock() - self._begun
        if done > 1 and not self._looked and took >= LOOK:
            self._looked = True
            self._foresee(took * self._columns / (done - 1))
        return not self._stop()

    def _foresee(self, whole: float) -> None:
        """Tell of a chart that takes long [s]; its time goes with the square of its side."""
        if whole > LONG:
            fewer = max(2, round(self._columns * (PATIENCE / whole) ** 0.5, -1))
            self._say(
                f"theory of {self._columns} columns takes some {whole:.0f} s here; Ctrl-C draws what is there, and "
                f"--cells {fewer:.0f} takes some {PATIENCE:.0f} s"
            )


@contextmanager
def watching(columns: int) -> Iterator[Watch]:
    """A bar on standard error; Ctrl-C asks for an end, a second one ends the process at once."""
    stop = Stop().listen()
    try:
        with progress("columns", columns, 0) as advance:
            yield Watch(columns, stop, advance)
    finally:
        stop.leave()
