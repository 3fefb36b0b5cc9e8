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
        self._offset: NDArray[np.float64] | None = None  # of the transducers, once one of them has been changed
        self._share = np.zeros(0)  # noise of each then [LSB rms]
        self._arguments = self.taps, self._row, self._card, self._step, self._reading
        self._acquire = entry(acquire, *self._arguments)  # compiled before the clock starts

    def read(self, tick: int, seen: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """One scan of the taps, as the card reads them at a tick; valid until the next.

        seen: what reaches the card in place of the taps, where transducers lie.
        """
        number, row = divmod(tick, NOISE_ROWS)
        if number != self._number:
            self._number, self._noise = number, noise_block(self._seed, number)
        self._row[:] = self._noise[row]
        offset = self._parted() if seen is not None else self._offset
        if offset is not None:
            np.add(self.taps if seen is None else seen, offset, out=self._arguments[0])
            self._row *= self._share
        self._acquire(*self._arguments)
        return self._reading

    def tune(self, channel: str, what: str, value: float) -> None:
        """From now on: the `offset` [SI] of a channel's transducer, or its `noise` [LSB rms]."""
        offset = self._parted()
        target = offset if what == "offset" else self._share
        target[[*CHANNELS].index(channel)] = value

    def _parted(self) -> NDArray[np.float64]:
        """From now on the card reads other values than the taps, with a noise of each channel; the offsets."""
        if self._offset is None:
            self._offset, self._share = np.zeros(len(CHANNELS)), np.full(len(CHANNELS), self._card.noise)
            own = self.taps.copy(), self._row, self._card._replace(noise=1.0), self._step, self._reading
            self._arguments, self._acquire = own, entry(acquire, *own)
        return self._offset
