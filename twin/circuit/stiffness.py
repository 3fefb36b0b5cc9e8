"""Oil that becomes stiffer or softer while a circuit runs: no oil comes or goes, so the pressures change.

Of lines without waves half of the oil stands at each end, C p, or all of it in one volume; of a chamber S = V (1 +
p/B). What a wall has taken late stays in it. A line with waves keeps those that are under way, and a change of their
speed cannot be had.
"""

import numpy as np
from numpy.typing import NDArray

from twin.actuator import chamber_pressures, moduli
from twin.circuit.state import ENDS_AT, MEMORY_AT, load
from twin.circuit.step import LOWER, UPPER, Circuit
from twin.kernel import interpreted
from twin.lines import lumped, volume


def keep_oil(state: NDArray[np.float64], before: Circuit, after: Circuit) -> None:
    """Give a flat state, in place, the pressures that its oil has in another circuit of the same lines.

    Nothing changes where the capacities are the same.
    """
    for lines, places, pressures_at in (
        (after.lines.lumped_lines, after.lines.lumped_place, lumped.PRESSURES_AT),
        (after.lines.volume_lines, after.lines.volume_place, volume.PRESSURES_AT),
    ):
        for line, place in zip(lines, places, strict=True):
            share = before.lines.capacity[line] / after.lines.capacity[line]
            state[MEMORY_AT + place + pressures_at] *= share
    if interpreted(moduli)(after.parts.cylinder) != interpreted(moduli)(before.parts.cylinder):
        core = load(state)
        pressures = interpreted(chamber_pressures)(core.chambers, core.piston.position, after.parts.cylinder)
        state[ENDS_AT + LOWER], state[ENDS_AT + UPPER] = pressures
