"""Small swings of the relief valve's pilot in the rig at rest, by linear theory with both lines as they are.

At the tee the valve sees line 1, behind it the pump that leaks, and beside it line 2 to the shut valve behind its
fittings. Both are exact and laminar: steady flow in line 1 changes their damping little at the pilot's 1.6 kHz.
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit.equilibrium import supply_at_rest
from twin.circuit.kinds import of_kind
from twin.circuit.step import Circuit
from twin.lines.bank import VOLUME
from twin.lines.theory import losses
from twin.minor_losses import loss_at_end
from twin.relief.pilot_theory import swings_with_lines
from twin.relief.steady import steady_pressure
from twin.relief.valve import Relief
from twin.supply import steady_supply

Array = NDArray[Any]
SCANNED, HALVINGS = 10, 6  # flows from that at rest down to none, and how often the edge between two is halved


def line_admittance(s: Array, line: int, diameter: float, beyond: Array | float, circuit: Circuit) -> Array:
    """Y(s) [m^3/(s Pa)] at one end of a line with an admittance beyond its other end."""
    if circuit.lines.model[line] == VOLUME:
        return beyond + s * float(circuit.lines.capacity[line])
    z0, travel = float(circuit.lines.z0[line]), float(circuit.lines.travel_time[line])
    n = np.sqrt(losses(s, diameter**2 / (4.0 * circuit.parts.oil.viscosity), "unsteady"))
    own, through = 1.0 / (z0 * n), np.tanh(s * travel * n)
    return own * (beyond + own * through) / (own + beyond * through)


def pilot_swings(rig: Mapping[str, Any], circuit: Circuit, flow: float | None = None) -> list[tuple[float, float]]:
    """Growth [1/s] and frequency [Hz] of the oscillations of the rig's pilot at rest, the fastest growing first.

    flow: over the relief valve [m^3/s]; None: what the pump sends over it with the valve at rest. Raises ValueError
    where the relief valve is shut, or has no pilot.
    """
    parts, supply = circuit.parts, supply_at_rest(circuit)
    valve = of_kind(parts.relief, Relief)
    tee, over = (supply.tee, supply.relieved) if flow is None else (steady_pressure(flow, valve), flow)
    leakage = -steady_supply(parts.supply, supply.pump, 1.0, parts.oil)[1]
    lost = 2.0 * loss_at_end(parts.losses, 0) * (over + supply.idle)
    first, second = (float(rig[pipe]["diameter"]) for pipe in ("pipe_1", "pipe_2"))

    def impedance(s: Array) -> Array:
        supplied = line_admittance(s, 0, first, leakage / (1.0 + lost * leakage), circuit)
        behind = line_admittance(s, 1, second, 0.0, circuit)
        return 1.0 / (supplied / (1.0 + lost * supplied) + behind / (1.0 + parts.fitting.linear * behind))

    return swings_with_lines(tee, impedance, valve)


class SelfExcited(NamedTuple):
    """The pilot's own oscillation at the flow over the relief valve with the directional valve at rest."""

    growth: float  # [1/s]
    frequency: float  # [Hz]
    flow: float  # [m^3/s]
    least: float  # flow down to which it grows [m^3/s]


def self_excited(rig: Mapping[str, Any], circuit: Circuit) -> SelfExcited | None:
    """What grows by itself; None where nothing does, or nothing flows over the relief valve."""
    flow = supply_at_rest(circuit).relieved
    if not isinstance(circuit.parts.relief, Relief) or flow <= 0.0:
        return None
    growth, frequency = _fastest(rig, circuit, flow)
    if growth <= 0.0:
        return None
    below = next((tried for tried in _smaller(flow) if _fastest(rig, circuit, tried)[0] <= 0.0), 0.0)
    above = below + flow / SCANNED if below > 0.0 else 0.0
    return SelfExcited(growth, frequency, flow, _edge(below, above, rig, circuit))


def swings_below(rig: Mapping[str, Any], circuit: Circuit) -> tuple[float, float] | None:
    """Of a pilot that is calm at rest: the flow [m^3/s] below which it oscillates, and its frequency [Hz] there.

    None where it is calm at smaller flows, too, swings at rest, or is none.
    """
    flow = supply_at_rest(circuit).relieved
    if not isinstance(circuit.parts.relief, Relief) or flow <= 0.0 or _fastest(rig, circuit, flow)[0] > 0.0:
        return None
    swinging = next((tried for tried in _smaller(flow) if _fastest(rig, circuit, tried)[0] > 0.0), None)
    if swinging is None:
        return None
    edge = _edge(swinging, swinging + flow / SCANNED, rig, circuit)
    return edge, _fastest(rig, circuit, edge)[1]


def _smaller(flow: float) -> Iterator[float]:
    return (flow * share / SCANNED for share in range(1, SCANNED)[::-1])


def _edge(below: float, above: float, rig: Mapping[str, Any], circuit: Circuit) -> float:
    """Where between two flows the pilot changes from calm to swinging or back, by halving; 0.0 of two zeros."""
    if above == 0.0:
        return 0.0
    grows = _fastest(rig, circuit, below)[0] > 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (below + above)
        same = (_fastest(rig, circuit, middle)[0] > 0.0) == grows
        below, above = (middle, above) if same else (below, middle)
    return 0.5 * (below + above)


def _fastest(rig: Mapping[str, Any], circuit: Circuit, flow: float) -> tuple[float, float]:
    return max(pilot_swings(rig, circuit, flow), default=(0.0, 0.0))
