"""Small swings of the relief valve's pilot in the rig at rest, by linear theory with both lines as they are.

At the tee the valve sees line 1, behind it the pump that leaks, and beside it line 2 to the shut valve behind its
fittings. Both are exact and laminar: steady flow in line 1 changes their damping little at the pilot's 1.6 kHz.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from twin.circuit.equilibrium import supply_at_rest
from twin.circuit.step import Circuit
from twin.lines.theory import losses
from twin.minor_losses import loss_at_end
from twin.pump import pumped_oil
from twin.relief.pilot_theory import swings_with_lines


def line_admittance(s: complex, line: int, diameter: float, beyond: complex, circuit: Circuit) -> complex:
    """Y(s) [m^3/(s Pa)] at one end of a line with an admittance beyond its other end."""
    z0, travel = float(circuit.lines.z0[line]), float(circuit.lines.travel_time[line])
    n = np.sqrt(losses(np.complex128(s), diameter**2 / (4.0 * circuit.parts.oil.viscosity), "unsteady"))
    own, through = 1.0 / (z0 * n), np.tanh(s * travel * n)
    return complex(own * (beyond + own * through) / (own + beyond * through))


def pilot_swings(rig: Mapping[str, Any], circuit: Circuit) -> list[tuple[float, float]]:
    """Growth [1/s] and frequency [Hz] of the oscillations of the rig's pilot at rest, the fastest growing first.

    Raises ValueError where the relief valve is shut.
    """
    parts, supply = circuit.parts, supply_at_rest(circuit)
    leakage = -pumped_oil(supply.pump, 1.0, parts.pump, parts.oil.bulk_modulus)[1]
    lost = 2.0 * loss_at_end(parts.losses, 0) * (supply.relieved + supply.idle)
    first, second = (float(rig[pipe]["diameter"]) for pipe in ("pipe_1", "pipe_2"))

    def impedance(s: complex) -> complex:
        supplied = line_admittance(s, 0, first, leakage / (1.0 + lost * leakage), circuit)
        behind = line_admittance(s, 1, second, 0.0, circuit)
        return 1.0 / (supplied / (1.0 + lost * supplied) + behind / (1.0 + parts.fitting.linear * behind))

    return swings_with_lines(supply.tee, impedance, parts.relief)
