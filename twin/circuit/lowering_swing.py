"""Linear theory of a load that a counterbalance valve lowers: does it swing, and how fast?

In Laplace's s, small changes about a `lowering`; W the speed towards the held chamber h, d the driven one, Q out of h:

    (m s + c + k/s) W = A_d P_d - A_h P_h
    (V_h s - A_h w) c_h' P_h = A_h c_h W - Q - g (P_h - P_d) - g_h P_h
    (V_d s + A_d w) c_d' P_d = -A_d c_d W + (P_pilot - P_d)/R + g (P_h - P_d) - g_d P_d
    Q = k_x X + k_p (P_h - P_line) = Y_line(s) P_line                         (P_pilot - P_d)/R = -Y_pilot(s) P_pilot
    (m_v s^2 + d_v s + k_v) X = A_v (P_h + r P_pilot/(1 + T s) - w_v P_line)  or a lag; X = 0 at a stop

c_h, c_d and g as in `chambers.py`, c' the slope of c by the pressure. Y are the admittances of both lines from the
cylinder's ends on, exact or as their model has them: with the lands of the directional valve behind them, the return
lines to the tank, and the supply with pump and relief valve. Friction of the seals is left out, cushions and
accumulators too; a link counts as rigid, and a lever's mass as that of its place.
Cf. Merritt, Hydraulic Control Systems, 1967, ch. 6 and 8, for the elements.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.accessory import between
from twin.circuit.chambers import pair_at
from twin.circuit.lowering import Lowering, drop_into
from twin.circuit.step import Circuit
from twin.counterbalance import Counterbalance, opening_force
from twin.directional_valve import land_orifice, lands_at
from twin.fitting import fitting_slope
from twin.kernel import interpreted
from twin.lines.bank import LUMPED, VOLUME
from twin.lines.bank import steady_slope as line_slope
from twin.lines.spec import LOSSES
from twin.lines.theory import losses
from twin.load_at_rest import moved_weight, rigid_mass, surroundings
from twin.load_slot import AnyLoad
from twin.minor_losses import loss_at_end
from twin.orifice import flow_slopes, resistance
from twin.relief.pilot_theory import roots
from twin.relief.slot import steady_relief
from twin.supply import steady_supply
from twin.topology import PIPES
from twin.valve_body import Mass

Array = NDArray[Any]
OPEN_END = 1e3  # [m^3/(s Pa)], admittance of the tank
SPANS = ((0.5, 30.0, 0.5), (30.0, 300.0, 3.0), (300.0, 2000.0, 10.0))  # [Hz], from, to, spacing
STARTS = 2.0 * math.pi * np.concatenate([np.arange(*span) for span in SPANS])  # [rad/s], of the search
HIGHEST = 2.0 * math.pi * 2000.0  # [rad/s], of the oscillations looked for
SMALL = 1e-6  # [m], for the slope of a load's force by its place


class Swing(NamedTuple):
    """An oscillation about a steady lowering."""

    growth: float  # [1/s]
    frequency: float  # [Hz]


class Valve(NamedTuple):
    """The valve that holds, about a lift."""

    by_lift: float  # k_x [m^2/s]
    by_drop: float  # k_p [m^3/(s Pa)]
    lift: float  # [m]
    travelling: bool  # between its stops


def about(at: Lowering, circuit: Circuit) -> Valve:
    """The slopes of the valve's flow. Raises ValueError for a valve that is not a counterbalance valve."""
    valve, oil = getattr(between(circuit.parts.necks), at.held), circuit.parts.oil
    if not isinstance(valve, Counterbalance):
        raise ValueError(f"{at.held}: only a counterbalance valve meters a steady flow; a check valve is open or shut")
    stiffness, travel = _spring(valve)
    free = opening_force(at.p_line, at.p_held, at.p_pilot, valve) / stiffness
    lift = min(free, travel)
    by_drop, by_area = flow_slopes(at.p_held - at.p_line, valve.opened * lift / valve.travel, valve.orifice, oil)
    return Valve(by_area * valve.opened / valve.travel, by_drop, lift, free < travel)


def _spring(valve: Counterbalance) -> tuple[float, float]:
    body = valve.body
    return (body.stiffness, body.stops.stroke) if isinstance(body, Mass) else (body.rate, body.travel)


def line_seen(s: Array, line: int, beyond: Array | float, flow: float, rig: Mapping[str, Any], circuit: Circuit) -> Any:
    """Y(s) [m^3/(s Pa)] at one end of a line with an admittance beyond its other end, losses at both ends."""
    lines, pipe = circuit.lines, rig[tuple(PIPES)[line]]
    model, capacity = int(lines.model[line]), float(lines.capacity[line])
    turbulent = 0.5 * (line_slope(lines, line, flow) - float(lines.resistance[line]))
    at_end = 2.0 * loss_at_end(circuit.parts.losses, line) * abs(flow)
    if model not in (LUMPED, VOLUME):
        at_end += turbulent
    far = beyond / (1.0 + at_end * beyond)
    if model == VOLUME:
        near = s * capacity + far
    elif model == LUMPED:
        series = line_slope(lines, line, flow) + s * float(lines.inertance[line])
        far = 0.5 * s * capacity + far
        near = 0.5 * s * capacity + far / (1.0 + series * far)
    else:
        n = np.sqrt(losses(s, pipe["diameter"] ** 2 / (4.0 * circuit.parts.oil.viscosity), LOSSES[pipe["friction"]]))
        own, through = 1.0 / (float(lines.z0[line]) * n), np.tanh(s * float(lines.travel_time[line]) * n)
        near = own * (far + own * through) / (own + far * through)
    return near / (1.0 + at_end * near)


class _Seen(NamedTuple):
    """Admittances from the cylinder's ends on, at each s."""

    line: Array
    pilot: Array


def _seen(s: Array, at: Lowering, rig: Mapping[str, Any], circuit: Circuit) -> _Seen:
    parts, lower = circuit.parts, at.held == "accessory_a"
    out_of, into = (2, 3) if lower else (3, 2)
    opened, orifice = interpreted(lands_at)(parts.valve, at.spool), land_orifice(parts.valve)
    to_driven, to_tank = (opened.p_b, opened.a_t) if lower else (opened.p_a, opened.b_t)
    returning = line_seen(s, 4, line_seen(s, 5, OPEN_END, at.q_held, rig, circuit), at.q_held, rig, circuit)
    out = _behind(returning, to_tank, at.q_held, orifice, parts.oil)
    supplied = _behind(_supply(s, at, rig, circuit), to_driven, at.q_driven, orifice, parts.oil)
    return _Seen(
        line_seen(s, out_of, out, at.q_held, rig, circuit), line_seen(s, into, supplied, at.q_driven, rig, circuit)
    )


def _behind(beyond: Array, area: float, flow: float, orifice: Any, oil: Any) -> Array:
    """An admittance seen through a land."""
    a, b = resistance(area, orifice, oil)
    return beyond / (1.0 + (2.0 * a * abs(flow) + b) * beyond)


def _supply(s: Array, at: Lowering, rig: Mapping[str, Any], circuit: Circuit) -> Array:
    """Pump, relief valve at its steady slope and line 2, as seen from P."""
    parts, step = circuit.parts, 1.0
    slope = (steady_relief(parts.relief, at.tee + step) - steady_relief(parts.relief, at.tee - step)) / (2.0 * step)
    leakage = -steady_supply(parts.supply, at.tee, 1.0, parts.oil)[1]
    through = at.q_driven + steady_relief(parts.relief, at.tee)
    tee = slope + line_seen(s, 0, leakage, through, rig, circuit)
    tee = tee / (1.0 + fitting_slope(at.q_driven, parts.fitting) * tee)
    return line_seen(s, 1, tee, at.q_driven, rig, circuit)


def _matrices(s: Array, at: Lowering, rig: Mapping[str, Any], circuit: Circuit, viscous: float) -> Array:
    """The equations of (W, P_h, P_d, X, P_line, P_pilot), at each s, each row to its own size."""
    parts, slopes, seen = circuit.parts, about(at, circuit), _seen(s, at, rig, circuit)
    valve = getattr(between(parts.necks), at.held)
    h, d, leak = pair_at(parts.cylinder, at.position, at.held == "accessory_a")
    m = np.zeros((len(s), 6, 6), complex)
    m[:, 0, 0] = _load_impedance(s, at, parts.load) + viscous
    m[:, 0, 1], m[:, 0, 2] = h.area, -d.area
    m[:, 1, 0], m[:, 1, 1], m[:, 1, 2] = -h.area * h.filling(at.p_held), h.admittance(s, at.p_held, -at.speed), -leak
    m[:, 1, 1] += slopes.by_drop + leak
    m[:, 1, 3], m[:, 1, 4] = slopes.by_lift, -slopes.by_drop
    m[:, 2, 0], m[:, 2, 2] = d.area * d.filling(at.p_driven), d.admittance(s, at.p_driven, at.speed) + leak
    m[:, 2, 1], m[:, 2, 5] = -leak, seen.pilot
    m[:, 3] = _valve_row(s, valve, slopes, parts.step)
    m[:, 4, 1], m[:, 4, 3], m[:, 4, 4] = slopes.by_drop, slopes.by_lift, -slopes.by_drop - seen.line
    m[:, 5, 2], m[:, 5, 5] = -1.0, 1.0 + _slope_into(at, circuit) * seen.pilot
    return m


def _load_impedance(s: Array, at: Lowering, load: AnyLoad) -> Array:
    """Force over speed [N s/m] at the steady speed: mass, dampers, and how the force changes with the place."""
    around = surroundings(load)
    above, below = (moved_weight(load, at.position + way) for way in (SMALL, -SMALL))
    stiffness, damping = (above - below) / (2.0 * SMALL), around.viscous + 2.0 * around.quadratic * at.speed
    return rigid_mass(load, at.position) * s + damping + stiffness / s


def _valve_row(s: Array, valve: Counterbalance, slopes: Valve, step: float) -> Array:
    row = np.zeros((len(s), 6), complex)
    row[:, 3] = 1.0
    if not slopes.travelling:
        return row
    body, stiffness = valve.body, _spring(valve)[0]
    if isinstance(body, Mass):
        row[:, 3] = 1.0 + (body.mass * s + body.damping) * s / stiffness
    elif body.kept > 0.0:
        row[:, 3] = 1.0 - s * step / math.log(body.kept)
    pilot = 1.0 - s * step / math.log(valve.pilot_kept) if valve.pilot_kept > 0.0 else 1.0
    per_pressure = valve.face / stiffness
    row[:, 1], row[:, 4] = -per_pressure, per_pressure * valve.back_ratio
    row[:, 5] = -per_pressure * valve.pilot_ratio / pilot
    return row


def _slope_into(at: Lowering, circuit: Circuit) -> float:
    """R [Pa s/m^3] of the accessory on the way into the driven chamber."""
    port, dq = "accessory_b" if at.held == "accessory_a" else "accessory_a", 1e-4 * at.q_driven
    return (drop_into(at.q_driven + dq, port, circuit) - drop_into(at.q_driven - dq, port, circuit)) / (2.0 * dq)


def swings(at: Lowering, rig: Mapping[str, Any], circuit: Circuit, viscous: float = 0.0) -> list[Swing]:
    """The oscillations below 2 kHz about a steady lowering, the fastest growing first; viscous: friction [N s/m]."""
    size = np.abs(_matrices(np.array([1j * STARTS[0]]), at, rig, circuit, viscous))[0].max(axis=1, keepdims=True)
    column = np.array([0.1, 1e5, 1e5, 1e-4, 1e5, 1e5])
    row = (size * column).max(axis=1, keepdims=True)

    def characteristic(s: Array) -> Array:
        return np.linalg.det(_matrices(s, at, rig, circuit, viscous) * column / row)

    found: list[complex] = []
    for root in roots(characteristic, 1j * STARTS):
        known = any(abs(root - other) < 1e-4 * abs(other) for other in found)
        if not known and 2.0 * math.pi * 0.2 < root.imag < HIGHEST and abs(root.real) < 3.0 * root.imag:
            found.append(complex(root))
    return sorted((Swing(s.real, s.imag / (2.0 * math.pi)) for s in found), reverse=True)
