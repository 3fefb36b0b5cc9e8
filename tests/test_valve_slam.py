"""The valve of the scenario valve-slam shuts within a millisecond: what the pressure waves in the lines must show."""


import pytest

from bridge.scenario import load
from tests.exact_line import Pipe
from tests.plant import SMOOTH, Array, circuit, watched
from twin.circuit import Circuit
from twin.equilibrium import equilibrium
from twin.state import State

VALVE = {name: load("valve-slam").rig_values()["valve"][name] for name in ("natural_frequency", "rate")}
STEP = 50e-6
STEEL = Pipe(2.5, 11e-3, 40e-6, 1137.0, 878.0)  # line 2
BEFORE_THE_ECHO = 2.0 * STEEL.travel_time  # [s]


def slammed(seconds: float, **parts: dict) -> tuple[Circuit, State, dict[str, Array], dict[str, Array]]:
    """Half a second up at full opening, then shut: the circuit, its start, and both stretches, step by step."""
    c = circuit(STEP, **({"valve": VALVE, "pump": SMOOTH} | parts))
    start = equilibrium(c, 0.03)
    before, moving = watched(start, 1.0, c, 0.5)
    after, _ = watched(moving, 0.0, c, seconds)
    return c, moving, before, after


@pytest.fixture(scope="module")
def real():
    """The rig as it is, its pump smooth."""
    return slammed(1.5)
