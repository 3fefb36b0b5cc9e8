"""The plant's message on its lines: pressure along each, and the cavities. One kernel call a viewer period."""

from typing import Any

import numpy as np

from bridge.wire.codec import LineProfile
from bridge.wire.messages import Outgoing
from twin.circuit.block import Compiled
from twin.circuit.profile import XI, along_lines
from twin.circuit.state import MEMORY_AT
from twin.kernel import entry
from twin.topology import HOLLOWS, LINES, POINTS


class LineProfiles:
    """Makes the messages of one run."""

    def __init__(self, run_id: int, circuit: Compiled) -> None:
        self._run_id = run_id
        self._circuit = circuit
        self._pressure = np.zeros((LINES, POINTS))
        self._cavity = np.zeros(len(HOLLOWS))
        examples = np.zeros(MEMORY_AT), *circuit, XI, self._pressure, self._cavity
        self._along_lines = entry(along_lines, *examples)

    def message(self, state: Any, sequence: int, tick: int, stamp: int) -> Outgoing:
        """What stands along the lines in a flat state."""
        self._along_lines(state, *self._circuit, XI, self._pressure, self._cavity)
        profile = LineProfile(
            run_id=self._run_id,
            sequence=sequence,
            tick=tick,
            stamp=stamp,
            places=POINTS,
            pressure=self._pressure.ravel().copy(),
            cavity=self._cavity.copy(),
        )
        return Outgoing("lines", stamp, sequence, profile)
