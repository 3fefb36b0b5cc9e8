"""Direct-operated pressure relief valve: a poppet on a spring, as a static characteristic and a first-order lag.

    Q = x sqrt(p),   T x' = x_s - x,   x_s = (y - p_c)/(s + f y),   x >= 0

x is the opening in flow per root of pressure, p_c the cracking pressure. s is the spring, f the flow force that shuts
it: both in pressure per opening, so that at a rated flow Q_r the pressure is p_c + dp_r, the override, of which the
flow force has a share:

    x_r = Q_r/sqrt(p_r),   p_r = p_c + dp_r,   s = (1 - share) dp_r/x_r,   f = share dp_r/(x_r p_r).

Friction on the poppet is a play: y follows p upwards at once, and downwards behind it by the hysteresis, so that the
valve cracks at p_c and shuts that much lower. At its stop the poppet stays at once. A shut valve passes exactly 0.0; an
open one only takes energy, p Q >= 0. The tank is at 0 and nothing comes back from it.

A step: x by the lag of `lag.py` against x_s before and after it, p = c - Z x sqrt(p) by Newton within a bracket. The
left side rises with p, since x does: there is one answer.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

from numpy.typing import NDArray

from twin.kernel import inlined
from twin.lag import Lag, lag_over
from twin.port import Port

MEMORY = ("opening", "play", "wanted")  # x; y [Pa]; x_s
OPENING, PLAY, WANTED = range(3)
ITERATIONS = 60  # enough for halvings alone
CLOSE = 1e-13  # of the pressure


class DirectRelief(NamedTuple):
    """The valve with a lag made for a step."""

    cracking_pressure: float  # p_c [Pa]
    spring: float  # s [Pa per opening]
    flow_force: float  # f [1 per opening]
    hysteresis: float  # [Pa]
    time: float  # T [s]
    lag: Lag


def direct_relief(valve: Mapping[str, Any], step: float) -> DirectRelief:
    """The valve of a rig's numbers: its cracking pressure, and the override at the rated flow."""
    cracking, override = valve["cracking_pressure"], valve["override"]
    share, rated = valve["flow_force_share"], valve["rated_flow"] / math.sqrt(cracking + override)
    spring, flow_force = (1.0 - share) * override / rated, share * override / (rated * (cracking + override))
    time = valve["time_constant"]
    return DirectRelief(cracking, spring, flow_force, valve["hysteresis"], time, lag_over(time / step))


@inlined
def played(pressure: float, before: float, valve: DirectRelief) -> float:
    """y [Pa] once the pressure is there; before: y until then."""
    return min(max(before, pressure), pressure + valve.hysteresis)


@inlined
def wanted_opening(y: float, valve: DirectRelief) -> float:
    """x_s, below 0 where the spring presses the poppet on its seat; it rises with y."""
    return (y - valve.cracking_pressure) / (valve.spring + valve.flow_force * max(0.0, y))


@inlined
def opened(pressure: float, held: float, play: float, valve: DirectRelief) -> float:
    """x at a pressure [Pa] at the step's end; held: what the lag keeps."""
    return max(0.0, held + valve.lag.after * wanted_opening(played(pressure, play, valve), valve))


@inlined
def direct_flow(port: Port, memory: NDArray, valve: DirectRelief) -> float:
    """Q [m^3/s] out of a port at the step's end, and the valve moved there."""
    held, play = valve.lag.kept * memory[OPENING] + valve.lag.before * memory[WANTED], memory[PLAY]
    p = _pressure(port, held, play, valve)
    x = opened(p, held, play, valve)
    y = played(p, play, valve)
    memory[OPENING], memory[PLAY], memory[WANTED] = x, y, wanted_opening(y, valve)
    return x * math.sqrt(max(0.0, p))


@inlined
def _pressure(port: Port, held: float, play: float, valve: DirectRelief) -> float:
    """p [Pa] at the step's end. Shut, it is the port's own: that case comes first."""
    p, low, high = port.free, 0.0, port.free
    if p <= 0.0 or opened(p, held, play, valve) == 0.0:
        return p
    for _ in range(ITERATIONS):
        root, x = math.sqrt(p), opened(p, held, play, valve)
        excess = p + port.impedance * x * root - port.free
        if excess > 0.0:
            high = p
        else:
            low = p
        slope = 1.0 + port.impedance * (0.5 * x / root + _widening(p, x, valve) * root)
        last, p = p, p - excess / slope
        if not low <= p <= high:
            p = 0.5 * (low + high)
        if abs(p - last) <= CLOSE * high:
            break
    return p


@inlined
def _widening(pressure: float, opening: float, valve: DirectRelief) -> float:
    """Slope of x by the pressure, without the play's: a guide for Newton, the bracket has the last word."""
    return valve.lag.after / (valve.spring + valve.flow_force * pressure) if opening > 0.0 else 0.0


@inlined
def steady_direct(pressure: float, valve: DirectRelief) -> float:
    """Q [m^3/s] at a steady pressure [Pa], reached from below."""
    return max(0.0, wanted_opening(pressure, valve)) * math.sqrt(max(0.0, pressure))


@inlined
def direct_slope(pressure: float, valve: DirectRelief) -> float:
    """dQ/dp [m^3/(s Pa)] of that; 0.0 when shut."""
    x = wanted_opening(pressure, valve)
    if x <= 0.0 or pressure <= 0.0:
        return 0.0
    widening = (1.0 - x * valve.flow_force) / (valve.spring + valve.flow_force * pressure)
    return widening * math.sqrt(pressure) + 0.5 * x / math.sqrt(pressure)


@inlined
def begin_direct(pressure: float, memory: NDArray, valve: DirectRelief) -> None:
    """At rest at a pressure [Pa] that was reached from below."""
    x = wanted_opening(pressure, valve)
    memory[OPENING], memory[PLAY], memory[WANTED] = max(0.0, x), pressure, x
