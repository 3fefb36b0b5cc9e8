"""The scheme against its own refinement and against scipy's Radau on the equations stated in `rates`."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from plant import FRICTIONLESS, circuit
from scipy.integrate import solve_ivp

from twin.circuit import Circuit, Flows, Ledger, Piston, Pressures, Spool, State, Stored, advance, pressures
from twin.equilibrium import equilibrium
from twin.linear import moving_point
from twin.rates import rates

SIZES = np.array([1e5] * 9 + [1e-4] * 6 + [0.1, 0.1])


def measure(s: State, c: Circuit) -> np.ndarray:
    """Pressures in bar, flows in 0.1 l/s, position and velocity in dm and dm/s."""
    return np.array([*pressures(s, c), *s.flows, *s.piston]) / SIZES


@cache
def fast_rise(step: float, temperature: float) -> tuple[State, Circuit]:
    """A steady rise at 0.8, relief valve shut, at a step that leaves stroke for 60 ms."""
    c = circuit(step, seal=FRICTIONLESS, oil={"temperature": temperature})
    return moving_point(c, 0.1, 0.8), c


def opening(step: float, temperature: float = 40.07) -> np.ndarray:
    """60 ms after the spool was sent from 0.8 to 0.9: smooth, no stick, no limit, no corner of the relief valve."""
    s, c = fast_rise(step, temperature)
    return measure(advance(s, 0.9, c, round(0.06 / step))[0], c)


def events(limit: float, start: float, references: tuple[float, ...]) -> Callable[[float], np.ndarray]:
    def at(step: float) -> np.ndarray:
        c = circuit(step, seal={"limit": limit})
        s = equilibrium(c, start)
        for reference in references:
            s = advance(s, reference, c, round(0.16 / step))[0]
        return measure(s, c)

    return at


@pytest.mark.parametrize("celsius", [40.07, 80.0])
def test_second_order_in_a_smooth_run(celsius: float):
    """Halving the step from 100 us quarters the error, laminar and (80 deg C, Re 6000) turbulent."""
    fine = opening(100e-6 / 64, celsius)
    errors = [np.abs(opening(100e-6 / n, celsius) - fine).max() for n in (1, 2, 4)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.25)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.25)
