"""The circuit as one ordinary differential equation: lumped lines, steady relief valve, mean flow of the pump.

It states once more, without time steps, what `circuit` integrates when its lines are lumped: any integrator of the
reader's choice can check the scheme against it, and `linear` takes its slopes. Fittings and what the return line ends
in count to their line's own resistance, an accumulator's gas to the capacity of its place, its inlet left out. Relief
valve and swash plate follow their steady curves. A line of one volume has the inertance of its scheme and the
resistance beside it (`lines/volume.py`): the flow at its ends is Q + h Q'/2. Left out is what has no rate: end stops,
limits of the spool, cavities, the weight that joins, check valves that shut, and the set-valued seal friction, in whose
place a viscous slope may stand; and what a wall gives late.
"""

import numpy as np
from numpy.typing import NDArray

from twin.accumulator import gas_capacity
from twin.actuator import areas, moduli, outside, volumes, widening
from twin.air import compression, tangent
from twin.check_valve import cracking_drop_of
from twin.circuit.state import Flows, Pressures
from twin.circuit.step import Circuit
from twin.cylinder import Chambers
from twin.directional_valve import Spool, force_at, land_orifice, lands_at, leaks_at, spool_rates
from twin.fitting import fitting_resistance
from twin.kernel import inlined, kernel
from twin.lands import Lands
from twin.lines.bank import VOLUME, steady_drop, unpacked
from twin.load_slot import acceleration
from twin.minor_losses import minor_drop
from twin.orifice import flow
from twin.relief.slot import steady_relief
from twin.return_end import return_drop
from twin.supply import steady_supply
from twin.topology import LINES, PIPES, PLACES

STATES = (
    *(f"p_{place}" for place in Pressures._fields),
    *Flows._fields,
    "position",
    "velocity",
    "spool",
    "spool_velocity",
)
Array = NDArray[np.float64]
PUMP, TEE, P, A, LOWER, UPPER, B, T, BACK = range(len(PLACES))
FLOW = len(PLACES)
X, V, S, S_RATE = range(FLOW + LINES, len(STATES))
LINE_ENDS = tuple(tuple([*PLACES].index(end) if end in PLACES else -1 for end in pipe) for pipe in PIPES.values())


def vector_rates(
    y: NDArray[np.float64], reference: float, circuit: Circuit, viscous: float = 0.0
) -> NDArray[np.float64]:
    """Rates of STATES [SI per s] under a spool reference; viscous: friction over speed [N s/m]."""
    from twin.circuit.block import compiled

    out = np.empty(len(STATES))
    rates(np.asarray(y, float), reference, *compiled(circuit), viscous, out)
    return out


@kernel
def rates(y, reference: float, parts, whole, numbers, viscous: float, out) -> None:
    """Fill `out` with the rates of a vector of STATES; parts, whole, numbers: of `Compiled`."""
    c, lines = parts[0], unpacked(whole, numbers)
    _inflows(y, c, out)
    for line in range(LINES):
        first, second = LINE_ENDS[line]
        drop = y[first] - (y[second] if second >= 0 else 0.0)
        if line == 1:
            drop -= cracking_drop_of(c.check) + fitting_resistance(y[FLOW + 1], c.fitting) * y[FLOW + 1]
        if second < 0:
            drop -= return_drop(c.return_end, y[FLOW + line])
        drop -= minor_drop(c.losses, line, y[FLOW + line])
        rate = (drop - steady_drop(lines, line, y[FLOW + line])) / lines.inertance[line]
        through = y[FLOW + line] + (0.5 * lines.step * rate if lines.model[line] == VOLUME else 0.0)
        out[FLOW + line] = rate
        out[first] -= through
        if second >= 0:
            out[second] += through
    b, area, air = moduli(c.cylinder), areas(c.cylinder, y[X]), c.cylinder.air
    wide = widening(c.cylinder) == 1.0
    out[LOWER] -= area.lower * (compression(air, b.lower, y[LOWER]) if wide else 1.0) * y[V]
    out[UPPER] += area.upper * (compression(air, b.upper, y[UPPER]) if wide else 1.0) * y[V]
    for place in range(FLOW):
        out[place] /= _capacity(place, y[X], y[place], c, lines)
    out[X] = y[V]
    out[V] = acceleration(c.load, area.lower * y[LOWER] - area.upper * y[UPPER], y[X], y[V], viscous)
    force = force_at(c.valve, _land_drops(y), lands_at(c.valve, y[S]))
    moved = spool_rates(c.valve, Spool(y[S], y[S_RATE]), reference, force)
    out[S], out[S_RATE] = moved.position, moved.velocity


@inlined
def _land_drops(y) -> Lands:
    """Pressure drop over each land [Pa]."""
    return Lands(y[P] - y[A], y[B] - y[T], y[P] - y[B], y[A] - y[T], y[P] - y[T])


@kernel
def _inflows(y, c, out) -> None:
    """What the components bring into each place [m^3/s]."""
    area, leaks, drop, orifice = lands_at(c.valve, y[S]), leaks_at(c.valve, y[S]), _land_drops(y), land_orifice(c.valve)
    p_a = flow(drop.p_a, area.p_a, orifice, c.oil) + leaks.p_a * drop.p_a
    b_t = flow(drop.b_t, area.b_t, orifice, c.oil) + leaks.b_t * drop.b_t
    p_b = flow(drop.p_b, area.p_b, orifice, c.oil) + leaks.p_b * drop.p_b
    a_t = flow(drop.a_t, area.a_t, orifice, c.oil) + leaks.a_t * drop.a_t
    leak = c.cylinder.leakage * (y[LOWER] - y[UPPER])
    out[PUMP] = steady_supply(c.supply, y[PUMP], 1.0, c.oil)[0]
    out[TEE] = -steady_relief(c.relief, y[TEE])
    out[P], out[A], out[B], out[T], out[BACK] = -p_a - p_b, p_a - a_t, p_b - b_t, b_t + a_t, 0.0
    drained = outside(c.cylinder, Chambers(y[LOWER], y[UPPER]))
    out[LOWER], out[UPPER] = -leak - drained.lower * y[LOWER], leak - drained.upper * y[UPPER]


@kernel
def capacities(y, parts, whole, numbers, out) -> None:
    """Fill `out` with the oil per pressure [m^3/Pa] at the PLACES, at a vector of STATES."""
    for place in range(FLOW):
        out[place] = _capacity(place, y[X], y[place], parts[0], unpacked(whole, numbers))


@inlined
def _capacity(place: int, position: float, pressure: float, c, lines) -> float:
    """Oil per pressure [m^3/Pa] at a place: half of each line that ends there, its chamber, its accumulator's gas."""
    total = 0.0
    for line in range(LINES):
        if LINE_ENDS[line][0] == place or LINE_ENDS[line][1] == place:
            total += 0.5 * lines.capacity[line]
    volume, b, air = volumes(c.cylinder, position), moduli(c.cylinder), c.cylinder.air
    if place == LOWER:
        total += tangent(air, b.lower, volume.lower, pressure)[0]
    if place == UPPER:
        total += tangent(air, b.upper, volume.upper, pressure)[0]
    if place == TEE:
        total += gas_capacity(c.tee_accumulator, pressure)
    if place == P:
        total += gas_capacity(c.p_accumulator, pressure)
    return total
