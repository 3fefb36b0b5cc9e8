"""Gear pump: flow from the tooth geometry with its ripple, less a leakage in proportion to pressure.

Source: (2.103), (2.104). `Q(t) = B omega [m^2 (z + 1) - x(t)^2]`: the point of contact x runs from -x_m to x_m,
x_m = pi m cos(alpha)/2, once per tooth. Flow is counted at delivery pressure, as the rig's was (from the speed of the
piston).
"""

import math
from typing import NamedTuple, Protocol

from twin.kernel import inlined


class Pump(NamedTuple):
    """A pump at constant speed, once it has run up."""

    delivery: float  # mean, at full speed and zero pressure [m^3/s]
    leakage: float  # [m^3/(s Pa)]
    tooth_frequency: float  # z n [Hz]
    ripple: float  # 2 pi B x_m^2/z [m^3]; 0.0 for the mean flow alone
    run_up: float  # from standstill at time 0, at constant acceleration [s]; 0.0: it runs already


class RunsUp(Protocol):
    """What runs up from standstill."""

    @property
    def run_up(self) -> float: ...


def displacement(width: float, module: float, teeth: float, pressure_angle: float) -> float:
    """Mean volume per revolution [m^3], (2.103); lengths in m, the pressure angle in rad."""
    gear = teeth + 1.0 - math.pi**2 / 12.0 * math.cos(pressure_angle) ** 2
    return 2.0 * math.pi * width * module**2 * gear


def ripple_volume(width: float, module: float, teeth: float, pressure_angle: float) -> float:
    """2 pi B x_m^2/z [m^3]: how far x(t)^2 takes the volume of one tooth from an even flow, (2.104)."""
    reach = 0.5 * math.pi * module * math.cos(pressure_angle)
    return 2.0 * math.pi * width * reach**2 / teeth


@inlined
def speed_ratio(time: float, pump: RunsUp) -> float:
    """Speed at a time [s] over full speed."""
    return min(1.0, time / pump.run_up) if pump.run_up > 0.0 else 1.0


@inlined
def pump_flow(pressure: float, ratio: float, pump: Pump) -> float:
    """Mean delivered flow [m^3/s] at a delivery pressure [Pa] and a ratio of full speed."""
    return pump.delivery * ratio - pump.leakage * pressure


@inlined
def pumped_oil(pressure: float, ratio: float, pump: Pump, bulk_modulus: float) -> tuple[float, float]:
    """The same as oil at reference density [m^3/s], (1 + p/B) Q(p), and its slope [m^3/(s Pa)]."""
    density_ratio = 1.0 + pressure / bulk_modulus
    flow = pump_flow(pressure, ratio, pump)
    return flow * density_ratio, flow / bulk_modulus - pump.leakage * density_ratio


@inlined
def ripple_flow(time: float, window: float, pump: Pump) -> float:
    """What the teeth add to the mean flow [m^3/s], averaged over a window [s] that ends at a time [s].

    An average of the exact volume, so that the displacement is met whatever the step.
    """
    if pump.ripple == 0.0:
        return 0.0
    return pump.ripple * (_surplus(teeth_passed(time, pump)) - _surplus(teeth_passed(time - window, pump))) / window


@inlined
def teeth_passed(time: float, pump: Pump) -> float:
    """Teeth since time 0, when one begins."""
    lost = 0.5 * pump.run_up
    if time < pump.run_up:
        return pump.tooth_frequency * 0.5 * time * abs(time) / pump.run_up
    return pump.tooth_frequency * (time - lost)


@inlined
def _surplus(teeth: float) -> float:
    """Volume beyond an even flow after some teeth, over `ripple`: f/3 - ((2f - 1)^3 + 1)/6, f the part of a tooth."""
    f = teeth - math.floor(teeth)
    return f * (f * (2.0 - 4.0 / 3.0 * f) - 2.0 / 3.0)
