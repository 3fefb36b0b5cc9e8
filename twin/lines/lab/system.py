"""The method of lines: a case on a grid as a linear system in y = (p, u), memories of friction beside it.

    M p' = -a D u,      M (1 + k/2) u' = -a D p - M (beta u + c sum_j I_j) - (k a/2) sigma D u
    I_j = w_j + m_j u,  w_j' = -(n_j/t_v) (w_j + m_j u)

I_j' = -(n_j/t_v) I_j + m_j u' holds the recursion (2.65), corrected, as an equation, so that every integrator keeps its
order. A held end is an equation without derivative, 0 = g(t) - y_k, put in the place of the one for y_k: what couples a
consistent mass to the end's rate is kept. sigma = sign(u u_x) of Brunone's term and Re of turbulent friction are taken
from the start of a step, (2.55). Implicit stages y - theta F(y, t) = z are solved by one banded factorisation.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse as scipy_sparse

from twin.lines.friction import turbulence
from twin.lines.lab.factor import factorise
from twin.lines.lab.friction import Friction
from twin.lines.lab.pipe import PRESSURE, Array, Case, Pipe, steady_pressure
from twin.lines.lab.space import Grid

sparse: Any = scipy_sparse  # whose annotations lose its types
KEPT = 40  # factorisations


class State(NamedTuple):
    """What a line remembers."""

    y: Array  # (2 n,) p, then u [Pa]
    w: Array  # (K, n), I_j - m_j u [Pa]


class Frozen(NamedTuple):
    """What is taken from the start of a step."""

    beta: Array  # (n,) steady friction over u [1/s]
    sigma: Array  # (n,) sign(u u_x), zeros without Brunone's term


class LineSystem:
    """A pipe on a grid with a friction model, between ends or on a ring (no ends)."""

    def __init__(self, pipe: Pipe, grid: Grid, model: Friction, held: dict[int, Callable[[float], float]]) -> None:
        """held: row of y -> its value [Pa] over time."""
        self.pipe, self.grid, self.model = pipe, grid, model
        self.nodes = len(grid.x)
        self.rows = np.array(sorted(held), dtype=int)
        self.values = [held[row] for row in self.rows]
        self.alpha = model.rates / pipe.viscous_time
        self.memory = 4.0 / pipe.viscous_time
        free = np.ones(2 * self.nodes)
        free[self.rows] = 0.0
        self.free = free
        heavy = np.concatenate([np.ones(self.nodes), np.full(self.nodes, 1.0 + model.brunone / 2.0)])
        both = sparse.block_diag([grid.mass, grid.mass])
        self.mass: Any = (sparse.diags_array(free * heavy) @ both).tocsr()
        waves = sparse.block_array([[None, grid.derivative], [grid.derivative, None]])
        self.rate: Any = (-pipe.speed * sparse.diags_array(free) @ waves - sparse.diags_array(1.0 - free)).tocsr()
        self._linear = Frozen(np.full(self.nodes, model.steady * pipe.steady_rate), np.zeros(self.nodes))
        self._solvers: dict[Any, Callable[[Array], Array]] = {}

    def source(self, t: float) -> Array:
        """g(t) in the rows of held ends, 0 else [Pa]."""
        out = np.zeros(2 * self.nodes)
        for row, value in zip(self.rows, self.values, strict=True):
            out[row] = value(t)
        return out

    def freeze(self, y: Array) -> Frozen:
        """The non-linear parts at the start of a step."""
        if self.model.linear:
            return self._linear
        u, beta = y[self.nodes :], self._linear.beta.copy()
        if self.model.turbulent:
            per_u = self.pipe.diameter / (self.pipe.viscosity * self.pipe.hammer)
            beta *= [turbulence(value) for value in np.abs(u) * per_u]
        sigma = np.sign(u * (self.grid.derivative @ u)) if self.model.brunone else np.zeros(self.nodes)
        return Frozen(beta, sigma)

    def rates(self, t: float, state: State, frozen: Frozen) -> State:
        """F of the rows (times M) and w'."""
        u = state.y[self.nodes :]
        inner = state.w + self.model.weights[:, None] * u
        out = self.rate @ state.y + self.source(t)
        out[self.nodes :] -= self.free[self.nodes :] * self._resistance(u, frozen, inner.sum(axis=0))
        return State(out, -self.alpha[:, None] * inner)

    def _resistance(self, u: Array, frozen: Frozen, memories: Array) -> Array:
        out = self.grid.mass @ (frozen.beta * u + self.memory * memories)
        if self.model.brunone:
            gamma = 0.5 * self.model.brunone * self.pipe.speed * frozen.sigma
            out = out + gamma * (self.grid.derivative @ u)
        return out

    def solve(self, theta: float, z: State, t: float, frozen: Frozen) -> State:
        """The stage y = M^-1 (z + theta F(y, t)), w likewise, memories eliminated place by place."""
        right = z.y.copy()
        right[self.rows] = [theta * value(t) for value in self.values]
        if not len(self.alpha):
            return State(self.solver(theta, frozen)(right), z.w)
        damping = 1.0 + theta * self.alpha
        late = z.w / damping[:, None]
        dragged = self.grid.mass @ late.sum(axis=0)
        right[self.nodes :] -= theta * self.memory * self.free[self.nodes :] * dragged
        y = self.solver(theta, frozen)(right)
        gain = theta * self.alpha * self.model.weights / damping
        return State(y, late - gain[:, None] * y[self.nodes :])

    def solver(self, theta: float, frozen: Frozen) -> Callable[[Array], Array]:
        """The factorised matrix of a stage, kept for the next one like it."""
        key = theta if self.model.linear else (theta, frozen.beta.tobytes(), frozen.sigma.tobytes())
        if key not in self._solvers:
            if len(self._solvers) >= KEPT:
                self._solvers.pop(next(iter(self._solvers)))
            share = float((self.model.weights / (1.0 + theta * self.alpha)).sum())
            self._solvers[key] = factorise(self.mass - theta * self.with_friction(share, frozen))
        return self._solvers[key]

    def with_friction(self, share: complex, frozen: Frozen) -> Any:
        """rate with friction in it, memories as I = share u: complex share for frequency responses."""
        damped = self.grid.mass @ sparse.diags_array(frozen.beta + self.memory * share)
        if self.model.brunone:
            gamma = 0.5 * self.model.brunone * self.pipe.speed * frozen.sigma
            damped = damped + sparse.diags_array(gamma) @ self.grid.derivative
        blocks = sparse.block_diag([sparse.csr_array((self.nodes, self.nodes)), damped])
        return self.rate - sparse.diags_array(self.free) @ blocks

    def energy(self, state: State) -> float:
        """rho a^2/A times the energy in the oil and in the memories [Pa^2 m].

        (p H p + u H u)/2 + sum_j c/(2 m_j alpha_j) w_j H w_j: each memory is a mass c m_j/alpha_j at -w_j/m_j, dragged
        along by c m_j, so it takes energy and never gives any.
        """
        p, u = state.y[: self.nodes], state.y[self.nodes :]
        stored = 0.5 * float(p @ (self.grid.norm @ p) + u @ (self.grid.norm @ u))
        for w, m, alpha in zip(state.w, self.model.weights, self.alpha, strict=True):
            stored += 0.5 * self.memory / (m * alpha) * float(w @ (self.grid.norm @ w))
        return stored


def line_system(case: Case, grid: Grid, model: Friction) -> tuple[LineSystem, State]:
    """The system of a case and its start. ValueError for a friction that the method of lines cannot have."""
    if model.convolved:
        raise ValueError("friction convolution needs equal steps: take scheme moc, or friction zielke, kagawa or fit")
    last, hammer = len(grid.x) - 1, case.pipe.hammer
    held: dict[int, Callable[[float], float]] = {}
    for end, at in ((case.left, 0), (case.right, last)):
        if end.holds == PRESSURE:
            held[at] = end.course
        else:
            held[last + 1 + at] = lambda t, course=end.course: hammer * course(t)
    system = LineSystem(case.pipe, grid, model, held)
    u = np.full(last + 1, hammer * case.velocity)
    beta = system.freeze(np.concatenate([u, u])).beta[0]
    y = np.concatenate([steady_pressure(case, grid.x, float(beta)), u])
    return system, State(y, -model.weights[:, None] * u)
