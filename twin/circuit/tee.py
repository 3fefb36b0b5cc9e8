"""The tee: lines 1 and 2, that of the relief valve if it has one, the valve, the accumulator, and the fittings before
line 2 with their check valve.

The relief valve comes first, against the port that all others make with the flows of the instant before; then they take
what it takes, each by its own law. `parts` are those of a step.
"""

from typing import Any, NamedTuple

from twin.accumulator import fill_accumulator, is_fitted, taken, with_accumulator
from twin.check_valve import CheckValve, NoCheck, before_check, is_check, passes
from twin.circuit.ends import RELIEF_END, TEE_1, TEE_2, VALVE_END, Ends, Slots, deliver, port_at, set_pressure
from twin.fitting import fitting_resistance
from twin.kernel import by_type, inlined
from twin.port import Port, joined, pressure, with_cavity
from twin.relief.motion import Motion
from twin.relief.slot import move_relief


class AtTee(NamedTuple):
    """The relief valve sits at the tee."""


class OwnLine(NamedTuple):
    """The relief valve sits at the end of a line of its own."""

    volume: float  # of the line [m^3]


@inlined
def line_2(ends: Ends, parts: Any) -> Port:
    """What the tee sees of line 2 through the fittings: the cavity behind them, if any."""
    resistance = fitting_resistance(ends.flow[TEE_2], parts.fitting)
    if ends.cavity[TEE_2] > 0.0 and resistance > 0.0:
        return Port(parts.oil.vapour_pressure, resistance)
    return Port(ends.free[TEE_2], ends.impedance[TEE_2] + resistance)


@by_type
def tee_port(check: Any, feeding: Port, brought: float, ends: Ends, parts: Any, slots: Slots) -> tuple[Port, bool]:
    """The tee's port but for the accumulator, and whether line 2 is open to it; feeding: its other lines.

    brought: flow of the relief valve into the tee [m^3/s].
    """
    raise TypeError(f"{check} is not a check valve")


@tee_port.register
def _(check: NoCheck, feeding: Port, brought: float, ends: Ends, parts: Any, slots: Slots) -> tuple[Port, bool]:
    behind = line_2(ends, parts)
    port = joined(feeding.free, feeding.impedance, behind.free, behind.impedance)
    return with_cavity(port, ends.cavity[TEE_1], parts.step), True


@tee_port.register
def _(check: CheckValve, feeding: Port, brought: float, ends: Ends, parts: Any, slots: Slots) -> tuple[Port, bool]:
    """What the tee would be with the valve shut decides."""
    behind, alone = line_2(ends, parts), with_cavity(feeding, ends.cavity[TEE_1], parts.step)
    drawn = taken(parts.tee_accumulator, alone, brought, slots.accumulator, parts.oil, parts.step)
    if not passes(check, pressure(alone, brought - drawn, parts.oil.vapour_pressure), behind):
        return alone, False
    met = before_check(check, behind)
    return joined(alone.free, alone.impedance, met.free, met.impedance), True


@inlined
def tee_side(feeding: Port, brought: float, ends: Ends, parts: Any, slots: Slots) -> float:
    """Accumulator and lines at the tee take what the relief valve brings [m^3/s], < 0 as it takes; the pressure."""
    rest, is_open = tee_port(parts.check, feeding, brought, ends, parts, slots)
    drawn = fill_accumulator(parts.tee_accumulator, rest, brought, slots.accumulator, parts.oil, parts.step)
    p = deliver(TEE_1, rest, brought - drawn, ends, parts)
    met = before_check(parts.check, line_2(ends, parts))
    through = (p - met.free) / met.impedance if is_open else 0.0
    deliver(TEE_2, port_at(TEE_2, ends, parts.step), through, ends, parts)
    return p


@inlined
def relief_before(before: float, port: Port, flow: float, ends: Ends, parts: Any) -> float:
    """port.free of the last instant as of today's impedance, where that changes; flow: the relief valve's then."""
    if is_fitted(parts.tee_accumulator) or is_check(parts.check):
        return ends.pressure[TEE_1] + port.impedance * flow
    return before


@by_type
def relief_side(
    place: Any, relief: Motion, before: float, ends: Ends, parts: Any, slots: Slots
) -> tuple[Motion, float]:
    """Tee and relief valve, and the pressure its port would have without it; before: that of the last instant."""
    raise TypeError(f"{place} is not a place of the relief valve")


@relief_side.register
def _(place: AtTee, relief: Motion, before: float, ends: Ends, parts: Any, slots: Slots) -> tuple[Motion, float]:
    feeding = Port(ends.free[TEE_1], ends.impedance[TEE_1])
    rest, _ = tee_port(parts.check, feeding, -relief.flow, ends, parts, slots)
    port = with_accumulator(parts.tee_accumulator, rest, slots.accumulator, parts.oil, parts.step)
    before = relief_before(before, port, relief.flow, ends, parts)
    relief = move_relief(parts.relief, relief, before, port, slots.relief, parts.step)
    tee_side(feeding, -relief.flow, ends, parts, slots)
    return relief, port.free


@relief_side.register
def _(place: OwnLine, relief: Motion, before: float, ends: Ends, parts: Any, slots: Slots) -> tuple[Motion, float]:
    own = port_at(VALVE_END, ends, parts.step)
    relief = move_relief(parts.relief, relief, before, own, slots.relief, parts.step)
    deliver(VALVE_END, own, -relief.flow, ends, parts)
    feeding = joined(ends.free[TEE_1], ends.impedance[TEE_1], ends.free[RELIEF_END], ends.impedance[RELIEF_END])
    set_pressure(RELIEF_END, tee_side(feeding, 0.0, ends, parts, slots), ends)
    return relief, own.free
