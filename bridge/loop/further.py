"""The further channels of a run's card: sampled at the stamp of each measurement, in a message of their own."""

import numpy as np
from numpy.typing import NDArray

from bridge.loop.sensor_faults import SensorFaults
from bridge.scenario import Scenario
from bridge.scenario.channels import chosen
from bridge.wire.codec import Channels
from bridge.wire.messages import CHANNELS_TOPIC, Outgoing
from twin.circuit.block import Compiled
from twin.circuit.sensing import Sensing
from twin.sensors import NOISE_ROWS, convert_all, inputs_of, own_noise_block

Array = NDArray[np.float64]


class FurtherChannels:
    """Those of one run. Without any none are made: `further_channels`."""

    def __init__(self, scenario: Scenario, plant: Compiled) -> None:
        sensors = chosen(scenario)
        self._names = tuple(sensors)
        self._seed = scenario.seed
        self._sensing = Sensing(self._names, plant, scenario.rig_values())
        self._inputs = inputs_of(scenario.daq, sensors)
        self._offset = np.zeros(len(sensors))  # of the transducers [SI]
        self._share = np.full(len(sensors), scenario.daq.noise)  # noise of each [LSB rms]
        self._begin(0)

    def read(
        self, tick: int, state: Array, seen: Array, taps: Array, now: int = 0, lies: SensorFaults | None = None
    ) -> Array:
        """What the card reads of a plant at a tick; taps: what its own channels touch, a step before and now.

        now: [ns]; lies: faults of the transducers.
        """
        number, row = divmod(tick, NOISE_ROWS)
        if number != self._number:
            self._begin(number)
        true = self._sensing.read(state, seen, taps)
        return convert_all((true if lies is None else lies.read(tick, now, true)) + self._added[row], self._inputs)

    def tune(self, channel: str, what: str, value: float) -> None:
        """From now on: the `offset` [SI] of a channel's transducer, or its `noise` [LSB rms]."""
        target = self._offset if what == "offset" else self._share
        target[self._names.index(channel)] = value
        self._change()

    def _begin(self, number: int) -> None:
        """Begin a block of ticks."""
        self._number, self._noise = number, own_noise_block(self._seed, number, self._names)
        self._change()

    def _change(self) -> None:
        """What is added to true values in a block of ticks."""
        self._added = self._noise * (self._share * self._inputs.lsb) + self._offset


def further_channels(scenario: Scenario, plant: Compiled) -> FurtherChannels | None:
    """The further channels of a scenario; None where it has chosen none."""
    return FurtherChannels(scenario, plant) if scenario.daq.channels else None


def message(run_id: int, sequence: int, tick: int, stamp: int, readings: Array) -> Outgoing:
    """The message of one scan."""
    return Outgoing(CHANNELS_TOPIC, stamp, sequence, Channels(run_id, sequence, tick, stamp, tuple(readings.tolist())))
