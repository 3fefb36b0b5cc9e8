"""The linear model of a scenario's rig: continuous, and sampled with the hold and the delay of its loop.

A held input u makes x(t) = Phi(t) x + Gamma(t) u. With a delay of n whole intervals and a rest m the spool reference of
sample k acts from (k + n) T + m on, so that x_{k+1} = Phi(T) x_k + Phi(T - m) Gamma(m) u_{k-n-1} + Gamma(T - m) u_{k-n}
(Astrom and Wittenmark, Computer-Controlled Systems, section 2.3); the values on their way are further states. A force
acts as it is, held over the interval.
"""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.circuit import circuit_of
from bridge.scenario.fitted_valve import delay_of
from bridge.studies.stability.rig_plant import rest_point
from controller.stability.plant import Plant, zero_order_hold
from twin.circuit.linear import INPUTS, TAPS, edge_point, linearise, moving_point, to_vector
from twin.circuit.rates import FLOW, STATES, X
from twin.circuit.state import State
from twin.circuit.step import Circuit

if TYPE_CHECKING:
    from control import StateSpace

Array = NDArray[np.float64]
POINTS = ("rest", "up", "down")
ROUNDING = 1e-9  # of a period: a delay as near to whole ones is whole
UNITS = dict(
    zip(STATES, (*["Pa"] * FLOW, *["m^3/s"] * (X - FLOW), "m", "m/s", "of travel", "of travel/s"), strict=True)
) | {"spool_reference": "of travel", "force": "N"}


class LinearModel(NamedTuple):
    """The rig about a point, both as `control.StateSpace`, in SI; every signal is a difference from the point's own."""

    scenario: str
    point: str  # as it was asked for
    note: str  # what was assumed
    at: dict[str, float]  # the states at the point
    delay: float  # [s] of the spool reference
    continuous: "StateSpace"  # without the delay
    sampled: "StateSpace"  # with it

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "scenario": self.scenario,
            "point": self.point,
            "note": self.note,
            "at": self.at,
            "inputs": {name: UNITS[name] for name in INPUTS},
            "outputs": {name: UNITS[state] for name, state in TAPS.items()},
            "continuous": _matrices(self.continuous),
            "sampled": {"dt": self.sampled.dt, "delay": self.delay, **_matrices(self.sampled)},
        }


def linear_model(scenario: Scenario, point: str = "rest", friction: float = 0.0) -> LinearModel:
    """The linear model about a point, with the piston at the scenario's start.

    point: "rest", at which the valve passes what leaks; "up" or "down", the limits of slow motion; or a spool position
    of a steady motion, "0.3". friction: viscous [N s/m], in place of the seal's. Raises ScenarioError for a point that
    the rig does not have.
    """
    circuit, position = circuit_of(scenario), scenario.start.position
    try:
        state, edge = _point(point, circuit, position)
        continuous = linearise(state, edge, friction, circuit=circuit)
    except ValueError as error:
        raise ScenarioError(f"no linear model at {point!r}: {error}") from None
    at = dict(zip(STATES, to_vector(state).tolist(), strict=True))
    delay, note = scenario.loop.delay + delay_of(scenario), getattr(continuous, "note", "")
    sampled = sampled_model(continuous, scenario.loop.sample_period, delay)
    return LinearModel(scenario.name, point, note, at, delay, continuous, sampled)


def _point(name: str, circuit: Circuit, position: float) -> tuple[State, str | None]:
    """The state, and the land's edge at which it stands, if it does."""
    if name in ("up", "down"):
        edge = "+" if name == "up" else "-"
        return edge_point(circuit, position, edge), edge
    if name == "rest":
        found = rest_point(circuit, position)
        if found is None:
            raise ValueError("nothing leaks, so the valve is shut at rest: take 'up' or 'down'")
        return found, None
    try:
        spool = float(name)
    except ValueError:
        raise ValueError(f"it is neither {', '.join(map(repr, POINTS))} nor a spool position from -1 to 1") from None
    if not abs(spool) <= 1.0:
        raise ValueError("a spool position is from -1 to 1")
    return moving_point(circuit, position, spool), None


def sampled_model(system: "StateSpace", period: float, delay: float) -> "StateSpace":
    """A continuous system of the INPUTS, sampled with a period [s]; the first input is held and delayed [s]."""
    import control

    a, b, c = (np.asarray(matrix, float) for matrix in (system.A, system.B, system.C))
    whole = math.floor(delay / period + ROUNDING)
    rest = delay - whole * period
    rest = rest if rest > ROUNDING * period else 0.0
    plant = [Plant(a, column, c[0], None) for column in b.T]
    phi, force = zero_order_hold(plant[1], period)
    later, newest = zero_order_hold(plant[0], period - rest)
    before = later @ zero_order_hold(plant[0], rest)[1]
    waiting = whole + (rest > 0.0)
    n = len(a)
    sampled = np.zeros((n + waiting, n + waiting))
    entries = np.zeros((n + waiting, len(INPUTS)))
    sampled[:n, :n], entries[:n, 1] = phi, force
    onto = np.hstack([before[:, None], newest[:, None]]) if rest > 0.0 else newest[:, None]
    row = np.zeros((n, waiting + 1))  # by u_{k - waiting} ... u_k
    row[:, : onto.shape[1]] = onto
    sampled[:n, n:], entries[:n, 0] = row[:, :-1], row[:, -1]
    for place in range(waiting - 1):
        sampled[n + place, n + place + 1] = 1.0
    if waiting:
        entries[-1, 0] = 1.0
    names = [*STATES, *(f"spool_reference_{k}_before" for k in range(waiting, 0, -1))]
    outputs = np.hstack([c, np.zeros((len(c), waiting))])
    direct = np.zeros((len(c), len(INPUTS)))
    return control.StateSpace(sampled, entries, outputs, direct, period, states=names, inputs=INPUTS, outputs=[*TAPS])


def _matrices(system: "StateSpace") -> dict[str, Any]:
    """With the units of the states: those that the rig does not have are commands on their way."""
    states = {name: UNITS.get(name, UNITS["spool_reference"]) for name in system.state_labels}
    return {"states": states} | {name: np.asarray(getattr(system, name)).tolist() for name in "ABCD"}
