"""How much delay, jitter and loss a scenario's loop tolerates by linear theory: small motions, no friction, no card.

The loop is that of `controller.stability.sampled` under the scenario's own law as a linear system, about each point of
`rig_plant`. u_k acts from t_k + delay on and is held until another command acts.

Delay: the smallest at which a multiplier leaves the unit circle.
Loss: a command is lost with probability p, each by itself, and the valve holds the one before. The loop switches
    between the matrix A of a command that came and A_0 of a lost one, and E[X X'] stays bounded while the spectral
    radius of P -> (1 - p) A P A' + p A_0 P A_0' is below 1 (mean-square stability; O. L. V. Costa, M. D. Fragoso,
    R. P. Marques, Discrete-Time Markov Jump Linear Systems, 2005, chapter 3).
Jitter: the way of a command takes a time even in 0..J, none overtakes another, and it acts when it has come, not before
    t_k + delay. Stable is a loop whose top Lyapunov exponent is negative, found by a run of the linear loop over
    PERIODS periods with a fixed seed.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridge.errors import ScenarioError
from bridge.scenario import Scenario
from bridge.scenario.fitted_valve import delay_of
from bridge.studies.stability.advice import plants_of
from bridge.studies.stability.sampled_law import free_gain, law_of
from controller.stability import Plant, Timing, closed, is_stable, sampled_loop
from controller.stability.amplitude.linear_law import LinearLaw
from controller.stability.plant import zero_order_hold
from controller.stability.sampled import with_system

Array = NDArray[np.float64]
SCAN = 0.05  # of a period, between delays that are tried
LONGEST = 10.0  # periods of delay that are tried
SHARES, HALVINGS = 20, 10  # between shares of loss that are tried; of an interval that holds an edge
PERIODS, PARTS, ROUGHLY = (
    1500,
    20,
    6,
)  # of a run under jitter; instants of a period at which a command can come; halvings
SETTLING = 400  # steps of the power iteration; of its growth the last half counts
LEAST = 1e-9  # of a period: a loop without delay keeps the command before all the same


class LinearLoop(NamedTuple):
    """A plant about a point, and the law between its card and its valve."""

    point: str
    plant: Plant
    law: LinearLaw
    period: float  # T [s]
    delay: float  # [s], the scenario's own, the valve's with it


def loops_of(scenario: Scenario) -> list[LinearLoop]:
    """The linear loops of a scenario; none for a law that is not linear, and for a rig without linear points."""
    try:
        law = law_of(scenario)(free_gain(scenario).own)
        points = plants_of(scenario)
    except (ScenarioError, ValueError):
        return []
    if not isinstance(law, LinearLaw) or law.relay:
        return []
    period, delay = scenario.loop.sample_period, scenario.loop.delay + delay_of(scenario)
    return [LinearLoop(name, point.plant(), _driven(law), period, delay) for name, point in points.items()]


def _driven(law: LinearLaw) -> LinearLaw:
    """The law without memory that nothing changes, such as the integral of a PID whose integral gain is 0."""
    size = len(law.c)
    still = [not law.b[i].any() and np.array_equal(law.a[i], np.eye(size)[i]) for i in range(size)]
    kept = np.flatnonzero(~np.array(still, bool))
    return law._replace(a=law.a[kept][:, kept], b=law.b[kept], c=law.c[kept], back=law.back[kept])


def matrices(loop: LinearLoop, delay: float) -> tuple[Array, Array]:
    """The loop from sample to sample at a delay [s], when a command comes and when it is lost."""
    late = max(delay / loop.period, LEAST)
    free = sampled_loop(loop.plant, Timing(loop.period, late, "measured", 0.0))
    last = loop.plant.b.shape[-1]  # the place of the command before among the states
    own = with_system(free, loop.law.a, loop.law.b[:, 1:], loop.law.c, loop.law.d[1:])
    lost = own.free.copy()
    lost[:, last] += own.entry
    return closed(own, 1.0, 0.0), lost


def delay_edge(loop: LinearLoop) -> float:
    """The smallest delay [s] that is unstable; inf for none up to LONGEST periods."""

    def stable(periods: float) -> bool:
        return bool(is_stable(matrices(loop, periods * loop.period)[0]))

    return loop.period * _edge(stable, np.arange(0.0, LONGEST + SCAN, SCAN).tolist())


def loss_edge(loop: LinearLoop) -> float:
    """The smallest share of lost commands at which the loop is not stable in the mean square; inf for none below 1."""
    came, lost = matrices(loop, loop.delay)

    def stable(share: float) -> bool:
        return growth(came, lost, share) < 0.0

    return _edge(stable, np.linspace(0.0, 1.0, SHARES, endpoint=False).tolist())


def growth(came: Array, lost: Array, share: float) -> float:
    """Logarithm of the growth of E[X X'] per period, by power iteration from the identity."""
    matrix, total = np.eye(len(came)), 0.0
    for step in range(SETTLING):
        matrix = (1.0 - share) * came @ matrix @ came.T + share * lost @ matrix @ lost.T
        size = float(np.trace(matrix))
        if not 0.0 < size < math.inf:
            return -math.inf if size == 0.0 else math.inf
        total += math.log(size) if step >= SETTLING // 2 else 0.0
        matrix /= size
    return total / (SETTLING - SETTLING // 2)


def jitter_edge(loop: LinearLoop) -> float:
    """The smallest longest way J [s] of a command under which the loop grows; inf for none up to LONGEST periods."""

    def stable(periods: float) -> bool:
        return exponent(loop, periods * loop.period) < 0.0

    return loop.period * _edge(stable, np.arange(0.0, LONGEST + 0.5, 0.5).tolist(), ROUGHLY)


def exponent(loop: LinearLoop, longest: float) -> float:
    """Top Lyapunov exponent per period of the loop whose commands need a time even in 0..longest [s]."""
    part = loop.period / PARTS
    phi, gamma = zero_order_hold(loop.plant, np.asarray(part))
    ways = np.random.default_rng(1).random(PERIODS) * longest
    due = np.arange(PERIODS) * PARTS + np.ceil(np.maximum(ways, loop.delay) / part - 1e-9).astype(int)
    due = np.maximum.accumulate(due)  # no command overtakes another
    law, tachometer = loop.law, loop.plant.velocity
    x, z = np.ones(len(phi)) / np.maximum(np.abs(loop.plant.position).max(), 1.0), np.zeros(len(law.c))
    commands, acting, held, total = np.zeros(PERIODS), 0, 0.0, 0.0
    for k in range(PERIODS):
        seen = np.array([loop.plant.position @ x, 0.0 if tachometer is None else tachometer @ x])
        commands[k] = law.c @ z + law.d[1:] @ seen
        z = law.a @ z + law.b[:, 1:] @ seen
        for now in range(k * PARTS, (k + 1) * PARTS):
            while acting <= k and due[acting] <= now:
                held, acting = commands[acting], acting + 1
            x = phi @ x + gamma * held
        if (size := math.sqrt(float(x @ x + z @ z + held * held))) == 0.0:
            return -math.inf
        total += math.log(size) if k >= PERIODS // 4 else 0.0
        x, z, held = x / size, z / size, held / size
        commands[acting : k + 1] /= size
    return total / (PERIODS - PERIODS // 4)


def _edge(stable: Callable[[float], bool], tried: list[float], halvings: int = HALVINGS) -> float:
    """Where what is stable at first ends, between the values tried; 0.0 where it never was, inf where it stays so."""
    lost = next((number for number, value in enumerate(tried) if not stable(value)), None)
    if lost is None:
        return math.inf
    if lost == 0:
        return 0.0
    low, high = tried[lost - 1], tried[lost]
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return high


EDGES = {"delay": delay_edge, "jitter": jitter_edge, "loss": loss_edge}
