"""Where an estimate begins: twins at rest or in steady motion, as far as one scan of the card tells it."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from twin.actuator import areas
from twin.circuit.equilibrium import state_at, supply_at_rest
from twin.circuit.state import Flows, Pressures, flatten
from twin.circuit.step import Circuit, Piston
from twin.directional_valve import Spool
from twin.kernel import interpreted
from twin.load_at_rest import held_force
from twin.relief.slot import steady_relief
from twin.topology import CHANNELS, PRESSURES

UNREAD = {"velocity": 0.05, "spool": 0.1}  # deviation [m/s] and of the travel where nothing tells it, assumed
PRESSURE = 10e5  # deviation [Pa] of a pressure that is not read, assumed
POSITION = "position"
Array = NDArray[np.float64]


def begin(circuit: Circuit, readings: Mapping[str, float], deviation: Mapping[str, float], spool: float, tick: int,
          drawn: Array) -> Array:  # fmt: skip
    """Flat states of members at a tick of the internal step, by deviates in rows, one for each of `freedoms`.

    readings: by channel, NaN where there is none; the position must be one. deviation: of the readings.
    """
    at, spread = _known(circuit, readings, deviation, spool)
    base = _flat(circuit, at)
    states = np.repeat(base[None, :], drawn.shape[1], axis=0)
    for name, row in zip(freedoms(), drawn, strict=True):
        if spread[name] > 0.0:
            states += np.outer(row, _flat(circuit, at | {name: at[name] + spread[name]}) - base)
    states[:, 0] = tick
    return states


def freedoms() -> tuple[str, ...]:
    """What the members differ in at the start, beside their unknowns."""
    return (*CHANNELS, "spool")


def _known(
    circuit: Circuit, readings: Mapping[str, float], deviation: Mapping[str, float], spool: float
) -> tuple[dict[str, float], dict[str, float]]:
    at = dict(readings) | {"spool": 0.0 if math.isnan(spool) else spool}
    spread = dict(deviation) | {"spool": UNREAD["spool"] if math.isnan(spool) else 0.0}
    if math.isnan(at["velocity"]):
        at["velocity"], spread["velocity"] = 0.0, UNREAD["velocity"]
    missing = [name for name in PRESSURES if math.isnan(at[name])]
    spread |= dict.fromkeys(missing, PRESSURE)
    rest = supply_at_rest(circuit).tee  # beyond it a relief valve is on its way, and no steady one passes so much
    at["p1"] = rest if "p1" in missing else min(at["p1"], rest)
    area = interpreted(areas)(circuit.parts.cylinder, at[POSITION])
    weight = held_force(circuit.parts.load, at[POSITION])
    if "p3" in missing:
        at["p3"] = max(0.0, (area.lower * at["p2"] - weight) / area.upper) if "p2" not in missing else 0.0
    if "p2" in missing:
        at["p2"] = max(0.0, (area.upper * at["p3"] + weight) / area.lower)
    return at, spread


def _flat(circuit: Circuit, at: Mapping[str, float]) -> Array:
    """The flat state in which the pressures have been steady, the piston in motion."""
    x, v, p1 = at[POSITION], at["velocity"], at["p1"]
    area = interpreted(areas)(circuit.parts.cylinder, x)
    fed, back = (area.lower * v, area.upper * v) if v >= 0.0 else (-area.upper * v, -area.lower * v)
    relieved = steady_relief(circuit.parts.relief, p1)
    p = Pressures(p1, p1, p1, at["p2"], at["p2"], at["p3"], at["p3"], 0.0, 0.0)
    q = Flows(relieved + fed, fed, area.lower * v, -area.upper * v, back, back)
    return flatten(state_at(p, q, Piston(x, v), Spool(at["spool"], 0.0), circuit))
