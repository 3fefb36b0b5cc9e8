"""What can be read off a recorded run of the plant: balances that must hold, and the moments when something happened.

Columns are those of `OBSERVED`, SI, equally long. A balance is zero where its law holds exactly.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from twin.actuator import Actuator, moduli, outside, widening
from twin.circuit.step import Circuit
from twin.contact import Stops
from twin.cylinder import Chambers, HoledCylinder
from twin.environment import Environment
from twin.kernel import interpreted
from twin.load import Load
from twin.load_at_rest import surroundings
from twin.load_slot import HeldLoad

Array = NDArray[np.float64]
Columns = Mapping[str, Array]
REACHED = 1e-4  # [m], as near to a stop as a sample may miss a bounce


def force_balance(time: Array, columns: Columns, circuit: Circuit) -> Array:
    """(A_l p_l - A_u p_u - m (g + x'') + F - F_f)/A_l [Pa], (2.10)."""
    cylinder, load = circuit.parts.cylinder, circuit.parts.load
    if not isinstance(load, Load | HeldLoad):
        raise ValueError("force_balance is that of one mass: with load.kind = 'compliant' or 'lever' leave it out")
    oil = cylinder.area_lower * columns["p_lower"] - cylinder.area_upper * columns["p_upper"]
    inertia = columns["mass"] * (load.gravity + np.gradient(columns["velocity"], time))
    around = _around(columns, surroundings(load))
    return (oil - inertia + load.force + around + columns["friction"]) / cylinder.area_lower


def _around(columns: Columns, around: Environment) -> Array:
    """Force [N] of springs and dampers on the load."""
    v = columns["velocity"]
    dampers = (around.viscous + around.quadratic * np.abs(v)) * v
    return -around.stiffness * (columns["position"] - around.neutral) - dampers


def speed_balance(_: Array, columns: Columns, circuit: Circuit) -> Array:
    """v - (Q_pump - Q_relief - leak)/A_l [m/s]: the piston rises as the pump at its pressure gives."""
    given = columns["flow_pump"] - columns["flow_relief"] - _leak(columns, circuit)
    return columns["velocity"] - given / circuit.parts.cylinder.area_lower


def sink_balance(_: Array, columns: Columns, circuit: Circuit) -> Array:
    """v + leak/(A_l (1 + p_l/B)) [m/s]: a shut-in load sinks as the leaks let it; without p_l/B for a motor."""
    cylinder, modulus = circuit.parts.cylinder, interpreted(moduli)(circuit.parts.cylinder).lower
    swept = cylinder.area_lower * (1.0 + interpreted(widening)(cylinder) * columns["p_lower"] / modulus)
    return columns["velocity"] + _leak(columns, circuit) / swept


def _leak(columns: Columns, circuit: Circuit) -> Array:
    """What the lower chamber loses across the piston and to the outside [m^3/s]."""
    cylinder, p = circuit.parts.cylinder, columns["p_lower"]
    return cylinder.leakage * (p - columns["p_upper"]) + _drained(p, cylinder) * p


def _drained(pressure: Array, actuator: Actuator) -> Array | float:
    """Flow per pressure [m^3/(s Pa)] from the lower chamber to the outside; of a hole it depends on the pressure."""
    drain = interpreted(outside)
    if isinstance(actuator, HoledCylinder):
        return np.array([drain(actuator, Chambers(p, 0.0)).lower for p in pressure.tolist()])
    return drain(actuator, Chambers(0.0, 0.0)).lower


BALANCES: dict[str, Callable[[Array, Columns, Circuit], Array]] = {
    "force_balance": force_balance,
    "speed_balance": speed_balance,
    "sink_balance": sink_balance,
}


def moments(time: Array, columns: Columns, circuit: Circuit) -> dict[str, float]:
    """When [s] the piston met the weight, ran into its upper stop; NaN for what did not happen."""
    load, stroke = circuit.parts.load, circuit.parts.cylinder.stroke
    position = columns["position"]
    met = np.zeros(len(position), bool)
    if isinstance(load, Load) and load.added > 0.0:
        met = position >= load.support
    ends = isinstance(circuit.parts.stops, Stops)
    return {"contact": _onset(time, met), "impact": _onset(time, ends & (position >= stroke - REACHED))}


def _onset(time: Array, happening: NDArray[np.bool_]) -> float:
    """When something first happens that did not at the start; NaN for never."""
    first = int(np.argmax(happening))
    return float(time[first]) if happening.any() and first > 0 else float("nan")
