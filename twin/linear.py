"""The circuit linearised about a point of steady motion: the Jacobian by hand, from the slopes of the components.

A point is a `State` whose pressures and flows stand still; its spool position is also its reference, and a run may
start from it. Stops, spool limits, vapour and the set-valued friction have no slope and are left out.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.circuit import Circuit, Flows, Ledger, Piston, Pressures, Spool, State, nodes, pressures
from twin.equilibrium import fill, supply_at_rest
from twin.lines.lumped import LumpedLine, resistance_slope
from twin.orifice import flow_slopes
from twin.pump import pumped_oil
from twin.rates import rates
from twin.relief import relief_flow, relief_slope
from twin.spool_valve import opening

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]

PRESSURES = tuple(f"p_{node}" for node in Pressures._fields)
STATES = (*PRESSURES, *Flows._fields, "position", "velocity", "spool", "spool_velocity")
INPUTS = ("spool_reference", "force")
TAPS = {"position": "position", "velocity": "velocity", "p1": "p_tee", "p2": "p_lower", "p3": "p_upper"}
PUMP, TEE, P, A, LOWER, UPPER, B, T, BACK = range(9)
FLOW, X, V, S, S_RATE = 9, 15, 16, 17, 18
ENDS = ((PUMP, TEE), (TEE, P), (A, LOWER), (B, UPPER), (T, BACK), (BACK, None))  # of the lines
LANDS = {"+": ((P, A), (B, T)), "-": ((P, B), (A, T))}
UNKNOWN = [*range(X), V]  # what a moving point is solved for


class Land(NamedTuple):
    """Slopes of the flow through one land."""

    source: int
    sink: int
    by_drop: float  # [m^3/(s Pa)]
    by_spool: float  # [m^3/s], per whole travel


def to_vector(s: State, circuit: Circuit) -> Array:
    """A state in the order of STATES: pressures in place of stored oil."""
    return np.array([*pressures(s, circuit), *s.flows, *s.piston, *s.spool])


def from_vector(y: Array, circuit: Circuit) -> State:
    """The inverse of `to_vector` for a state without cavities."""
    values = [float(value) for value in y]
    oil = fill(Pressures(*values[:FLOW]), values[X], circuit)
    flows, piston, spool = Flows(*values[FLOW:X]), Piston(*values[X:S]), Spool(*values[S:])
    return State(oil, flows, piston, spool, Ledger(0.0, 0.0, 0.0))


def vector_rates(y: Array, reference: float, circuit: Circuit, viscous: float = 0.0) -> Array:
    """`rates` in the order of STATES: C p' = S' - V' (1 + p/B)."""
    d = rates(from_vector(y, circuit), reference, circuit, viscous)
    pressure_rates = (np.array(d.oil) - _swept(y, circuit) * y[V]) / _capacities(y, circuit)
    return np.array([*pressure_rates, *d.flows, *d.piston, *d.spool])


def edge_point(circuit: Circuit, position: float, edge: str) -> State:
    """The limit of slow steady motion at vanishing opening, upwards ("+") or downwards ("-"); position in m.

    The spool stands at the land's edge, the supply is as at rest, the leak across the piston is left out of the
    balance. Raises ValueError for another edge, and for a load under which the oil would not follow.
    """
    _check_edge(edge, ("+", "-"))
    p = _edge_pressures(circuit, edge)
    _refuse_cavity(p, circuit)
    spool = Spool(math.copysign(circuit.valve.overlap, 1.0 if edge == "+" else -1.0), 0.0)
    flows = Flows(relief_flow(p.tee, circuit.relief), 0.0, 0.0, 0.0, 0.0, 0.0)
    return State(fill(p, position, circuit), flows, Piston(position, 0.0), spool, Ledger(0.0, 0.0, 0.0))


def _edge_pressures(circuit: Circuit, edge: str) -> Pressures:
    c, load = circuit.cylinder, circuit.load
    pump, tee, _ = supply_at_rest(circuit)
    weight = load.mass * load.gravity - load.force
    if edge == "+":
        k = (c.area_upper / c.area_lower) ** 2  # (p_u - 0)/(p_P - p_l)
        lower = (weight + c.area_upper * k * tee) / (c.area_lower + c.area_upper * k)
        upper = k * (tee - lower)
    else:
        k = (c.area_lower / c.area_upper) ** 2  # (p_l - 0)/(p_P - p_u)
        upper = (c.area_lower * k * tee - weight) / (c.area_lower * k + c.area_upper)
        lower = k * (tee - upper)
    return Pressures(pump, tee, tee, lower, lower, upper, upper, 0.0, 0.0)


def moving_point(circuit: Circuit, position: float, spool: float, viscous: float = 0.0) -> State:
    """The quasi-steady point at a position [m] under a constant spool position (-1..1) beyond the overlap.

    viscous: friction over speed [N s/m]. Raises ValueError inside the overlap, and where the oil would not follow.
    """
    from scipy.optimize import root

    if abs(spool) <= circuit.valve.overlap:
        raise ValueError(f"spool {spool} lies inside the overlap, +-{circuit.valve.overlap}; take it further out")
    pressure_guess = _edge_pressures(circuit, "+" if spool > 0.0 else "-")
    full = np.array([*pressure_guess, *[0.0] * 6, position, math.copysign(0.01, spool), spool, 0.0])
    column, row = _scales(circuit)

    def place(unknown: Array) -> Array:
        full[UNKNOWN] = unknown * column
        return full

    def residual(unknown: Array) -> Array:
        return vector_rates(place(unknown), spool, circuit, viscous)[UNKNOWN] * row

    def slope(unknown: Array) -> Array:
        matrix = jacobian(from_vector(place(unknown), circuit), circuit, None, viscous)
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
    a = jacobian(point, circuit, edge, viscous)
    b = np.zeros((len(STATES), len(INPUTS)))
    b[S_RATE, 0], b[V, 1] = circuit.valve.natural_frequency**2, 1.0 / circuit.load.mass
    c = np.array([[float(state == tap) for state in STATES] for tap in TAPS.values()])
    valve = f"spool {point.spool.position:g}" if edge is None else f"land edge {edge}, overlap removed"
    note = f"{valve}, friction {f'{viscous:g} N s/m' if viscous else 'off'}"
    labels = {"states": STATES, "inputs": INPUTS, "outputs": tuple(TAPS), "name": note.replace(".", "_")}
    system = control.StateSpace(a, b, c, np.zeros((len(TAPS), len(INPUTS))), **labels)
    system.note = note  # pyright: ignore[reportAttributeAccessIssue]
    return system


def jacobian(point: State, circuit: Circuit, edge: str | None, viscous: float = 0.0) -> Array:
    """Slopes of `vector_rates` by the state, for a point whose pressures stand still; edge as in `linearise`."""
    y, c = to_vector(point, circuit), circuit
    a = np.zeros((len(STATES), len(STATES)))
    a[:FLOW] = _inflow_slopes(point, c, edge) / _capacities(y, c)[:, None]
    for index, ((source, sink), line) in enumerate(zip(ENDS, _lines(c), strict=True)):
        ends = [FLOW + index, source] if sink is None else [FLOW + index, source, sink]
        a[FLOW + index, ends] = np.array([-resistance_slope(y[FLOW + index], line), 1.0, -1.0])[: len(ends)]
        a[FLOW + index] /= line.inertance
    force_slopes = np.array([c.cylinder.area_lower, -c.cylinder.area_upper, -viscous])
    a[V, [LOWER, UPPER, V]] = force_slopes / c.load.mass
    omega = c.valve.natural_frequency
    a[S_RATE, [S, S_RATE]] = -(omega**2), -2.0 * c.valve.damping * omega
    a[X, V] = a[S, S_RATE] = 1.0
    return a


def _inflow_slopes(point: State, c: Circuit, edge: str | None) -> Array:
    """Slopes of C p' = S' - V' (1 + p/B), a row per node."""
    y, slopes = to_vector(point, c), np.zeros((FLOW, len(STATES)))
    for index, (source, sink) in enumerate(ENDS):
        slopes[source, FLOW + index] = -1.0
        if sink is not None:
            slopes[sink, FLOW + index] = 1.0
    leak = Land(LOWER, UPPER, 1.0 / c.cylinder.leakage_resistance, 0.0)
    for source, sink, by_drop, by_spool in (leak, *lands(point, c, edge)):
        slopes[source, [source, sink, S]] += -by_drop, by_drop, -by_spool
        slopes[sink, [source, sink, S]] += by_drop, -by_drop, by_spool
    slopes[PUMP, PUMP] += pumped_oil(y[PUMP], c.pump, c.oil.bulk_modulus)[1]
    slopes[TEE, TEE] -= relief_slope(y[TEE], c.relief)
    slopes[LOWER, LOWER] -= c.cylinder.area_lower / c.oil.bulk_modulus * y[V]
    slopes[UPPER, UPPER] += c.cylinder.area_upper / c.oil.bulk_modulus * y[V]
    slopes[:, V] = -_swept(y, c)
    return slopes


def lands(point: State, circuit: Circuit, edge: str | None) -> list[Land]:
    """The two open lands, or those at whose edge the spool stands; none for a shut valve."""
    valve, p = circuit.valve, pressures(point, circuit)
    side = edge or ("+" if point.spool.position > 0.0 else "-")
    sign = 1.0 if side == "+" else -1.0
    area = 0.0 if edge else opening(sign * point.spool.position, valve)
    widening = sign * valve.area / (1.0 - valve.overlap)  # dA/ds
    found = []
    for source, sink in LANDS[side]:
        drop = p[source] - p[sink]
        speed = valve.orifice.discharge * math.copysign(math.sqrt(2.0 * abs(drop) / circuit.oil.density), drop)
        by_drop, by_area = flow_slopes(drop, area, valve.orifice, circuit.oil) if area > 0.0 else (0.0, speed)
        if edge or area > 0.0:
            found.append(Land(source, sink, by_drop, by_area * widening))
    return found


def _lines(c: Circuit) -> tuple[LumpedLine, ...]:
    return c.line_1, c.line_2, c.line_3, c.line_4, c.line_5, c.line_6


def _capacities(y: Array, circuit: Circuit) -> Array:
    return np.array([node.capacity for node in nodes(from_vector(y, circuit).oil, float(y[X]), circuit)])


def _swept(y: Array, circuit: Circuit) -> Array:
    """What the piston takes per metre, as stored oil [m^2]: dV/dx (1 + p/B)."""
    swept, cylinder, modulus = np.zeros(FLOW), circuit.cylinder, circuit.oil.bulk_modulus
    swept[LOWER] = cylinder.area_lower * (1.0 + y[LOWER] / modulus)
    swept[UPPER] = -cylinder.area_upper * (1.0 + y[UPPER] / modulus)
    return swept


def _scales(circuit: Circuit) -> tuple[Array, Array]:
    """Sizes of the unknowns, and of their rates, that bring a moving point's equations to order one."""
    inertances = [line.inertance for line in _lines(circuit)]
    capacities = [node.capacity for node in nodes(fill(Pressures(*[0.0] * 9), 0.0, circuit), 0.0, circuit)]
    row = np.array([*(1e4 * np.array(capacities)), *(1e-5 * np.array(inertances)), 1e-3 * circuit.load.mass])
    return np.array([1e5] * 9 + [1e-4] * 6 + [0.1]), row


def _refuse_cavity(p: Pressures, circuit: Circuit) -> None:
    for node, pressure in zip(Pressures._fields, p, strict=True):
        if pressure <= circuit.oil.vapour_pressure:
            raise ValueError(
                f"oil would cavitate at {node!r}: the balance asks for less than the vapour pressure, "
                f"{circuit.oil.vapour_pressure / 1e5:g} bar; take a smaller load or opening, or a stronger supply"
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
