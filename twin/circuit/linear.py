"""The circuit linearised about a point of steady motion: the Jacobian of `rates` by hand, from the components' slopes.

A point is a `State` whose pressures and flows stand still; its spool position is also its reference, and a run may
start from it. Lines are lumped, the relief valve follows its steady curve and the pump gives its mean flow. Stops,
spool limits, vapour and the set-valued friction have no slope and are left out.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from twin.accessory import NoAccessory, between
from twin.actuator import areas, drive, moduli, outside, widening
from twin.air import tangent
from twin.circuit.block import compiled
from twin.circuit.equilibrium import behind_check, state_at, supply_at_rest
from twin.circuit.land_slopes import LandSlope, area_ratio, edge_of, edge_slopes, joins, land_slopes, spool_slopes
from twin.circuit.rates import (
    FLOW,
    LINE_ENDS,
    LOWER,
    PUMP,
    S_RATE,
    STATES,
    TEE,
    UPPER,
    A,
    B,
    P,
    S,
    T,
    V,
    X,
    capacities,
    vector_rates,
)
from twin.circuit.state import (
    Flows,
    Pressures,
    State,
    flows,
    pressures,
)
from twin.circuit.step import Circuit, Parts, Piston
from twin.compliant import Compliant
from twin.cylinder import Chambers
from twin.directional_valve import Spool, is_switching
from twin.fitting import fitting_slope
from twin.kernel import interpreted
from twin.lands import Lands
from twin.lines.bank import VOLUME
from twin.lines.bank import steady_slope as line_slope
from twin.load import Load
from twin.load_at_rest import inertia_at, moved_weight
from twin.load_slot import AnyLoad, acceleration
from twin.minor_losses import loss_at_end
from twin.motor import Motor, displacement_slope
from twin.relief.slot import relief_slope
from twin.return_end import return_slope
from twin.supply import steady_supply
from twin.topology import CHANNELS, LINES, PLACES

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]

INPUTS = ("spool_reference", "force")
STATE_OF = {"position": "position", "velocity": "velocity", "spool": "spool"} | {  # of observed quantities
    place.pressure: state for place, state in zip(PLACES.values(), STATES, strict=False)
}
TAPS = {name: STATE_OF[channel.reads] for name, channel in CHANNELS.items() if channel.reads in STATE_OF}
LANDS = {"p_a": (P, A), "b_t": (B, T), "p_b": (P, B), "a_t": (A, T)}
CHAMBERS_AT = LOWER, UPPER
SMALL = 1e-6  # [m], [m/s], of a difference that stands for a slope
UNKNOWN = [*range(X), V]  # what a moving point is solved for


def to_vector(s: State) -> Array:
    """A state in the order of STATES."""
    return np.array([*pressures(s), *flows(s), *s.piston, *s.spool])


def from_vector(y: Array, circuit: Circuit) -> State:
    """The state in which a vector's pressures and flows have been steady."""
    v = [float(value) for value in y]
    return state_at(Pressures(*v[:FLOW]), Flows(*v[FLOW:X]), Piston(*v[X:S]), Spool(*v[S:]), circuit)


def edge_point(circuit: Circuit, position: float, edge: str) -> State:
    """The limit of slow steady motion at vanishing opening, upwards ("+") or downwards ("-"); position in m.

    The spool stands at the land's edge, the supply is as at rest, the leak across the piston is left out of the
    balance. Raises ValueError for another edge, and for a load under which the oil would not follow.
    """
    _check_edge(edge, ("+", "-"))
    _refuse_without_slope(circuit)
    p = _edge_pressures(circuit, position, edge)
    _refuse_cavity(p, circuit)
    spool = Spool(edge_of(circuit.parts.valve, edge), 0.0)
    through = Flows(supply_at_rest(circuit).relieved, 0.0, 0.0, 0.0, 0.0, 0.0)
    return state_at(p, through, Piston(position, 0.0), spool, circuit)


def _edge_pressures(circuit: Circuit, position: float, edge: str) -> Pressures:
    area, weight = interpreted(areas)(circuit.parts.cylinder, position), moved_weight(circuit.parts.load, position)
    pump, tee = supply_at_rest(circuit)[:2]
    port, ratio = behind_check(tee, circuit), area_ratio(circuit.parts.valve, edge)
    if edge == "+":
        k = (ratio * area.upper / area.lower) ** 2  # (p_u - 0)/(p_P - p_l)
        lower = (weight + area.upper * k * port) / (area.lower + area.upper * k)
        upper = k * (port - lower)
    else:
        k = (ratio * area.lower / area.upper) ** 2  # (p_l - 0)/(p_P - p_u)
        upper = (area.lower * k * port - weight) / (area.lower * k + area.upper)
        lower = k * (port - upper)
    return Pressures(pump, tee, port, lower, lower, upper, upper, 0.0, 0.0)


def moving_point(circuit: Circuit, position: float, spool: float, viscous: float = 0.0) -> State:
    """The quasi-steady point at a position [m] under a constant spool position (-1..1) beyond the overlap.

    viscous: friction over speed [N s/m]. Raises ValueError inside the overlap, and where the oil would not follow.
    """
    from scipy.optimize import root

    _refuse_without_slope(circuit)
    if not joins(circuit.parts.valve, spool):
        raise ValueError(f"spool {spool} lies inside the overlap, {_dead_band(circuit)}; take it further out")
    pressure_guess = _edge_pressures(circuit, position, "+" if spool > 0.0 else "-")
    full = np.array([*pressure_guess, *[0.0] * LINES, position, math.copysign(0.01, spool), spool, 0.0])
    column, row = _scales(circuit)

    def place(unknown: Array) -> Array:
        full[UNKNOWN] = unknown * column
        return full

    def residual(unknown: Array) -> Array:
        return vector_rates(place(unknown), spool, circuit, viscous)[UNKNOWN] * row

    def slope(unknown: Array) -> Array:
        matrix = jacobian(place(unknown), circuit, None, viscous)
        return row[:, None] * matrix[np.ix_(UNKNOWN, UNKNOWN)] * column

    found = root(residual, full[UNKNOWN] / column, jac=slope, options={"xtol": 1e-13})
    if np.abs(residual(found.x)).max() > 1e-6:
        raise ValueError(f"no steady motion at spool {spool}, position {position} m: the oil does not follow the load")
    _refuse_cavity(Pressures(*place(found.x)[:FLOW]), circuit)
    return from_vector(place(found.x), circuit)


def linearise(
    point: State, edge: str | None = "+", friction: str | float = "none", *, circuit: Circuit
) -> "StateSpace":
    """The linear system about a point of `edge_point` or `moving_point`.

    edge: "+" or "-" takes the slope of the flow just beyond that land's edge, and none by pressure, as if there were
    no overlap; None takes the point's own opening. friction: "none" or a slope [N s/m]. States, inputs and outputs
    are named; the spool is in shares of its travel, so a controller that jumps the overlap has 1 - overlap less gain.
    What was assumed stands in `note`, and in `name` with "_" for ".".
    """
    import control

    _check_edge(edge, ("+", "-", None))
    viscous = _viscous(friction)
    a = jacobian(to_vector(point), circuit, edge, viscous)
    b = np.zeros((len(STATES), len(INPUTS)))
    b[[S, S_RATE], 0] = spool_slopes(circuit.parts.valve)[1]
    b[V, 1] = 1.0 / inertia_at(circuit.parts.load, point.piston.position)
    c = np.array([[float(state == tap) for state in STATES] for tap in TAPS.values()])
    valve = f"spool {point.spool.position:g}" if edge is None else f"land edge {edge}, overlap removed"
    note = f"{valve}, friction {f'{viscous:g} N s/m' if viscous else 'off'}"
    labels = {"states": STATES, "inputs": INPUTS, "outputs": tuple(TAPS), "name": note.replace(".", "_")}
    system = control.StateSpace(a, b, c, np.zeros((len(TAPS), len(INPUTS))), **labels)
    system.note = note  # pyright: ignore[reportAttributeAccessIssue]
    return system


def jacobian(y: Array, circuit: Circuit, edge: str | None, viscous: float = 0.0) -> Array:
    """Slopes of `vector_rates` by STATES, where pressures stand still; edge as in `linearise`."""
    c = circuit.parts
    a: Array = np.zeros((len(STATES), len(STATES)))
    a[FLOW:X] = _line_slopes(y, circuit)
    a[:FLOW] = _inflow_slopes(y, circuit, edge, a[FLOW:X]) / _capacities(y, circuit)[:, None]
    _add_motion(a, y, circuit, viscous)
    a[S : S_RATE + 1, S : S_RATE + 1], command = spool_slopes(c.valve)
    a[S : S_RATE + 1] += np.outer(command, _force_slopes(y, circuit, edge))
    a[X, V] = 1.0
    return a


def _force_slopes(y: Array, circuit: Circuit, edge: str | None) -> Array:
    """Slopes of the force of the flow on the spool, in shares of the command."""
    slopes: Array = np.zeros(len(STATES))
    for land in lands(y, circuit, edge):
        source, sink = LANDS[land.name]
        slopes[[source, sink, S]] += land.force_by_drop, -land.force_by_drop, land.force_by_spool
    return slopes


def _line_slopes(y: Array, circuit: Circuit) -> Array:
    """Slopes of the rates of the flows, a row per line."""
    c, lines = circuit.parts, circuit.lines
    a: Array = np.zeros((X - FLOW, len(STATES)))
    for line, (source, sink) in enumerate(LINE_ENDS):
        q = float(y[FLOW + line])
        a[line, FLOW + line] = -line_slope(lines, line, q) - (fitting_slope(q, c.fitting) if line == 1 else 0.0)
        if sink < 0:
            a[line, FLOW + line] -= return_slope(c.return_end, q)
        a[line, FLOW + line] -= 4.0 * loss_at_end(c.losses, line) * abs(q)
        a[line, source] = 1.0
        if sink >= 0:
            a[line, sink] = -1.0
        a[line] /= lines.inertance[line]
    return a


def _inflow_slopes(y: Array, circuit: Circuit, edge: str | None, of_lines: Array) -> Array:
    """Slopes of C p' = S' - V' S/V, a row per place; of_lines: those of the rates of the flows."""
    c, lines = circuit.parts, circuit.lines
    slopes: Array = np.zeros((FLOW, len(STATES)))
    _refuse_link(c.load)
    for line, (source, sink) in enumerate(LINE_ENDS):
        through: Array = np.zeros(len(STATES))
        through[FLOW + line] = 1.0
        if lines.model[line] == VOLUME:
            through += 0.5 * lines.step * of_lines[line]
        slopes[source] -= through
        if sink >= 0:
            slopes[sink] += through
    open_lands = [(*LANDS[land.name], land.by_drop, land.by_spool) for land in lands(y, circuit, edge)]
    for source, sink, by_drop, by_spool in ((LOWER, UPPER, c.cylinder.leakage, 0.0), *open_lands):
        slopes[source, [source, sink, S]] += -by_drop, by_drop, -by_spool
        slopes[sink, [source, sink, S]] += by_drop, -by_drop, by_spool
    slopes[PUMP, PUMP] += steady_supply(c.supply, float(y[PUMP]), 1.0, c.oil)[1]
    slopes[TEE, TEE] -= relief_slope(c.relief, float(y[TEE]))
    _add_chambers(slopes, y, c)
    return slopes


def _add_chambers(slopes: Array, y: Array, c: Parts) -> None:
    """What the chambers' volumes, or the oil that passes, and their leaks to the outside add."""
    area, b = interpreted(areas)(c.cylinder, float(y[X])), interpreted(moduli)(c.cylinder)
    drained = interpreted(outside)(c.cylinder, Chambers(float(y[LOWER]), float(y[UPPER])))
    wide = interpreted(widening)(c.cylinder) == 1.0
    for place, swept, modulus, leak, sign in zip(CHAMBERS_AT, area, b, drained, (-1.0, 1.0), strict=True):
        slope, empty = interpreted(tangent)(c.cylinder.air, modulus, swept, float(y[place])) if wide else (0.0, swept)
        slopes[place, place] += sign * slope * y[V] - leak
        slopes[place, V] = sign * (empty + slope * y[place])
        if isinstance(c.cylinder, Motor):
            slopes[place, X] = sign * displacement_slope(float(y[X]), c.cylinder) * y[V]


def _add_motion(a: Array, y: Array, circuit: Circuit, viscous: float) -> None:
    """The row of the piston's acceleration; by differences where the load's equation has no other name for a slope."""
    c, x, v = circuit.parts, float(y[X]), float(y[V])
    area = interpreted(areas)(c.cylinder, x)
    mass = inertia_at(c.load, x)
    a[V, [LOWER, UPPER, V]] = np.array([area.lower, -area.upper, -viscous]) / mass
    if isinstance(c.load, Load) and not isinstance(c.cylinder, Motor):
        return

    def rate(x: float, v: float) -> float:
        oil = interpreted(drive)(Chambers(float(y[LOWER]), float(y[UPPER])), x, c.cylinder)
        return interpreted(acceleration)(c.load, oil, x, v, viscous)

    a[V, X] = (rate(x + SMALL, v) - rate(x - SMALL, v)) / (2.0 * SMALL)
    a[V, V] = (rate(x, v + SMALL) - rate(x, v - SMALL)) / (2.0 * SMALL)


def _refuse_link(load: AnyLoad) -> None:
    if isinstance(load, Compliant):
        raise ValueError(
            "a compliant load has a second mass that the linear model has no states for; linearise with "
            "load.kind = 'environment' and the sum of both masses"
        )


def lands(y: Array, circuit: Circuit, edge: str | None) -> list[LandSlope]:
    """The lands that let oil through at a vector of STATES, or those at whose edge the spool stands."""
    drop = Lands(**{name: float(y[source] - y[sink]) for name, (source, sink) in LANDS.items()}, p_t=0.0)
    if edge:
        return edge_slopes(circuit.parts.valve, edge, drop, circuit.parts.oil)
    return land_slopes(circuit.parts.valve, float(y[S]), drop, circuit.parts.oil)


def _dead_band(circuit: Circuit) -> str:
    low, high = edge_of(circuit.parts.valve, "-"), edge_of(circuit.parts.valve, "+")
    return f"+-{high}" if low == -high else f"{low:g} to {high:g}"


def _capacities(y: Array, circuit: Circuit) -> Array:
    out = np.empty(FLOW)
    capacities(y, *compiled(circuit), out)
    return out


def _scales(circuit: Circuit) -> tuple[Array, Array]:
    """Sizes of the unknowns, and of their rates, that bring a moving point's equations to order one."""
    inertances, mass = circuit.lines.inertance, inertia_at(circuit.parts.load, 0.0)
    row = np.array([*(1e4 * _capacities(np.zeros(len(STATES)), circuit)), *(1e-5 * inertances), 1e-3 * mass])
    return np.array([1e5] * FLOW + [1e-4] * LINES + [0.1]), row


def _refuse_cavity(p: Pressures, circuit: Circuit) -> None:
    for node, pressure in zip(Pressures._fields, p, strict=True):
        if pressure <= circuit.parts.oil.vapour_pressure:
            raise ValueError(
                f"oil would cavitate at {node!r}: the balance asks for less than the vapour pressure, "
                f"{circuit.parts.oil.vapour_pressure / 1e5:g} bar; take a smaller load or opening, or a stronger supply"
            )


def _refuse_without_slope(circuit: Circuit) -> None:
    if is_switching(circuit.parts.valve):
        raise ValueError(
            "a switching valve knows three positions and has no slope between them; "
            "linearise with valve.kind = 'proportional'"
        )
    necks = between(circuit.parts.necks)
    for name, kind in (("accessory_a", necks.accessory_a), ("accessory_b", necks.accessory_b)):
        if not isinstance(kind, NoAccessory):
            raise ValueError(
                f"{name} is open, shut or in between by pressure and has no slope in this theory; linearise with "
                f"{name}.kind = 'none', or see what `hydrotwin describe` says of lowering"
            )


def _check_edge(edge: str | None, valid: tuple[str | None, ...]) -> None:
    if edge not in valid:
        raise ValueError(f"edge {edge!r} is none of {', '.join(repr(v) for v in valid)}")


def _viscous(friction: str | float) -> float:
    """A friction slope [N s/m]; "none" is zero."""
    if friction == "none":
        return 0.0
    if isinstance(friction, str) or not 0.0 <= friction < math.inf:
        raise ValueError(f"friction {friction!r} is neither 'none' nor a slope in N s/m, 0 or more")
    return float(friction)
