"""What stands along the lines at an instant: pressures at evenly spaced points, and where there is a cavity."""

import numpy as np

from twin.actuator import chamber_cavities
from twin.circuit.block import PORT_ENDS
from twin.circuit.state import MEMORY_AT, ends_of, load
from twin.circuit.step import LOWER, UPPER
from twin.kernel import kernel
from twin.lines.bank import inner_cavity, profile, unpacked
from twin.topology import CHAMBERS, LINES, POINTS, PORTS

XI = np.linspace(0.0, 1.0, POINTS)
XI.flags.writeable = False
PORTS_AT, LINES_AT = len(CHAMBERS), len(CHAMBERS) + len(PORTS)  # in HOLLOWS


@kernel
def along_lines(state, parts, whole, numbers, xi, pressure, cavity) -> None:
    """Fill pressure [Pa], shape (LINES, len(xi)), and cavity [m^3], one for each of HOLLOWS; nothing else changes."""
    lines, s, ends, memory = unpacked(whole, numbers), load(state), ends_of(state), state[MEMORY_AT:]
    hollow = chamber_cavities(s.chambers, s.piston.position, parts[0].cylinder)
    cavity[0], cavity[1] = hollow.lower + ends.cavity[LOWER], hollow.upper + ends.cavity[UPPER]
    for i in range(len(PORT_ENDS)):
        cavity[PORTS_AT + i] = ends.cavity[PORT_ENDS[i]]
    for line in range(LINES):
        profile(lines, memory, int(s.tick), line, xi, pressure[line])
        cavity[LINES_AT + line] = inner_cavity(lines, memory, line)
