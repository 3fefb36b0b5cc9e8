"""What the building of a circuit makes of a number, as an expression in C: a float that remembers its arithmetic.

The code that builds a circuit runs with such floats in place of a rig's numbers. Each operation gives the value that
it always gives, and beside it the same operation as C, so that native code gives the same bits. What leaves plain
arithmetic (`math.sqrt`, a search, a fit) gives a plain float: the number cannot be traced there, which whoever traces
must look for.
"""

from collections.abc import Callable
from typing import Any

LONGEST = 4000  # characters of an expression: beyond, a number is not followed


class Traced(float):
    """A float with its expression."""

    expression: str

    def __new__(cls, value: float, expression: str) -> "Traced":
        made = super().__new__(cls, value)
        made.expression = expression
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return Traced, (float(self), self.expression)


def in_c(value: float) -> str:
    """A number, or the expression of one that is traced."""
    return value.expression if isinstance(value, Traced) else literal(value)


def literal(value: float) -> str:
    """A number in C, to the last bit."""
    plain = float(value)
    if plain != plain:
        return "NAN"
    if plain in (float("inf"), float("-inf")):
        return "INFINITY" if plain > 0.0 else "-INFINITY"
    return plain.hex()


def _made(value: Any, expression: str) -> Any:
    """NotImplemented as it is; an expression that grows too long ends the trace."""
    if value is NotImplemented or len(expression) > LONGEST:
        return value
    return Traced(value, expression)


def _binary(name: str, sign: str) -> None:
    plain: Callable[..., Any] = getattr(float, f"__{name}__")
    swapped: Callable[..., Any] = getattr(float, f"__r{name}__")

    def of_left(self: Traced, other: Any) -> Any:
        value = plain(self, other)
        return value if value is NotImplemented else _made(value, f"({in_c(self)} {sign} {in_c(other)})")

    def of_right(self: Traced, other: Any) -> Any:
        value = swapped(self, other)
        return value if value is NotImplemented else _made(value, f"({in_c(other)} {sign} {in_c(self)})")

    setattr(Traced, f"__{name}__", of_left)
    setattr(Traced, f"__r{name}__", of_right)


for _name, _sign in (("add", "+"), ("sub", "-"), ("mul", "*"), ("truediv", "/")):
    _binary(_name, _sign)


def _power(self: Traced, other: Any, modulus: None = None) -> Any:
    value = float.__pow__(self, other)
    return value if value is NotImplemented else _made(value, f"pow({in_c(self)}, {in_c(other)})")


Traced.__pow__ = _power  # pyright: ignore[reportAttributeAccessIssue]
Traced.__neg__ = lambda self: _made(float.__neg__(self), f"(-{in_c(self)})")  # pyright: ignore[reportAttributeAccessIssue]
Traced.__abs__ = lambda self: _made(float.__abs__(self), f"fabs({in_c(self)})")  # pyright: ignore[reportAttributeAccessIssue]
