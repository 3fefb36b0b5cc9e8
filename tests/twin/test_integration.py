"""Every initial value problem of scipy has a bound on its work, and says so where that does not suffice."""

import ast
from pathlib import Path

import pytest

from twin.integration import integrate

ROOT = Path(__file__).parents[2]
UNBOUNDED = {"solve_ivp", "odeint", "ode", "LSODA", "Radau", "BDF", "DOP853", "RK45", "RK23"}


def test_an_integration_that_stands_ends_with_the_number_of_its_evaluations():
    """y' = -1e6 sign y chatters about 0, and an explicit pair shrinks its steps there."""

    def chatter(_t, y):
        return -1e6 if y[0] > 0.0 else 1e6

    with pytest.raises(ArithmeticError, match=r"DOP853 stands at .* of 1 after 5000 evaluations of the rates"):
        integrate(chatter, (0.0, 1.0), [1.0], "DOP853", most=5000, rtol=1e-9, atol=1e-12)


def test_a_method_that_gives_up_is_an_error():
    """y' = y^2 from 1 has no solution beyond t = 1."""
    with pytest.raises(ArithmeticError, match=r"RK45 gave up at 1\b.* of 2: Required step size"):
        integrate(lambda _t, y: y * y, (0.0, 2.0), [1.0], "RK45", most=100_000, rtol=1e-9)


def test_nobody_calls_scipy_s_integrators_without_a_bound():
    found = set()
    for package in ("twin", "controller", "bridge", "tests", "examples"):
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and node.module == "scipy.integrate":
                    names = {alias.name for alias in node.names} & UNBOUNDED
                    found |= {(str(path.relative_to(ROOT)), name) for name in names}
    assert found == {("twin/integration.py", "solve_ivp")}
