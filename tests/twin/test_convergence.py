"""The scheme against its own refinement and against scipy's Radau on the equations stated in `rates`."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from tests.support.plant import (
    FRICTIONLESS,
    SMOOTH,
    circuit,
    pipes,
)
from twin.circuit.block import advance
from twin.circuit.equilibrium import equilibrium
from twin.circuit.linear import moving_point, to_vector
from twin.circuit.rates import vector_rates
from twin.circuit.state import State, pressures
from twin.integration import integrate

SIZES = np.array([1e5] * 9 + [0.1, 0.1])


def measure(s: State) -> np.ndarray:
    """Pressures in bar, position and velocity in dm and dm/s."""
    return np.array([*pressures(s), *s.piston]) / SIZES


def opening(step: float, celsius: float) -> np.ndarray:
    """A steady rise, 60 ms after the spool was sent from 0.8 to 0.9: no stick, no limit, the relief valve shut."""
    c = circuit(step, pump=SMOOTH, seal=FRICTIONLESS, oil={"temperature": celsius}, **pipes(model="lumped"))
    return measure(advance(moving_point(c, 0.1, 0.8), 0.9, c, round(0.06 / step)))


def events(limit: float, start: float, references: tuple[float, ...]) -> Callable[[float], np.ndarray]:
    def at(step: float) -> np.ndarray:
        c = circuit(step, pump=SMOOTH, seal={"limit": limit}, **pipes(model="lumped"))
        s = equilibrium(c, start)
        for reference in references:
            s = advance(s, reference, c, round(0.16 / step))
        return measure(s)

    return at


@pytest.mark.parametrize("celsius", [40.07, 80.0])
def test_second_order_in_a_smooth_run(celsius: float):
    """Halving the step from 100 us quarters the error, laminar and (80 deg C, Re 4500) turbulent."""
    fine = opening(100e-6 / 64, celsius)
    errors = [np.abs(opening(100e-6 / n, celsius) - fine).max() for n in (1, 2, 4)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.25)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.25)


@pytest.mark.parametrize(
    "run_at",
    [
        events(0.25, 0.26, (1.0,)),  # runs into the top
        events(0.0, 0.02, (-1.0,)),  # runs into the bottom with a cavity above
        events(0.25, 0.10, (0.6, 0.0)),  # rises with friction, stops, sticks
    ],
)
def test_first_order_through_events(run_at: Callable[[float], np.ndarray]):
    """Impact, cavity, stick: an eighth of the step leaves less than a quarter of the error."""
    fine = run_at(100e-6 / 64)
    coarse, middle = (np.abs(run_at(100e-6 / n) - fine).max() for n in (1, 8))
    assert middle < 0.25 * coarse


SOFT = {"oil": {"air": 0.02}, "pipe_2": {"model": "volume"}, "pipe_3": {"model": "none"}, "pipe_5": {"model": "volume"}}


@pytest.mark.parametrize(
    ("start", "reference", "own"), [(0.8, 0.9, {}), (0.5, 0.65, {}), (-0.3, -0.25, {}), (0.5, 0.65, SOFT)]
)
def test_scheme_agrees_with_radau_on_the_rates(start: float, reference: float, own: dict):
    """60 ms at 5 us, lumped lines, no relief valve, against Radau at 1e-9: within 2 Pa, 2 um and 2 um/s; also with
    lines of one volume and oil with air.

    Without fittings, which the circuit has before the first half of a line's oil and the rates between both halves.
    """
    bare = {"filter": {"drop": 0.0}, "two_position_valve": {"drop": 0.0}, "relief": {"kind": "none"}}
    c = circuit(5e-6, **{"pump": SMOOTH, "seal": FRICTIONLESS} | bare | pipes(model="lumped") | own)
    s = moving_point(c, 0.1, start)
    sizes = np.array([1e-4 * 1e5] * 9 + [1e-4] * 6 + [0.1, 0.1, 1.0, 10.0])
    radau = integrate(
        lambda _, y: vector_rates(np.asarray(y * sizes, float), reference, c) / sizes,
        (0.0, 0.06), to_vector(s) / sizes, "Radau", most=100_000, rtol=1e-9, atol=1e-11, max_step=2e-3,
    )  # fmt: skip
    end = radau.y[:, -1] * sizes
    ours = advance(s, reference, c, 12000)
    assert measure(ours) == pytest.approx(np.array([*end[:9], *end[15:17]]) / SIZES, abs=2e-5)
    assert ours.spool == pytest.approx(tuple(end[17:]), abs=1e-6)
