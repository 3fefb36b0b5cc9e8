"""Check valve with a cracking pressure, in line 2 behind the filter: nothing flows back.

    q >= 0,   p_tee - p_behind - r q <= p_c,   one of both an equality

r is the resistance of what it is in series with. Set-valued: what it does follows from the pressure that the tee has
with the valve shut. It takes p_c q and gives nothing.
"""

from typing import Any, NamedTuple

from twin.kernel import by_type
from twin.port import Port


class NoCheck(NamedTuple):
    """Line 2 is open both ways."""


class CheckValve(NamedTuple):
    """Open from the tee to line 2."""

    cracking_pressure: float  # p_c [Pa]


AnyCheck = CheckValve | NoCheck


@by_type
def is_check(check: Any) -> bool:
    """Is there one?"""
    raise TypeError(f"{check} is not a check valve")


@is_check.register
def _(check: NoCheck) -> bool:
    return False


@is_check.register
def _(check: CheckValve) -> bool:
    return True


@by_type
def passes(check: Any, tee: float, behind: Port) -> bool:
    """Is it open? tee: pressure [Pa] that the tee has with it shut; behind: line 2 through the fittings."""
    raise TypeError(f"{check} is not a check valve")


@passes.register
def _(check: NoCheck, tee: float, behind: Port) -> bool:
    return True


@passes.register
def _(check: CheckValve, tee: float, behind: Port) -> bool:
    return tee > behind.free + check.cracking_pressure


@by_type
def before_check(check: Any, behind: Port) -> Port:
    """What the tee meets of line 2 while the valve is open."""
    raise TypeError(f"{check} is not a check valve")


@before_check.register
def _(check: NoCheck, behind: Port) -> Port:
    return behind


@before_check.register
def _(check: CheckValve, behind: Port) -> Port:
    return Port(behind.free + check.cracking_pressure, behind.impedance)


@by_type
def cracking_drop_of(check: Any) -> float:
    """Pressure [Pa] that is lost while it is open."""
    raise TypeError(f"{check} is not a check valve")


@cracking_drop_of.register
def _(check: NoCheck) -> float:
    return 0.0


@cracking_drop_of.register
def _(check: CheckValve) -> float:
    return check.cracking_pressure


def cracking_drop(check: AnyCheck) -> float:
    """The same for Python alone."""
    return check.cracking_pressure if isinstance(check, CheckValve) else 0.0
