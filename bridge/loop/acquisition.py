"""The data acquisition card of a run: transducers read at a tick, with the noise of that tick."""

import numpy as np
from numpy.typing import NDArray

from bridge.scenario import Scenario
from twin.circuit.block import buffers
from twin.kernel import entry
from twin.sensors import NOISE_ROWS, acquire, card_of, noise_block
from twin.topology import CHANNELS


class Acquisition:
    """One card; its noise is a function of seed and tick alone."""

    def __init__(self, scenario: Scenario) -> None:
        self.taps, _ = buffers()  # true values a step before the scan's end and at it; the plant fills them
        self._card = card_of(scenario.daq)
        self._seed = scenario.seed
        self._step = scenario.loop.step
        self._number, self._noise = 0, noise_block(scenario.seed, 0)
        self._row, self._reading = np.zeros(len(CHANNELS)), np.zeros(len(CHANNELS))
        self._arguments = self.taps, self._row, self._card, self._step, self._reading
        self._acquire = entry(acquire, *self._arguments)  # compiled before the clock starts

    def read(self, tick: int) -> NDArray[np.float64]:
        """One scan of the taps, as the card reads them at a tick; valid until the next."""
        number, row = divmod(tick, NOISE_ROWS)
        if number != self._number:
            self._number, self._noise = number, noise_block(self._seed, number)
        self._row[:] = self._noise[row]
        self._acquire(*self._arguments)
        return self._reading
