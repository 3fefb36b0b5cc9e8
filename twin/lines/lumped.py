"""Lumped line: half of the oil at each end, its inertia and steady friction between them.

The first mode of a real line is met 10 % low when one end is open (quarter wave), 36 % low when both are shut; a
chamber at an end brings it closer. Waves are not met. Friction is laminar (Hagen-Poiseuille) up to Re 2300
and turns into Blasius' law by Re 4000 (assumed: linear in between). What sits in the line (a filter) adds to its
resistance.
"""

import math
from typing import NamedTuple

from twin.kernel import kernel

LAMINAR_LIMIT = 2300.0  # Re, Hagen-Poiseuille below
TURBULENT_LIMIT = 4000.0  # Re, Blasius above


class LumpedLine(NamedTuple):
    """One pipe or hose."""

    end_volume: float  # half of the line's oil [m^3], at each end
    end_capacity: float  # the same over the effective bulk modulus [m^3/Pa]
    inertance: float  # rho L/A [Pa s^2/m^3]
    resistance: float  # laminar, 128 mu L/(pi d^4) [Pa s/m^3]
    reynolds_per_flow: float  # 4/(pi d nu) [s/m^3]
    fitting: float  # linear resistance of what sits in the line [Pa s/m^3]


def lumped_line(
    length: float, diameter: float, modulus: float, density: float, viscosity: float, fitting: float
) -> LumpedLine:
    """A line from its length, inner diameter [m], effective bulk modulus [Pa], oil and fittings [Pa s/m^3]."""
    area = math.pi / 4.0 * diameter**2
    half = 0.5 * area * length
    return LumpedLine(
        end_volume=half,
        end_capacity=half / modulus,
        inertance=density * length / area,
        resistance=128.0 * density * viscosity * length / (math.pi * diameter**4),
        reynolds_per_flow=4.0 / (math.pi * diameter * viscosity),
        fitting=fitting,
    )


@kernel
def turbulence(reynolds: float) -> float:
    """Friction over laminar friction: 1 up to Re 2300, Blasius 0.3164 Re^0.75/64 from Re 4000."""
    if reynolds <= LAMINAR_LIMIT:
        return 1.0
    blasius = 0.3164 * max(reynolds, TURBULENT_LIMIT) ** 0.75 / 64.0
    share = min(1.0, (reynolds - LAMINAR_LIMIT) / (TURBULENT_LIMIT - LAMINAR_LIMIT))
    return 1.0 + share * (blasius - 1.0)


@kernel
def line_resistance(flow: float, line: LumpedLine) -> float:
    """Pressure drop over flow [Pa s/m^3] at a steady flow [m^3/s]."""
    return line.resistance * turbulence(abs(flow) * line.reynolds_per_flow) + line.fitting


@kernel
def resistance_slope(flow: float, line: LumpedLine) -> float:
    """Slope of the pressure drop by the flow [Pa s/m^3] at a steady flow [m^3/s]."""
    reynolds = abs(flow) * line.reynolds_per_flow
    factor = turbulence(reynolds)
    if reynolds > TURBULENT_LIMIT:
        factor *= 1.75
    elif reynolds > LAMINAR_LIMIT:
        factor += (factor - 1.0) * reynolds / (reynolds - LAMINAR_LIMIT)
    return line.resistance * factor + line.fitting


@kernel
def accelerate(flow: float, drop: float, line: LumpedLine, time: float) -> float:
    """Flow [m^3/s] after a time [s] under a constant pressure drop [Pa]: trapezoidal rule, linearised friction."""
    net = drop - line_resistance(flow, line) * flow
    return flow + time * net / (line.inertance + 0.5 * time * resistance_slope(flow, line))
