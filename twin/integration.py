"""scipy's initial value problems with a bound on their work.

An adaptive method near a kink or with a stiff part can shrink its steps until it stands still; whether it does may hang
on the last bits of the linear algebra, hence on the processor. A bound makes that an error with a number.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rates = Callable[[float, NDArray[np.float64]], Any]
Solution = Any  # what solve_ivp returns


def integrate(
    rates: Rates, span: tuple[float, float], start: ArrayLike, method: str, *, most: int, **options: Any
) -> Solution:
    """`solve_ivp` with at most so many evaluations of the rates.

    Raises ArithmeticError where they do not suffice, and where the method gives up before the end.
    """
    from scipy.integrate import solve_ivp

    calls = 0

    def counted(t: float, y: NDArray[np.float64]) -> Any:
        nonlocal calls
        calls += 1
        if calls > most:
            raise ArithmeticError(f"{method} stands at {t:.6g} of {span[1]:.6g} after {most} evaluations of the rates")
        return rates(t, y)

    found = solve_ivp(counted, span, start, method, **options)
    if not found.success:
        raise ArithmeticError(f"{method} gave up at {found.t[-1]:.6g} of {span[1]:.6g}: {found.message}")
    return found
