"""What stands along the lines at an instant: pressures at evenly spaced places, and where there is a cavity."""

import numpy as np

from twin.circuit.block import CAVITIES
from twin.circuit.state import MEMORY_AT, ends_of, load
from twin.cylinder import chamber_cavities
from twin.kernel import kernel
from twin.lines.bank import inner_cavity, profile, unpacked
from twin.topology import LINES, PLACES

XI = np.linspace(0.0, 1.0, PLACES)
XI.flags.writeable = False


@kernel
def along_lines(state, parts, whole, numbers, xi, pressure, cavity) -> None:
    """Fill pressure [Pa], shape (LINES, len(xi)), and cavity [m^3], one for each of HOLLOWS; nothing else changes."""
    lines, s, ends, memory = unpacked(whole, numbers), load(state), ends_of(state), state[MEMORY_AT:]
    hollow = chamber_cavities(s.chambers, s.piston.position, parts[0].cylinder)
    cavity[0], cavity[1] = hollow.lower, hollow.upper
    for i in range(7):
        cavity[2 + i] = ends.cavity[CAVITIES[i]]
    for line in range(LINES):
        profile(lines, memory, int(s.tick), line, xi, pressure[line])
        cavity[9 + line] = inner_cavity(lines, memory, line)
