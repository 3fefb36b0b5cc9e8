"""The scheme against its own refinement and against scipy's Radau on the equations stated in `rates`."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.plant import FRICTIONLESS, circuit
from twin.circuit import Circuit, Flows, Ledger, Piston, Spool, State, Stored, advance, pressures
from twin.equilibrium import equilibrium
from twin.linear import moving_point
from twin.rates import rates

SIZES = np.array([1e5] * 9 + [1e-4] * 6 + [0.1, 0.1])


def measure(s: State, c: Circuit) -> np.ndarray:
    """Pressures in bar, flows in 0.1 l/s, position and velocity in dm and dm/s."""
    return np.array([*pressures(s, c), *s.flows, *s.piston]) / SIZES


def opening(step: float, celsius: float) -> np.ndarray:
    """A steady rise, 60 ms after the spool was sent from 0.8 to 0.9: no stick, no limit, the relief valve shut."""
    c = circuit(step, seal=FRICTIONLESS, oil={"temperature": celsius})
    return measure(advance(moving_point(c, 0.1, 0.8), 0.9, c, round(0.06 / step))[0], c)


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


def flat(s: State) -> np.ndarray:
    return np.hstack([np.array(part) for part in s])


def unflat(y: np.ndarray) -> State:
    parts = np.split(y, [9, 15, 17, 19])
    kinds = (Stored, Flows, Piston, Spool, Ledger)
    return State(*(kind(*map(float, part)) for kind, part in zip(kinds, parts, strict=True)))  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(("start", "reference"), [(0.8, 0.9), (0.3, 0.45), (-0.3, -0.25)])
def test_scheme_agrees_with_radau_on_the_rates(start: float, reference: float):
    """60 ms at 5 us against Radau at 1e-9: within 2 Pa, 2e-9 m^3/s, 2 um and 2 um/s."""
    c = circuit(5e-6, seal=FRICTIONLESS)
    s = moving_point(c, 0.1, start)
    sizes = np.array([1e-4] * 9 + [1e-4] * 6 + [0.1, 0.1] + [1.0, 10.0] + [1e-4] * 3)
    radau = solve_ivp(
        lambda _, y: flat(rates(unflat(y * sizes), reference, c)) / sizes,
        (0.0, 0.06), flat(s) / sizes, method="Radau", rtol=1e-9, atol=1e-11, max_step=2e-3,
    )  # fmt: skip
    end = unflat(radau.y[:, -1] * sizes)
    ours = advance(s, reference, c, 12000)[0]
    assert measure(ours, c) == pytest.approx(measure(end, c), abs=2e-5)
    assert ours.spool == pytest.approx(end.spool, abs=1e-6)
    assert ours.ledger == pytest.approx(end.ledger, abs=1e-10)
